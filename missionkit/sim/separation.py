"""Separation of the vehicles of a fleet by ground truth."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from missionkit.geometry import Mat, Vec3

STEP = 0.05  # s
POSITION, GROUND = slice(1, 4), 14  # columns of a track


class Encounter(NamedTuple):
    """How near two vehicles came to each other while both were in the air."""

    first: str
    second: str
    least: float  # m
    at: float  # s, when
    conflicts: int  # stretches of time in which they were nearer than the bound
    duration: float  # s, of those


def encounters(tracks: Mapping[str, Mat], bound: float) -> tuple[Encounter, ...]:
    """Return the encounter of each two vehicles that were in the air together.

    Between the rows of a track, which are at most 50 ms apart, vehicles fly straight.

    Args:
        tracks: (N, TRACK_WIDTH) of each vehicle, with one origin in space and time.
        bound: m; nearer than this is a conflict.
    """
    pairs = combinations(tracks, 2)
    met = (_encounter(one, other, tracks[one], tracks[other], bound) for one, other in pairs)
    return tuple(it for it in met if it is not None)


def time_in_air(track: Mat) -> float:
    """Return how long (s) a vehicle was in the air.

    Args:
        track: (N, TRACK_WIDTH).
    """
    return float(np.diff(track[:, 0])[track[1:, GROUND] == 0.0].sum())


def _encounter(one: str, other: str, first: Mat, second: Mat, bound: float) -> Encounter | None:
    times = np.arange(0.0, min(first[-1, 0], second[-1, 0]) + 1e-9, STEP)
    together = _flying(first, times) & _flying(second, times)
    if not together.any():
        return None
    apart = np.linalg.norm(_positions(first, times) - _positions(second, times), axis=1)
    apart = np.where(together, apart, np.inf)
    near = apart < bound
    begun = near & ~np.concatenate(([False], near[:-1]))
    least = int(apart.argmin())
    return Encounter(
        one,
        other,
        float(apart[least]),
        float(times[least]),
        int(begun.sum()),
        float(near.sum() * STEP),
    )


def _positions(track: Mat, times: Vec3) -> Mat:
    return np.column_stack([np.interp(times, track[:, 0], axis) for axis in track[:, POSITION].T])


def _flying(track: Mat, times: Vec3) -> npt.NDArray[np.bool_]:
    rows = np.searchsorted(track[:, 0], times + 1e-9, side="right") - 1
    flying: npt.NDArray[np.bool_] = track[np.maximum(rows, 0), GROUND] == 0.0
    return flying
