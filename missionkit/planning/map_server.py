"""Maps as images with a YAML file beside them, as ROS map_server reads and writes them.

    p = 1 - x, or x with `negate`, for shades x from 0 (black) to 1 (white)
    blocked where p > occupied_thresh, free where p < free_thresh

What is neither is not known: blocked as well. With mode `scale` it is passable and a metre there
costs from 1 at `free_thresh` to `DEAREST` at `occupied_thresh`. What is transparent is not known
and blocked in either mode.

Source: https://wiki.ros.org/map_server
"""

from __future__ import annotations

from typing import Literal, Self

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, ConfigDict, Field, model_validator

from missionkit.messages.occupancy import Occupancy
from missionkit.units import Fraction, Metres, Number

DEAREST = 10.0


class MapFile(BaseModel):
    """The YAML file of a map."""

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", allow_inf_nan=False)

    image: str = Field(min_length=1, description="PNG or PGM, beside this file")
    resolution: Metres = Field(gt=0)
    origin: tuple[Metres, Metres, Number] = Field(
        description="east, north (m) of the lower left corner, and yaw (rad), counter-clockwise"
    )
    negate: bool | Literal[0, 1] = False
    occupied_thresh: Fraction = 0.65
    free_thresh: Fraction = 0.196
    mode: Literal["trinary", "scale"] = "trinary"

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.free_thresh >= self.occupied_thresh:
            raise ValueError("free_thresh must be below occupied_thresh")
        return self

    def read(self, shades: npt.NDArray[np.float64]) -> Occupancy:
        """Return the map in an image.

        Args:
            shades: (height, width), 0 black to 1 white, NaN not known; the first row is the
                northern edge.
        """
        grey = np.flipud(shades)
        p = grey if self.negate else 1.0 - grey
        costs = np.full(p.shape, np.inf)
        costs[p < self.free_thresh] = 1.0
        if self.mode == "scale":
            part = (p - self.free_thresh) / (self.occupied_thresh - self.free_thresh)
            between = (part >= 0.0) & (part <= 1.0)
            costs[between] = 1.0 + (DEAREST - 1.0) * part[between]
        east, north, yaw = self.origin
        return Occupancy(costs, self.resolution, (north, east), yaw)
