"""Obstacles that repel more than others: η_i of P1 section 4.1, by where they stand."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Self

import numpy as np
import numpy.typing as npt
from pydantic import BaseModel, ConfigDict, Field, model_validator

from missionkit.messages import Points
from missionkit.planning.polygon_cells import crossed
from missionkit.polygons import edges, unfit
from missionkit.positions import GroundPosition
from missionkit.units import Number

Factors = npt.NDArray[np.float64]  # (N,), 1


class ObstacleWeight(BaseModel):
    """What stands inside `polygon` repels `factor` times as much as other obstacles."""

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", allow_inf_nan=False)

    polygon: Annotated[
        tuple[GroundPosition, ...],
        Field(min_length=3, description="corners round the obstacle, with room for its surface"),
    ]
    factor: Annotated[Number, Field(gt=0, le=100, description="of the gains, 1 elsewhere")]

    @model_validator(mode="after")
    def _an_area(self) -> Self:
        if wrong := unfit(self.polygon):
            raise ValueError(f"polygon: {wrong}")
        return self


def factors_at(points: Points, weights: Sequence[ObstacleWeight]) -> Factors:
    """Return η_i / η of each point (N,): the largest factor of the polygons that it is in, else 1.

    Args:
        points: (N, 3), m, NED.
        weights: of the mission.
    """
    factors = np.ones(len(points))
    found = np.zeros(len(points), dtype=bool)
    for each in weights:
        inside = _inside(each, points)
        larger = inside & (~found | (each.factor > factors))
        factors[larger] = each.factor
        found |= inside
    return factors


def _inside(weight: ObstacleWeight, points: Points) -> npt.NDArray[np.bool_]:
    """Return which points lie in a polygon, as `polygons.contains` does for one."""
    inside = np.zeros(len(points), dtype=bool)
    for a, b in edges(weight.polygon):
        inside ^= crossed(np.array(a[::-1]), np.array(b[::-1]), points[:, 1], points[:, 0])
    return inside
