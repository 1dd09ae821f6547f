"""Converts sensor readings to rows of the measurement log (`state_layout`)."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from missionkit.estimation.error_state_ekf import state_layout
from missionkit.estimation.error_state_ekf.initialization import RestSamples
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.estimation.error_state_ekf.state_layout import LARGEST_MEASUREMENT
from missionkit.geometry import Mat, Transform, Vec3, log, norm, rotate, vec
from missionkit.messages import ExternalPose, Imu, Observation, Sighting

LEAST_SD, MOST_SD = 1e-3, 900.0
"""Bounds of a plausible sensor accuracy (m, m/s); squared, below LARGEST_MEASUREMENT."""
UNKNOWN_PLACE = (math.nan, math.nan, math.nan)
STANDING_SD = 0.02
"""How still a vehicle stands on the ground (m/s)."""
CLOCK_TOLERANCE = 0.05
"""Clocks may disagree by this much (s); a measurement from further in the future is refused."""


def row(
    kind: int,
    at: float,
    z: Vec3 | tuple[float, ...],
    noise: Mat,
    index: int = 0,
    extra: float = 0.0,
) -> Vec3:
    """Return one log row (21,) of a measurement z (3,) at time `at`.

    Args:
        kind: as `state_layout` numbers them.
        at: s, when it was valid.
        z: (3,), SI, NED or image plane by the kind; unused parts are 0.
        noise: covariance (3, 3), or variances (3,) or () if the errors are independent, of the unit
            of z².
        index: of the target, for a sighting.
        extra: distance (m) of a flow, declination (rad) of a heading, else unused or a standard
            deviation.
    """
    out = np.zeros(state_layout.LOG_WIDTH)
    out[state_layout.AT], out[state_layout.KIND], out[state_layout.INDEX] = at, kind, index
    out[state_layout.Z : state_layout.NOISE] = z
    if noise.ndim == 2:
        out[state_layout.NOISE : state_layout.EXTRA] = noise.ravel()
    else:
        out[state_layout.NOISE : state_layout.EXTRA : 4] = noise
    out[state_layout.EXTRA] = extra
    return out


def samples(imu: Sequence[Imu]) -> Mat:
    """Return (n, 7) time, accel, gyro."""
    rows = [(s.at, *s.accel.tolist(), *s.gyro.tolist()) for s in imu]
    return np.array(rows, dtype=np.float64).reshape(-1, 7)


def observed(observation: Observation, settings: VisualInertialEkf) -> list[Vec3]:
    """Return the log rows of everything but inertial samples in `observation`."""
    rows: list[Vec3] = []
    if (fix := observation.gnss) is not None:
        rows.append(row(state_layout.FIX, fix.at, fix.position, _variance(fix.position_sd)))
        if fix.velocity is not None:
            noise = _variance(fix.velocity_sd)
            rows.append(row(state_layout.FIX_VELOCITY, fix.at, fix.velocity, noise))
    if (baro := observation.baro) is not None:
        noise = np.square(settings.baro_sd)
        rows.append(row(state_layout.HEIGHT, baro.at, (baro.height, 0.0, 0.0), noise))
    if (mag := observation.mag) is not None:
        noise = np.square(settings.mag_sd)
        north = math.radians(settings.declination_deg)
        rows.append(row(state_layout.HEADING, mag.at, mag.field, noise, extra=north))
    if settings.external_pose and observation.external_pose is not None:
        rows += posed(observation.external_pose)
    return rows + ground(observation, settings) if settings.flow else rows


def posed(pose: ExternalPose) -> list[Vec3]:
    """Return the log rows of a pose measured from outside; an attitude that is none is refused."""
    length = norm(pose.attitude)
    turn = log(pose.attitude / length) if 0.9 < length < 1.1 else np.array(UNKNOWN_PLACE)
    place, angle = _variance(pose.position_sd), _variance(pose.angle_sd)
    return [
        row(state_layout.EXTERNAL, pose.at, pose.position, place),
        row(state_layout.EXTERNAL_TURN, pose.at, turn, angle),
    ]


def ground(observation: Observation, settings: VisualInertialEkf) -> list[Vec3]:
    """Return the log rows of what looks down, and of standing on the ground."""
    rows, status = [], observation.status
    if status is not None and not status.in_air:
        rows.append(row(state_layout.STILL, status.at, (0.0, 0.0, 0.0), np.square(STANDING_SD)))
    if (reach := observation.range) is None:
        return rows
    noise = np.square(settings.range_sd)
    rows.append(row(state_layout.RANGE, reach.at, (reach.distance, 0.0, 0.0), noise))
    flow, rates = observation.flow, _turning(observation)
    if flow is not None and rates is not None and flow.quality >= settings.flow_quality:
        d = reach.distance
        z = (-d * (flow.flow[0] + rates[1]), -d * (flow.flow[1] - rates[0]), 0.0)
        at = flow.at - 0.5 * flow.over  # a mean is the value in the middle
        rows.append(row(state_layout.FLOW, at, z, np.square(settings.flow_sd * d), extra=d))
    return rows


def _turning(observation: Observation) -> Vec3 | None:
    """Return the mean turn rate (3,) over the interval of the flow, None if it was not measured."""
    flow = observation.flow
    if flow is None:
        return None
    since = flow.at - flow.over
    rates = [sample.gyro for sample in observation.imu if since < sample.at <= flow.at + 1e-9]
    return np.mean(rates, axis=0) if rates else None


def _variance(sd: Vec3 | float) -> Mat:
    """Return the square of a sensor's stated accuracy, clipped to plausible bounds."""
    return np.square(np.minimum(np.maximum(sd, LEAST_SD), MOST_SD))


