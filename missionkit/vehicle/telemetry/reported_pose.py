"""Where the vehicle says it is: what a rendered camera looks from.

A simulator's ground truth of its vehicle has priority (HIL_STATE_QUATERNION, which
PX4's SIH sends); the autopilot's own estimate is next.
"""

from __future__ import annotations

from typing import NamedTuple

from missionkit.geodesy import Origin
from missionkit.geometry import Transform, Vec3, vec
from missionkit.messages import GimbalAngles
from missionkit.vehicle.link.message_cache import Cache, Message
from missionkit.vehicle.telemetry import message_readings
from missionkit.vehicle.telemetry.gimbal_attitude import STATUS, angles_of
from missionkit.vehicle.telemetry.observer import Observer

POSE_AGE = 0.5  # s
GONE = 1e6  # m, says that a robot is out of play


class Pose(NamedTuple):
    """A pose at a time."""

    at: float  # s, mission time
    body: Transform  # body to world
    velocity: Vec3  # (3,), m/s, NED
    rates: Vec3  # (3,), rad/s, FRD
    robots: tuple[tuple[float, float, float] | None, ...] = ()
    """Ground robots of missionkit's own simulator: north, east (m), heading (rad); None: out."""
    gimbal: GimbalAngles | None = None  # as it says it is turned


def reported_pose(cache: Cache, observer: Observer, sphere: float) -> Pose | None:
    """Return the newest pose, None while there is none.

    Args:
        cache: the newest messages.
        observer: knows home and the clock.
        sphere: m, radius of the earth in the autopilot's simulators.
    """
    pose = _pose(cache, observer, sphere)
    if pose is None:
        return None
    return pose._replace(robots=reported_robots(cache), gimbal=_reported_gimbal(cache))


def _reported_gimbal(cache: Cache) -> GimbalAngles | None:
    message = cache.latest(STATUS, POSE_AGE)
    return None if message is None else angles_of(message.fields, cache)


def _pose(cache: Cache, observer: Observer, sphere: float) -> Pose | None:
    truth = cache.latest("HIL_STATE_QUATERNION", POSE_AGE)
    if truth is not None and observer.origin is not None:
        return _true(truth, observer, observer.origin._replace(sphere=sphere))
    turned = cache.latest("ATTITUDE_QUATERNION", POSE_AGE)
    placed = cache.latest("LOCAL_POSITION_NED", POSE_AGE)
    if turned is None or placed is None:
        return None
    return _estimated(turned, placed, observer)


def reported_robots(cache: Cache) -> tuple[tuple[float, float, float] | None, ...]:
    """Return what DEBUG_FLOAT_ARRAY says, see `sitl.robot_messages`."""
    message = cache.latest("DEBUG_FLOAT_ARRAY", POSE_AGE)
    if message is None or message.fields.get("name") != "robots":
        return ()
    numbers = message_readings.numbers(message.fields, "data")
    triples = zip(numbers[::3], numbers[1::3], numbers[2::3], strict=False)
    return tuple(None if it[0] >= GONE else it for it in triples)


def _true(message: Message, observer: Observer, origin: Origin) -> Pose | None:
    attitude = message_readings.attitude(message["attitude_quaternion"])
    at = observer.mission_time(message)
    rates = message_readings.triple(message.fields, "rollspeed", "pitchspeed", "yawspeed")
    velocity = message_readings.triple(message.fields, "vx", "vy", "vz")
    if attitude is None or at is None or rates is None or velocity is None:
        return None
    place = origin.local(1e-7 * message["lat"], 1e-7 * message["lon"], 1e-3 * message["alt"])
    return Pose(at, Transform(attitude, place), 0.01 * velocity, rates)


def _estimated(turned: Message, placed: Message, observer: Observer) -> Pose | None:
    attitude = message_readings.turned(turned.fields)
    position = message_readings.triple(placed.fields, "x", "y", "z")
    velocity = message_readings.triple(placed.fields, "vx", "vy", "vz")
    rates = message_readings.triple(turned.fields, "rollspeed", "pitchspeed", "yawspeed")
    at, since = observer.mission_time(turned), observer.mission_time(placed)
    if attitude is None or position is None or velocity is None or rates is None:
        return None
    if at is None or since is None:
        return None
    known = observer.start
    start = vec(0.0, 0.0, 0.0) if known is None else known
    body = Transform(attitude, position - start + (at - since) * velocity)
    return Pose(at, body, velocity, rates)
