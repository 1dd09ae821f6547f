"""OBSTACLE_DISTANCE, a levelled ring of ranges around the vehicle, as points in the body.

    distance (cm)                below min_distance: nearer than the sensor can measure, an obstacle
                                 max_distance + 1 or more: nothing there;   65535: not known
    angle of element i (deg)     angle_offset + i * (increment_f or increment), clockwise, from the
                                 front of the vehicle (frames 8 and 12) or from north (0 and 1)

Source: MAVLink common.xml, message 330 and MAV_FRAME.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from missionkit.geometry import Quat, from_euler, to_matrix, yaw_of
from missionkit.messages import Points, Scan
from missionkit.vehicle.link.message_cache import Fields
from missionkit.vehicle.telemetry.message_readings import UINT16_UNKNOWN

NORTH_ALIGNED = frozenset((0, 1))  # MAV_FRAME_GLOBAL, which is the default, and LOCAL_NED
FRONT_ALIGNED = frozenset((8, 12))  # MAV_FRAME_BODY_NED, BODY_FRD
LEAST_RANGE = 0.05  # m; 0 is a valid distance, and a direction is needed
ONE_SCAN = 0.5  # s, in which rings of several sensors make one scan


class Ring(NamedTuple):
    """One ring with its time."""

    at: float  # s
    points: Points  # (N, 3), m, FRD
    reach: float  # m, how far it sees


def refusal(fields: Fields, attitude: Quat | None) -> str:
    """Return why a ring cannot be used, "" if it can."""
    frame = int(fields["frame"])
    if frame not in NORTH_ALIGNED | FRONT_ALIGNED:
        return f"OBSTACLE_DISTANCE is in MAV_FRAME {frame}; missionkit understands 0, 1, 8 and 12"
    if not _step(fields):
        return "OBSTACLE_DISTANCE has no increment between its distances"
    if frame in NORTH_ALIGNED and attitude is None:
        return "OBSTACLE_DISTANCE is aligned with north, and the attitude is not known"
    if not sectors(fields):
        return "OBSTACLE_DISTANCE reports no distance in any direction"
    return ""


def sectors(fields: Fields) -> int:
    """Return in how many directions a ring knows what is there."""
    return sum(int(value) != UINT16_UNKNOWN for value in fields["distances"])


def points_of(fields: Fields, attitude: Quat | None) -> Points:
    """Return the obstacle points (N, 3), m, FRD, of a ring that is not refused.

    Args:
        fields: of the message.
        attitude: body to world when the ring was measured; None: level, for one that is aligned
            with the front.
    """
    distances = np.asarray(fields["distances"], dtype=np.float64)
    hit = (distances <= float(fields["max_distance"])) & (distances != UINT16_UNKNOWN)
    angles = np.radians(float(fields["angle_offset"]) + _step(fields) * np.flatnonzero(hit))
    ring = np.column_stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))])
    points: Points = np.maximum(0.01 * distances[hit, None], LEAST_RANGE) * ring
    if attitude is None:
        return points
    if int(fields["frame"]) in FRONT_ALIGNED:
        points = points @ to_matrix(from_euler(0.0, 0.0, yaw_of(attitude))).T
    return points @ to_matrix(attitude)


def ring_of(fields: Fields, at: float, attitude: Quat | None) -> Ring:
    """Return a ring that is not refused, measured `at` (s); `attitude` as for `points_of`.

    Args:
        fields: of OBSTACLE_DISTANCE, as MAVLink has them.
        at: s.
        attitude: body to world, if it is known.
    """
    return Ring(at, points_of(fields, attitude), 0.01 * float(fields["max_distance"]))


def together(rings: Iterable[Ring]) -> Scan | None:
    """Return one scan of the newest ring of each sensor; those long before the newest are left out.

    Sensors that look to different sides send a message each.
    """
    known = list(rings)
    if not known:
        return None
    newest = max(ring.at for ring in known)
    fresh = [ring for ring in known if newest - ring.at <= ONE_SCAN]
    points = np.concatenate([ring.points for ring in fresh])
    return Scan(newest, points, min(ring.reach for ring in fresh))


def _step(fields: Fields) -> float:
    return float(fields.get("increment_f") or fields["increment"])
