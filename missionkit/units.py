"""Numbers with units, as mission files and plug-in parameters use them.

Each type refuses NaN and infinity and carries its unit into the JSON Schema and the manual
page. Degrees appear only here, in names that end in `_deg`; inside, angles are radians.
"""

from __future__ import annotations

from typing import Annotated

from pydantic import Field


def _unit(name: str) -> object:
    return Field(allow_inf_nan=False, json_schema_extra={"unit": name})


Metres = Annotated[float, _unit("m")]
Seconds = Annotated[float, _unit("s"), Field(ge=0)]
MetresPerSecond = Annotated[float, _unit("m/s")]
MetresPerSecond2 = Annotated[float, _unit("m/s²")]
Degrees = Annotated[float, _unit("deg")]
DegreesPerSecond = Annotated[float, _unit("deg/s")]
Radians = Annotated[float, _unit("rad")]
RadiansPerSecond = Annotated[float, _unit("rad/s")]
Hertz = Annotated[float, _unit("Hz"), Field(gt=0)]
Fraction = Annotated[float, _unit("1"), Field(ge=0, le=1)]
Pixels = Annotated[float, _unit("px")]
Number = Annotated[float, _unit("1")]
Spot = tuple[Metres, Metres]
"""North, east (m)."""
Point = tuple[Metres, Metres, Metres]
"""North, east, down (m)."""
