"""Where to be in front of a target: P1 section 2.3."""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import Mat, Quat, from_matrix, rotate, to_matrix, vec, wrap
from missionkit.messages import Goal, HalfSpace, Target

HOVER_SLACK = 0.15  # m, by which hovering in front of a marker may come nearer than commanded
FLAT_MARKER = 0.1
"""Below this horizontal part of its normal, a marker lies flat and no yaw faces it."""


def goal_rotation(marker: Mat) -> Mat:
    """Return the body that faces a marker, (3, 3), columns forward, right, down.

        R_goal = [-z_m, x_m, -y_m]

    `marker` (3, 3) has the marker's axes as columns: x right, y up, z towards the viewer.
    Source: P1 section 2.3; a proper rotation (correction P1.2).
    """
    x, y, z = marker.T
    return np.array([-z, x, -y]).T


def goal_of(
    target: Target, standoff: tuple[float, float, float], now: float, turn_deg: float = 0.0
) -> Goal | None:
    """Return where to hover in front of `target`, facing it; None if its attitude is unknown.

        T_goal = T_marker · T_offset

    T_offset = [R_offset | t_offset]: t_offset is `standoff`, (out, right, up), m, along the
    marker's z, x and y axes; R_offset turns the nose by `turn_deg`. The yaw is None for a marker
    that lies flat. Source: P1 section 2.3, in the world frame.

    Args:
        target: place and attitude of the marker, NED.
        standoff: (3,), m, out, right and up.
        now: s, time of the goal.
        turn_deg: deg, clockwise as seen from above, from facing the marker.
    """
    if target.attitude is None:
        return None
    out, right, up = standoff
    position = target.position + rotate(target.attitude, vec(right, up, out))
    forward = goal_rotation(to_matrix(target.attitude))[:, 0]
    yaw = None
    if math.hypot(*forward[:2]) > FLAT_MARKER:
        yaw = wrap(math.atan2(forward[1], forward[0]) + math.radians(turn_deg))
    return Goal(position, yaw, now, target.name)


def bound_of(target: Target, out: float) -> HalfSpace | None:
    """Return the side of a target's plane, `out` (m) off its marker, where a vehicle may be.

    The plane lies `HOVER_SLACK` nearer, so that hovering on it is free of it. None if it is not
    known how the marker is turned.
    """
    if target.attitude is None:
        return None
    normal = rotate(target.attitude, vec(0.0, 0.0, 1.0))
    return HalfSpace(target.position + (out - HOVER_SLACK) * normal, normal)


def facing(yaw: float) -> Quat:
    """Return the attitude (marker axes to world) of an upright marker facing heading `yaw` (rad).

    Its normal points to (cos yaw, sin yaw, 0) NED: a marker that faces south (pi) is seen by a
    viewer who stands south of it and looks north.
    """
    z = vec(math.cos(yaw), math.sin(yaw), 0.0)
    y = vec(0.0, 0.0, -1.0)
    return from_matrix(np.column_stack([np.cross(y, z), y, z]))
