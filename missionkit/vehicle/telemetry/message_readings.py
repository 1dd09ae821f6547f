"""From single MAVLink messages to what missionkit calls the same thing; None where it says nothing.

Sources: MAVLink common.xml, messages 24, 31, 105, 124.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from missionkit.geodesy import Origin
from missionkit.geometry import Quat, Vec3, norm, vec
from missionkit.messages import Baro, Gnss, Imu, Magnetometer
from missionkit.vehicle.link.message_cache import Fields

MAG_UPDATED, PRESSURE_ALT_UPDATED = 0x1C0, 0x800  # HIGHRES_IMU_UPDATED_FLAGS
_FIX_3D = 3
UINT16_UNKNOWN = 65535
_LEAST_GNSS_SD = vec(0.3, 0.3, 0.5)  # m; receivers that claim more are not trusted
_UNSTATED_SD = (2.5, 4.0, 0.3)  # m, m, m/s of receivers that do not say


def triple(fields: Fields, *names: str) -> Vec3 | None:
    """Return three fields as a vector, None unless all are finite."""
    values = [fields[name] for name in names]
    if any(value is None or not math.isfinite(value) for value in values):
        return None
    return np.array(values, dtype=np.float64)


def numbers(fields: Fields, name: str) -> list[float]:
    """Return an array of numbers; empty unless all are finite."""
    values = fields[name]
    if any(value is None or not math.isfinite(value) for value in values):
        return []
    return [float(value) for value in values]


def imu(fields: Fields, at: float) -> Imu | None:
    """Return a sample of HIGHRES_IMU."""
    accel = triple(fields, "xacc", "yacc", "zacc")
    gyro = triple(fields, "xgyro", "ygyro", "zgyro")
    return None if accel is None or gyro is None else Imu(at, accel, gyro)


def magnetometer(fields: Fields, at: float) -> Magnetometer | None:
    """Return the field of HIGHRES_IMU, if the sensor has a new one."""
    field = triple(fields, "xmag", "ymag", "zmag")
    if field is None or int(fields["fields_updated"]) & MAG_UPDATED != MAG_UPDATED:
        return None
    size = norm(field)
    return Magnetometer(at, field / size) if size > 0.0 else None


def pressure_height(fields: Fields) -> float | None:
    """Return the pressure altitude (m) of HIGHRES_IMU, if the sensor has a new one."""
    height = fields["pressure_alt"]
    if height is None or not int(fields["fields_updated"]) & PRESSURE_ALT_UPDATED:
        return None
    return float(height)


def baro(fields: Fields, at: float, ground: float) -> Baro | None:
    """Return the height above a pressure altitude `ground` (m).

    Args:
        fields: of the message, as MAVLink has them.
        at: s.
        ground: pressure altitude where the height is 0.
    """
    height = pressure_height(fields)
    return None if height is None else Baro(at, height - ground)


def fixed(fields: Fields) -> bool:
    """Say whether a GPS_RAW_INT or GPS2_RAW has a fix in three dimensions."""
    return int(fields["fix_type"]) >= _FIX_3D


def gnss(fields: Fields, at: float, origin: Origin, climb: float | None) -> Gnss | None:
    """Return the fix of GPS_RAW_INT or GPS2_RAW; what it does not know is left out.

    Args:
        fields: of the message.
        at: when it was valid (s).
        origin: of the mission.
        climb: m/s, up, which these messages do not tell; None: not known.
    """
    if not fixed(fields):
        return None
    place = origin.local(1e-7 * fields["lat"], 1e-7 * fields["lon"], 1e-3 * fields["alt"])
    flat = _accuracy(fields, "h_acc", _UNSTATED_SD[0])
    position_sd = np.maximum(
        vec(flat, flat, _accuracy(fields, "v_acc", _UNSTATED_SD[1])), _LEAST_GNSS_SD
    )
    speed_sd = _accuracy(fields, "vel_acc", _UNSTATED_SD[2])
    sd = vec(speed_sd, speed_sd, math.inf if climb is None else speed_sd)
    velocity = _over_ground(fields)
    if velocity is not None and climb is not None:
        velocity = velocity - vec(0.0, 0.0, climb)
    return Gnss(at, place, velocity, position_sd, sd)


def _over_ground(fields: Fields) -> Vec3 | None:
    """Return the velocity over ground (3,), m/s; standing still needs no course."""
    speed, course = int(fields["vel"]), int(fields["cog"])
    if speed == UINT16_UNKNOWN or (course == UINT16_UNKNOWN and speed > 0):
        return None
    angle = 0.0 if course == UINT16_UNKNOWN else math.radians(0.01 * course)
    return 0.01 * speed * vec(math.cos(angle), math.sin(angle), 0.0)


def _accuracy(fields: Fields, name: str, otherwise: float) -> float:
    millimetres = fields.get(name, 0)
    return 1e-3 * float(millimetres) if millimetres else otherwise


def turned(fields: Fields) -> Quat | None:
    """Return the attitude of ATTITUDE_QUATERNION, None for one that is not sound."""
    return attitude([fields[f"q{n}"] for n in range(1, 5)])


def attitude(q: Sequence[float]) -> Quat | None:
    """Return a unit quaternion, None for one that is not sound."""
    found = np.array(q, dtype=np.float64)
    size = float(np.sqrt(found @ found))
    return found / size if 0.9 < size < 1.1 else None
