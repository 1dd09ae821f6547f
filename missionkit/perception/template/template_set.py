"""What an object looks like, in a few small pictures, as their file holds them."""

from __future__ import annotations

import json
from functools import cache, cached_property
from importlib.resources import files
from typing import Annotated, Literal, Self

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, ConfigDict, Field, model_validator

from missionkit.perception.score_law import ScoreLaw
from missionkit.units import Metres, Number

SHIPPED = "robot_templates.yaml"
Grey = Annotated[int, Field(ge=0, le=255)]
Row = Annotated[tuple[Grey, ...], Field(strict=False)]
Picture = Annotated[tuple[Row, ...], Field(strict=False)]


class TemplateSet(BaseModel):
    """Square grey pictures of an object, each with a rim of what is around it."""

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", allow_inf_nan=False)

    templates: Literal[1] = Field(description="version of the format")
    side: Annotated[int, Field(ge=8, le=64)] = Field(description="of a picture, px")
    width: Number = Field(gt=0, description="of the object in a picture, px")
    diameter: Metres = Field(gt=0, description="of the object")
    pictures: Annotated[tuple[Picture, ...], Field(min_length=1, max_length=50, strict=False)]
    score: ScoreLaw = ScoreLaw()
    trained: dict[str, str] = Field(default={}, description="from what")

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if self.width > self.side:
            raise ValueError(f"an object of {self.width:g} px does not fit into {self.side} px")
        for number, rows in enumerate(self.pictures, 1):
            if len(rows) != self.side or any(len(row) != self.side for row in rows):
                raise ValueError(f"picture {number} is not {self.side} x {self.side} px")
            if len({level for row in rows for level in row}) == 1:
                raise ValueError(f"picture {number} is of one grey level: it matches nothing")
        return self

    @cached_property
    def arrays(self) -> npt.NDArray[np.float32]:
        """The pictures, (n, side, side)."""
        return np.array(self.pictures, np.float32)


@cache
def shipped() -> TemplateSet:
    """Return the templates that come with the package: a ground robot seen from above."""
    text = files("missionkit.perception").joinpath("trained", SHIPPED).read_text("utf-8")
    return TemplateSet.model_validate(json.loads(text))
