"""Grading a docking by what really happened, never by what was estimated."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from missionkit.docking_geometry import pose_error
from missionkit.geometry import Mat
from missionkit.sim.free_flyer.world import FreeFlyerWorld
from missionkit.sim.ground_truth import TrueState


class DockingGrade(NamedTuple):
    """Grade of a free flyer's flight by ground truth."""

    docked: bool  # held by the docking mechanism, unhurt, at the end of the record
    crashed: bool
    safe: bool  # at the end: docked, or holding clear with its thrusters off, after having flown
    duration: float  # s, armed
    impulse: float  # N·s, integral of the force's size
    position_error: float  # m, of the last place from the docked one
    attitude_error: float  # rad, the same of the attitude
    centre_distance: float  # m, least of the centres outside the corridor
    separation: float  # m, least gap of the bounding spheres outside the corridor
    keep_out_time: float  # s, in the keep-out sphere outside the corridor
    sideways: float  # m, greatest distance from the docking axis where the spheres overlap

    def as_dict(self) -> dict[str, Any]:
        """Return plain values for a report; what is not finite is None."""
        return {
            key: value if isinstance(value, bool) or math.isfinite(value) else None
            for key, value in self._asdict().items()
        }


def grade_docking(rows: Mat, world: FreeFlyerWorld, impulse: float) -> DockingGrade:
    """Grade a whole flight.

    Args:
        rows: (N, TRACK_WIDTH) track of the flight, N >= 1.
        world: with the target and the corridor.
        impulse: N·s, `FreeFlyer.impulse` at its end.
    """
    last, berth = TrueState.of(rows[-1]), world.berth
    position, attitude = pose_error(berth, last.position, last.attitude)
    flown = bool((rows[:, 15] > 0.0).any())
    safe = last.on_ground and not last.crashed and flown
    held = world.capture
    within = position <= held.position and attitude <= math.radians(held.attitude_deg)
    apart = np.linalg.norm(rows[:, 1:4] - np.array(world.target.position), axis=1)
    aside = _sideways(rows, world)
    free = np.isnan(aside)
    spent = np.diff(rows[:, 0], prepend=rows[0, 0])
    near = ~free & (apart < world.touching)
    least = float(apart[free].min()) if free.any() else math.inf
    return DockingGrade(
        docked=safe and within,
        crashed=last.crashed,
        safe=safe,
        duration=float(spent[rows[:, 15] > 0.0].sum()),
        impulse=impulse,
        position_error=position,
        attitude_error=attitude,
        centre_distance=least,
        separation=least - world.touching,
        keep_out_time=float(spent[free & (apart < world.keep_out)].sum()),
        sideways=float(aside[near].max()) if near.any() else 0.0,
    )


def _sideways(rows: Mat, world: FreeFlyerWorld) -> Mat:
    """Return the distance (N,), m, from the docking axis, NaN outside the corridor."""
    berth, cone = world.berth, world.cone
    offset = rows[:, 1:4] - berth.pose.translation
    along = offset @ berth.normal
    aside = np.linalg.norm(offset - np.outer(along, berth.normal), axis=1)
    wide = cone.radius + cone.slope * np.maximum(along, 0.0)
    inside = (along >= -cone.depth) & (along <= cone.length) & (aside <= wide)
    return np.where(inside, aside, np.nan)
