"""The markers a mission file says are to be looked for."""

from __future__ import annotations

from typing import Annotated, ClassVar, Self

from pydantic import Field, model_validator

from missionkit.perception.marker_dictionaries import SIZES, DictionaryName
from missionkit.plugin import Plugin
from missionkit.units import Metres, Point

Area = Annotated[float, Field(ge=0, allow_inf_nan=False, json_schema_extra={"unit": "px²"})]


class Aruco(Plugin):
    """A square fiducial marker fixed to a target.

    One target may carry several markers of different sizes, for different distances: each is
    an entry of its own with its `offset` from the target's centre. A marker in the image counts
    if A_min <= A <= A_max, its area in pixels (P1 section 5.1). `upright` says that the marker
    hangs as on a wall or a trunk, its upper edge up; this helps to tell apart the two poses that
    a small square permits. It says nothing about a marker that lies on the ground.
    """

    kind: ClassVar[str] = "aruco"

    target: str
    dictionary: DictionaryName = "DICT_6X6_250"
    id: Annotated[int, Field(ge=0)]
    size: Annotated[Metres, Field(gt=0, description="edge of the black square")]
    offset: Annotated[
        Point, Field(description="marker's centre from the target's: right, up, out of the paper")
    ] = (0.0, 0.0, 0.0)
    min_area: Area = 150.0
    max_area: Area = 250_000.0
    upright: bool = True

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if self.id >= SIZES[self.dictionary]:
            last = SIZES[self.dictionary] - 1
            raise ValueError(f"{self.dictionary} has ids 0 to {last}, not {self.id}")
        if self.min_area >= self.max_area:
            raise ValueError(f"min_area {self.min_area:g} is not below max_area {self.max_area:g}")
        return self
