"""The optical-flow navigator: memory in, memory out."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from missionkit.estimation import mahalanobis
from missionkit.estimation.error_state_ekf import (
    initialization,
    measurement_log,
    realignment,
    replay_buffer,
)
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.estimation.error_state_ekf.process_model import intervals
from missionkit.estimation.error_state_ekf.state_layout import (
    ACCEL_BIAS,
    GYRO_BIAS,
    LANDMARKS,
    QUATERNION,
)
from missionkit.estimation.navigator import NavState
from missionkit.estimation.optical_flow import axis_filter, flow_memory, flow_state
from missionkit.estimation.optical_flow.axis_filter import AXIS_POSITION, AXIS_VELOCITY
from missionkit.estimation.optical_flow.complementary_filter import carry, steer
from missionkit.estimation.optical_flow.flow_memory import (
    AXIS_EAST,
    AXIS_NORTH,
    AXIS_UP,
    FlowMemory,
)
from missionkit.estimation.optical_flow.flow_parameters import FlowKalman
from missionkit.estimation.optical_flow.flow_velocity import over_ground
from missionkit.geometry import GRAVITY, Mat, Transform, Vec3, norm, to_matrix, vec
from missionkit.messages import (
    Baro,
    Imu,
    Magnetometer,
    Observation,
    OpticalFlow,
    Range,
    Sighting,
)

REST_VARIANCE = 1e-4
"""Variance (m²/s²) with which a vehicle on the ground stands still."""
POSES_KEPT = 12
"""Poses kept, one an observation."""


class AxisFilter(NamedTuple):
    """The filter of one axis: `axis_filter`, or filterpy's behind the same functions."""

    predict: Callable[[Vec3, Mat, float, float, float], bool]
    update: Callable[[Vec3, Mat, float, float, int], bool]


class FlowFilter:
    """One Kalman filter for each of north, east and height.

    Source: P2 section III-B; parameters and equations: `FlowKalman`.
    """

    def __init__(self, settings: FlowKalman, surveyed: Mapping[str, tuple[Vec3, float]]) -> None:
        s = self._settings = settings
        self._surveyed = surveyed
        self._gains = np.array([s.tilt_gain, s.bias_gain])
        self._north = math.radians(s.declination_deg)
        self._rest = VisualInertialEkf(
            align_for=s.align_for, declination_deg=s.declination_deg, baro_sd=s.baro_sd
        )
        self._axis = AxisFilter(axis_filter.predict, axis_filter.update)
        if s.axis_filter == "filterpy":
            from missionkit.estimation.optical_flow import filterpy_axis  # noqa: PLC0415 heavy

            self._axis = AxisFilter(filterpy_axis.predict, filterpy_axis.update)

    def warm_up(self) -> None:
        """Compile the kernels, or load them, by standing and flying for a moment."""
        still, field = vec(0.0, 0.0, 0.0), vec(1.0, 0.0, 0.0)
        known = self.begin()._replace(aligned=True, in_air=True, last=np.zeros(7), mag_at=0.0)
        known = known._replace(mu=np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0]]))
        seen = Observation(
            0.05,
            imu=(Imu(0.01, vec(0.0, 0.0, -GRAVITY), still),),
            baro=Baro(0.05, 1.0),
            mag=Magnetometer(0.05, field),
            flow=OpticalFlow(0.05, np.zeros(2), still, 0.05, 1.0),
            range=Range(0.05, 1.0),
        )
        self.propagate(known, seen)

    def begin(self) -> FlowMemory:
        """Return the memory before the first observation."""
        return flow_memory.begin()

    def propagate(self, known: FlowMemory, observation: Observation) -> FlowMemory:
        """Return the memory after one observation: prediction, then each sensor in turn."""
        known = known._replace(now=observation.now, measured=None)
        if observation.status is not None:
            known = known._replace(in_air=observation.status.in_air)
        if not known.aligned:
            return self._align(known, observation)
        samples = measurement_log.samples(observation.imu)
        gap = realignment.gap(samples, known.last)
        if gap > self._rest.longest_gap:
            known = _resumed(known, samples, observation.mag, gap, self._rest)
        known, rates = self._predict(known, observation)
        known = self._steer(known, observation.mag)
        if not known.in_air:
            return _tracked(_rest(known, self._axis))
        known = self._climb(known, observation)
        return _tracked(self._flow(known, observation.flow, rates))

    def fuse(self, known: FlowMemory, sightings: tuple[Sighting, ...]) -> FlowMemory:  # noqa: ARG002
        """Return the memory as it is: sightings of targets are not used."""
        return known

    def pose_at(self, known: FlowMemory, at: float) -> Transform | None:
        """Return body to world at `at` (s), None outside the last half second."""
        return replay_buffer.pose_in(known.track, at)

    def read(self, known: FlowMemory) -> NavState:
        """Return the current estimate; zeros and identity until aligned."""
        return flow_state.state(known, self._surveyed, self._settings)

    def _align(self, known: FlowMemory, observation: Observation) -> FlowMemory:
        new = measurement_log.resting(observation)
        heard = initialization.gathered(known.heard, new, self._settings.align_for)
        start = initialization.aligned(heard, np.empty((0, 3)), np.empty(0), self._rest)
        if start is None:
            return known._replace(heard=heard)
        mu = np.zeros((3, 2))
        mu[:2, 0] = self._settings.start
        return known._replace(
            heard=initialization.begin(),
            aligned=True,
            last=heard.imu[-1],
            attitude=start.x[QUATERNION:ACCEL_BIAS].copy(),
            bias=start.x[GYRO_BIAS:LANDMARKS].copy(),
            mu=mu,
            flow_at=start.at,
        )

    def _predict(self, known: FlowMemory, seen: Observation) -> tuple[FlowMemory, Vec3]:
        """Carry attitude and axes to the newest inertial sample; return the mean rates (3,)."""
        s, last = self._settings, known.last.copy()
        imu = intervals(measurement_log.samples(seen.imu), last, s.max_gap)
        q, bias, mu, S = _copies(known)
        pull, rates = np.empty(3), np.empty(3)
        dt = carry(q, bias, imu, float(known.last[0]), self._gains, pull, rates)
        for axis, sign in ((AXIS_NORTH, 1.0), (AXIS_EAST, 1.0), (AXIS_UP, -1.0)):
            self._axis.predict(mu[axis], S[axis], sign * pull[axis], dt, s.accel_variance[axis])
        height = max(float(mu[AXIS_UP, 0]), 0.0) if known.in_air else 0.0
        known = known._replace(attitude=q, bias=bias, mu=mu, S=S, last=last)
        return known._replace(reach=known.reach + height * dt), rates

    def _steer(self, known: FlowMemory, mag: Magnetometer | None) -> FlowMemory:
        if mag is None or not 0.5 < norm(mag.field) < 2.0:  # it should be 1
            return known
        q, bias, _, _ = _copies(known)
        if known.mag_at is not None and mag.at > known.mag_at:
            steer(q, bias, mag.field, self._north, mag.at - known.mag_at, self._gains)
        return known._replace(attitude=q, bias=bias, mag_at=mag.at)

    def _climb(self, known: FlowMemory, seen: Observation) -> FlowMemory:
        """Correct the height by what range finder and barometer say."""
        s, (q, _, mu, S) = self._settings, _copies(known)
        if seen.range is not None:
            height = seen.range.distance * float(to_matrix(q)[2, 2])
            if self._axis.update(mu[AXIS_UP], S[AXIS_UP], height, s.range_sd**2, AXIS_POSITION):
                known = known._replace(range_at=known.now)
        if seen.baro is not None:
            self._axis.update(
                mu[AXIS_UP], S[AXIS_UP], seen.baro.height, s.baro_sd**2, AXIS_POSITION
            )
        return known._replace(mu=mu, S=S)

    def _flow(self, known: FlowMemory, flow: OpticalFlow | None, rates: Vec3) -> FlowMemory:
        """Correct north and east by the velocity over ground."""
        if flow is None:
            return known
        s, (q, _, mu, S) = self._settings, _copies(known)
        height, climb = mu[AXIS_UP].tolist()
        z = np.zeros(2)
        if not (flow.quality >= s.quality and over_ground(flow.flow, rates, height, q, climb, z)):
            return known._replace(refused=known.refused + 1)
        nis = sum(
            (float(z[axis]) - mu[axis, AXIS_VELOCITY]) ** 2
            / (S[axis, AXIS_VELOCITY, AXIS_VELOCITY] + s.flow_variance[axis])
            for axis in (AXIS_NORTH, AXIS_EAST)
        )
        distance = mahalanobis.averaged(
            known.distance, [mahalanobis.distance(float(nis), 2)], known.now
        )
        for axis in (AXIS_NORTH, AXIS_EAST):
            self._axis.update(
                mu[axis], S[axis], float(z[axis]), s.flow_variance[axis], AXIS_VELOCITY
            )
        slip = known.slip + flow_state.slipped(known, z, s)
        known = known._replace(mu=mu, S=S, flow_at=known.now, measured=z, refused=0)
        return known._replace(slip=slip, distance=distance)


