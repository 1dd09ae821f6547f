"""A trained cascade, as its file holds it."""

from __future__ import annotations

import json
from functools import cache, cached_property
from importlib.resources import files
from typing import Annotated, Literal, NamedTuple, Self

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, ConfigDict, Field, model_validator

from missionkit.perception.haar.features import RECTANGLES
from missionkit.perception.score_law import ScoreLaw
from missionkit.units import Metres, Number

SHIPPED = "robot_haar.yaml"
Column = Annotated[int, Field(ge=0)]
Part = tuple[Column, Column, Annotated[int, Field(ge=1)], Annotated[int, Field(ge=1)], Number]
"""Left, top, width, height (px), and its weight."""


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", allow_inf_nan=False)


class CascadeStump(_Part):
    """One feature and what it says."""

    threshold: Number
    low: Number = Field(description="answer below the threshold")
    high: Number
    parts: Annotated[tuple[Part, ...], Field(min_length=1, max_length=RECTANGLES, strict=False)]


class CascadeStage(_Part):
    """Stumps whose answers must sum up to the limit."""

    limit: Number
    stumps: Annotated[tuple[CascadeStump, ...], Field(min_length=1, strict=False)]


class HaarCascade(_Part):
    """Stages of boosted Haar-like features; a window that passes all of them shows an object."""

    haar_cascade: Literal[1] = Field(description="version of the format")
    side: Annotated[int, Field(ge=12, le=64)] = Field(description="of the window, px")
    width: Number = Field(gt=0, description="of the object in the window, px")
    diameter: Metres = Field(gt=0, description="of the object")
    stages: Annotated[tuple[CascadeStage, ...], Field(min_length=1, strict=False)]
    score: ScoreLaw = ScoreLaw()
    trained: dict[str, str] = Field(default={}, description="from what")

    @model_validator(mode="after")
    def _fits(self) -> Self:
        if self.width > self.side:
            raise ValueError(f"an object of {self.width:g} px does not fit into {self.side} px")
        for x, y, w, h, _ in self._parts():
            if x + w > self.side or y + h > self.side:
                raise ValueError(f"a part at [{x}, {y}] reaches outside the window")
        return self

    def _parts(self) -> list[Part]:
        return [part for stage in self.stages for it in stage.stumps for part in it.parts]

    @cached_property
    def arrays(self) -> CascadeArrays:
        """The same as arrays, for the kernels."""
        stumps = [it for stage in self.stages for it in stage.stumps]
        rectangles = np.zeros((len(stumps), RECTANGLES, 4), np.int32)
        weights = np.zeros((len(stumps), RECTANGLES))
        for i, stump in enumerate(stumps):
            for j, (*rectangle, weight) in enumerate(stump.parts):
                rectangles[i, j], weights[i, j] = rectangle, weight
        return CascadeArrays(
            rectangles,
            weights,
            np.array([(it.threshold, it.low, it.high) for it in stumps]),
            np.cumsum([len(stage.stumps) for stage in self.stages]).astype(np.int32),
            np.array([stage.limit for stage in self.stages]),
        )


class CascadeArrays(NamedTuple):
    """A cascade for `kernels.search`."""

    rectangles: npt.NDArray[np.int32]  # (n, 3, 4)
    weights: npt.NDArray[np.float64]  # (n, 3)
    stumps: npt.NDArray[np.float64]  # (n, 3): threshold, low, high
    ends: npt.NDArray[np.int32]  # (stages,)
    limits: npt.NDArray[np.float64]  # (stages,)


@cache
def shipped() -> HaarCascade:
    """Return the cascade that comes with the package: a ground robot seen from above."""
    text = files("missionkit.perception").joinpath("trained", SHIPPED).read_text("utf-8")
    return HaarCascade.model_validate(json.loads(text))
