"""A marker as it is printed: which one, and how large."""

from __future__ import annotations

from typing import Self

from pydantic import Field, model_validator

from missionkit.perception.marker_dictionaries import SIZES, DictionaryName
from missionkit.sim.vehicle_parameters import ParameterModel
from missionkit.units import Metres


class PrintedMarker(ParameterModel):
    """What every marker of a world has, wherever it hangs or lies."""

    dictionary: DictionaryName
    id: int = Field(ge=0)
    size: Metres = Field(gt=0, description="side of the black square")

    @model_validator(mode="after")
    def _printed(self) -> Self:
        last = SIZES[self.dictionary] - 1
        if self.id > last:
            raise ValueError(f"{self.dictionary} has ids 0 to {last}, not {self.id}")
        return self
