"""Sends the mission's estimates to the autopilot: its visual pose, and the landing target.

    VISION_POSITION_ESTIMATE    the estimate, at every tick at which vision corrects it
    LANDING_TARGET              the target's estimated position, once for each sighting; at every
                                tick while the autopilot lands on it

Nothing else goes out unless it was wanted. Both are of the autopilot's local frame, but for
ArduPilot's LANDING_TARGET, which it takes relative to the body. Sources: MAVLink common.xml; PX4
`mavlink_receiver.cpp`; ArduPilot `AC_PrecLand_Companion.cpp`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from typing import Any, NamedTuple

from missionkit.geometry import Vec3, conjugate, norm, rotate, to_euler
from missionkit.messages import Estimate, LandingTarget, Observation, Record, Target
from missionkit.vehicle.autopilot_dialect import LOCAL_NED

VISION_AGE = 0.5  # s since vision last corrected the estimate
FIDUCIAL = 2  # LANDING_TARGET_TYPE_VISION_FIDUCIAL
VARIANCE_X, VARIANCE_Y, VARIANCE_Z = 0, 6, 11
"""Variances of x, y and z in the upper triangle of the covariance (21,)."""
COUNTER = 256  # resets are counted in a byte

Fields = dict[str, Any]


class Share(NamedTuple):
    """Estimates to send to the autopilot."""

    pose: bool = False  # VISION_POSITION_ESTIMATE
    target: str | None = None  # name of the target that goes out as LANDING_TARGET


SHARE_NOTHING = Share()


class Sharing:
    """Sends after each tick what is wanted; an observer of the flight.

    Args:
        share: what is wanted.
        send: puts a message on the wire; `RuntimeError` if it cannot.
        start: gives the mission's origin in the autopilot's local frame, None if it is not known.
        stamp: gives the wall time (s) of a mission time (s).
        frame: MAV_FRAME of LANDING_TARGET.
    """

    def __init__(
        self,
        share: Share,
        send: Callable[..., None],
        start: Callable[[], Vec3 | None],
        stamp: Callable[[float], float | None],
        frame: int,
    ) -> None:
        self._share = share
        self._send = send
        self._start = start
        self._stamp = stamp
        self._frame = frame
        self._seen_at: float | None = None  # s, of the sighting sent last

    def __call__(self, record: Record, _: Observation) -> None:
        """Tell the autopilot what this tick knows."""
        seen, start = record.estimate, self._start()
        if start is None:
            return
        at = self._stamp(seen.now)
        if at is not None and self._share.pose and visual(seen):
            self._give("VISION_POSITION_ESTIMATE", pose_fields(seen, int(1e6 * at), start))
        pad = record.command.landing_target
        if pad is not None:
            self._land_on(pad, seen, start)
            return
        target = seen.targets.get(self._share.target or "")
        if target is None or target.seen_at is None or target.seen_at == self._seen_at:
            return
        at = self._stamp(target.seen_at)
        if at is None or not _finite(target.position):
            return
        self._seen_at = target.seen_at
        fields = target_fields(target, seen, int(1e6 * at), start, self._frame)
        self._give("LANDING_TARGET", fields)

    def _land_on(self, pad: LandingTarget, seen: Estimate, start: Vec3) -> None:
        """Tell the autopilot where the pad is on which it is landing."""
        at, target = self._stamp(seen.now), seen.targets.get(pad.name)
        if at is None or target is None or not _finite(pad.offset):
            return
        here = target._replace(position=seen.position + pad.offset)
        fields = target_fields(here, seen, int(1e6 * at), start, self._frame)
        self._give("LANDING_TARGET", fields)

    def _give(self, name: str, fields: Fields) -> None:
        with suppress(RuntimeError):  # no link: the next tick tells more than this one
            self._send(name, **fields)


def visual(seen: Estimate) -> bool:
    """Return whether the estimate can be trusted and vision corrects it just now."""
    health = seen.health
    fresh = health.vision_at is not None and seen.now - health.vision_at <= VISION_AGE
    sane = _finite(seen.position) and math.isfinite(health.position_sd)
    return fresh and sane and health.aligned and not health.diverged


def pose_fields(seen: Estimate, usec: int, start: Vec3) -> Fields:
    """Return VISION_POSITION_ESTIMATE; an angle's variance of 0 leaves it to the autopilot.

    Args:
        seen: what is known.
        usec: stamp.
        start: (3,), m, the mission's origin in the autopilot's local frame.
    """
    x, y, z = (seen.position + start).tolist()
    roll, pitch, yaw = map(float, to_euler(seen.attitude))
    health = seen.health
    covariance = [0.0] * 21
    covariance[VARIANCE_X] = covariance[VARIANCE_Y] = float(health.position_sd) ** 2
    covariance[VARIANCE_Z] = (
        covariance[VARIANCE_X] if health.height_sd is None else float(health.height_sd) ** 2
    )
    angles = {"roll": roll, "pitch": pitch, "yaw": yaw}
    place = {"x": x, "y": y, "z": z}
    resets = health.resets % COUNTER
    return {"usec": usec, **place, **angles, "covariance": covariance, "reset_counter": resets}


def target_fields(target: Target, seen: Estimate, usec: int, start: Vec3, frame: int) -> Fields:
    """Return LANDING_TARGET, with its angles as a camera that looks down the body sees them.

    Args:
        target: its estimated position.
        seen: where the vehicle is.
        usec: stamp.
        start: (3,), m, the mission's origin in the autopilot's local frame.
        frame: LOCAL_NED or BODY_FRD.
    """
    ray = rotate(conjugate(seen.attitude), target.position - seen.position)
    forward, right, down = ray.tolist()
    x, y, z = (target.position + start).tolist() if frame == LOCAL_NED else ray.tolist()
    return {
        "time_usec": usec,
        "target_num": 0,
        "frame": frame,
        "angle_x": math.atan2(right, down),
        "angle_y": -math.atan2(forward, down),
        "distance": float(norm(ray)),
        "size_x": 0.0,
        "size_y": 0.0,
        "x": x,
        "y": y,
        "z": z,
        "q": [1.0, 0.0, 0.0, 0.0],
        "type": FIDUCIAL,
        "position_valid": 1,
    }


def _finite(numbers: Vec3) -> bool:
    return all(map(math.isfinite, numbers.tolist()))