def sound(seen: Sighting) -> bool:
    """Say whether all numbers of a sighting are finite and none is absurdly large."""
    parts = (seen.pose.rotation, seen.pose.translation, (seen.position_sd, seen.angle_sd))
    return all(abs(value) < LARGEST_MEASUREMENT for part in parts for value in part)


def sighted(seen: Sighting, index: int, mount: Transform, bearing_sd: float) -> Vec3:
    """Return the log row of a sighting: the target's place in body axes, t = R_bc t_c + t_bc.

    Its covariance is σ² u uᵀ + τ² (I - u uᵀ) in camera axes: σ along the line of sight u, and
    across it τ = |t_c| · bearing_sd, but never more than σ. The row of a sighting that is not
    finite is not finite either, so that it will be refused.

    Args:
        seen: pose in camera axes, with its deviation (m).
        index: of the target in the state.
        mount: camera to body.
        bearing_sd: rad, of the line of sight.
    """
    t = seen.pose.translation
    if not sound(seen):
        return row(state_layout.SIGHT, seen.at, UNKNOWN_PLACE, np.eye(3), index)
    reach = max(float(np.linalg.norm(t)), LEAST_SD)
    u = rotate(mount.rotation, t / reach)
    along = min(max(seen.position_sd, LEAST_SD), MOST_SD)
    across = min(along, max(reach * bearing_sd, LEAST_SD))
    line = np.outer(u, u)
    noise = along**2 * line + across**2 * (np.eye(3) - line)
    return row(state_layout.SIGHT, seen.at, mount.apply(t), noise, index)


def timely(rows: list[Vec3], now: float) -> tuple[list[Vec3], list[Vec3]]:
    """Split rows into those that have a time which is not in the future, and the others."""
    good: list[Vec3] = []
    bad: list[Vec3] = []
    for r in rows:
        (good if r[state_layout.AT] <= now + CLOCK_TOLERANCE else bad).append(r)
    return good, bad


def resting(observation: Observation) -> RestSamples:
    """Return what `observation` adds to an alignment, as far as it is finite."""
    fix, baro, mag = observation.gnss, observation.baro, observation.mag
    none = vec(0.0, 0.0, 0.0)
    fixes = [] if fix is None else [(fix.at, *(fix.position + none), *(fix.position_sd + none))]
    heights = [] if baro is None else [(baro.at, baro.height)]
    fields = [] if mag is None else [(mag.at, *mag.field)]
    return RestSamples(
        _finite(samples(observation.imu), 7),
        _finite(fixes, 7),
        _finite(heights, 2),
        _finite(fields, 4),
    )


def _finite(rows: Mat | Sequence[tuple[float, ...]], width: int) -> Mat:
    table = np.array(rows, dtype=np.float64).reshape(-1, width)
    return table[(np.abs(table) < LARGEST_MEASUREMENT).all(axis=1)]