def _copies(known: FlowMemory) -> tuple[Vec3, Vec3, Mat, Mat]:
    return known.attitude.copy(), known.bias.copy(), known.mu.copy(), known.S.copy()


def _resumed(
    known: FlowMemory, samples: Mat, mag: Magnetometer | None, gap: float, rest: VisualInertialEkf
) -> FlowMemory:
    """Return the memory after a gap (s) in the inertial samples (n, 7): nothing is integrated.

    The attitude is what accelerometer and magnetometer say now, the velocity unknown, and the
    position as uncertain as that velocity makes it over the gap.
    """
    _, _, mu, S = _copies(known)
    fresh = samples[samples[:, 0] > known.last[0]]
    q = known.attitude
    if mag is not None and 0.5 < norm(mag.field) < 2.0:
        force = fresh[:, 1:4].mean(axis=0)
        q = initialization.attitude(force, mag.field, math.radians(rest.declination_deg))
    for axis in (AXIS_NORTH, AXIS_EAST, AXIS_UP):
        speed = rest.reset_velocity_sd + abs(float(mu[axis, 1]))
        S[axis] = np.diag([S[axis, 0, 0] + (speed * gap) ** 2, speed**2])
        mu[axis, 1] = 0.0
    return known._replace(attitude=q, mu=mu, S=S, last=fresh[0].copy(), mag_at=None)


def _rest(known: FlowMemory, axis_of: AxisFilter) -> FlowMemory:
    """Return the memory with all velocities corrected to zero."""
    _, _, mu, S = _copies(known)
    for axis in (AXIS_NORTH, AXIS_EAST, AXIS_UP):
        axis_of.update(mu[axis], S[axis], 0.0, REST_VARIANCE, AXIS_VELOCITY)
    return known._replace(mu=mu, S=S, flow_at=known.now, refused=0)


def _tracked(known: FlowMemory) -> FlowMemory:
    """Return the memory with its newest pose in the track."""
    (north, _), (east, _), (up, _) = known.mu.tolist()
    row = np.array([[known.last[0], north, east, -up, *known.attitude]])
    if len(known.track) and row[0, 0] <= known.track[-1, 0]:
        return known
    return known._replace(track=np.concatenate((known.track[1 - POSES_KEPT :], row)))
