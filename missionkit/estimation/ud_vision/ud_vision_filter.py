"""The vision-aided inertial navigator: memory in, memory out."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.special import chdtri

from missionkit.estimation import mahalanobis
from missionkit.estimation.error_state_ekf import (
    initialization,
    measurement_log,
    realignment,
    replay_buffer,
    state_layout,
)
from missionkit.estimation.error_state_ekf.process_model import intervals
from missionkit.estimation.error_state_ekf.state_layout import AT, D_LANDMARKS, END, LANDMARKS
from missionkit.estimation.navigator import NavState
from missionkit.estimation.ud_vision import (
    feature_steps,
    feature_table,
    feature_upkeep,
    filter_start,
    measurements,
    ud_vision_memory,
    ud_vision_state,
    vehicle_steps,
)
from missionkit.estimation.ud_vision.parameters import UdVisionEkf
from missionkit.estimation.ud_vision.ud_vision_memory import FilterState, UdVisionMemory
from missionkit.geometry import GRAVITY, Mat, Transform, Vec3, vec
from missionkit.messages import (
    CameraModel,
    FeatureMatches,
    FeatureSearch,
    Imu,
    Magnetometer,
    Observation,
    Range,
    Sighting,
)

PUNCTUAL = 0.011
"""s: a frame belongs to a state no further from it, one inertial sample."""
KEPT = 0.6
"""s of poses."""
MOST_REACH, MORE_REACH, SIGMAS = 16.0, 2.0, 3.0
"""px that a feature is searched at most, and how far beyond so many standard deviations."""
GAP_ACCEL, GAP_RATE = 2.0, 0.5
"""m/s² and rad/s that may have passed unseen while inertial samples were missing."""


class UdVisionFilter:
    """A filter that stands at the last frame, and a prediction from there to the present.

    Frames arrive late. The filter waits for them: it is run to the time of a frame when that comes,
    through what was measured until then, and the output follows by the inertial samples since. No
    measurement is taken in twice and none out of order.

    Source: P4 section II-B; the delayed horizon as in PX4's EKF2. Parameters and equations:
    `UdVisionEkf`.
    """

    def __init__(
        self,
        settings: UdVisionEkf,
        surveyed: Mapping[str, tuple[Vec3, float]],
        camera: CameraModel,
    ) -> None:
        s = self._settings = settings
        self._surveyed = surveyed
        self._lens = feature_upkeep.lens(camera)
        walks = (s.accel_bias_walk, s.gyro_bias_walk)
        self._noise = np.square([s.accel_noise, s.gyro_noise, *walks, GAP_ACCEL, GAP_RATE])
        self._gates = np.array([0.0, *(float(chdtri(m, 1.0 - s.gate)) for m in (1, 2, 3))])
        self._fresh = np.square([s.prior_sd, s.pixel_sd, s.ground_sd])

    def begin(self) -> UdVisionMemory:
        """Return the memory before the first observation."""
        return ud_vision_memory.begin(self._settings.features)

    def propagate(self, known: UdVisionMemory, observation: Observation) -> UdVisionMemory:
        """Return the memory after one observation, its frame left aside but for its time."""
        s, known = self._settings, known._replace(now=observation.now)
        if observation.status is not None:
            known = known._replace(in_air=observation.status.in_air)
        known, at = _heard(known, observation)
        if known.state is None:
            return self._align(known, observation)
        samples = measurement_log.samples(observation.imu)
        gap = realignment.gap(samples, known.last)
        if gap > s.longest_gap:
            known = filter_start.resumed(known, known.state, samples, observation.mag, gap, s)
        known = self._gathered(known, samples, observation)
        return _foreseen(self._run(known, max(known.now - s.max_delay, at)))

    def search(self, known: UdVisionMemory, at: float) -> FeatureSearch | None:
        """Return what to look for in a frame of `at` (s), None if the frame cannot be used."""
        state = known.state
        if state is None or not self._usable(known, state, at):
            return None
        slots = np.flatnonzero(known.table.alive)
        expected = feature_steps.aim(state.x, state.U, state.D, slots, *self._lens)
        before = np.isfinite(expected[:, 2])
        slots, expected = slots[before], expected[before]
        reach = np.minimum(np.ceil(SIGMAS * expected[:, 2] + MORE_REACH), MOST_REACH)
        turn, arms = feature_upkeep.camera(state.x, slots, self._lens)
        return FeatureSearch(
            slots=slots,
            points=expected[:, :2] / self._lens.focal,
            reach=reach,
            warps=feature_table.warps(known.table, slots, turn, arms, self._lens.focal),
            patches=known.table.patches[slots],
            vacant=self._settings.features - int(known.table.alive.sum()),
            enough=self._settings.least_in_view,
            spacing=self._settings.spacing,
        )

    def see(
        self, known: UdVisionMemory, search: FeatureSearch, matches: FeatureMatches
    ) -> UdVisionMemory:
        """Return the memory after what one frame shows.

        Args:
            known: as `search` saw it.
            search: what was looked for.
            matches: what was found.
        """
        state = known.state
        if state is None:
            return known
        x, U, D = after = state.x.copy(), state.U.copy(), state.D.copy()
        found = np.flatnonzero(matches.found)
        seen, slots = matches.points[found] * self._lens.focal, search.slots[found]
        variance, gate = float(self._fresh[1]), float(self._gates[2])
        nis = feature_steps.see(x, U, D, slots, seen, *self._lens, variance, gate)
        used = np.zeros(len(search.slots), np.bool_)
        used[found] = nis < gate
        table = feature_table.marked(known.table, search.slots, used, matches.in_view, matches.at)
        table = feature_upkeep.renewed(table, x, search, matches, used, self._lens)
        table = feature_upkeep.begun(table, after, search, matches, self._fresh, self._lens)
        known = _counted(known, nis, gate, matches.at, self._settings.least_used)
        return _foreseen(_settled(known, FilterState(state.at, *after))._replace(table=table))

    def fuse(
        self,
        known: UdVisionMemory,
        sightings: tuple[Sighting, ...],  # noqa: ARG002
    ) -> UdVisionMemory:
        """Return the memory as it is: sightings of targets are not used."""
        return known

    def pose_at(self, known: UdVisionMemory, at: float) -> Transform | None:
        """Return body to world at `at` (s), None outside the last half second."""
        return replay_buffer.pose_in(known.track, at)

    def read(self, known: UdVisionMemory) -> NavState:
        """Return the current estimate; zeros and identity until aligned."""
        return ud_vision_state.state(known, self._surveyed, self._settings)

    def warm_up(self) -> None:
        """Compile the kernels, or load them, by flying for a moment over one feature."""
        vehicle = np.zeros(LANDMARKS)
        vehicle[2], vehicle[6] = -1.0, 1.0
        start = filter_start.started(0.0, vehicle, np.eye(D_LANDMARKS), self._settings)
        known = self.begin()._replace(state=start, in_air=True, last=np.zeros(7))
        still = vec(0.0, 0.0, 0.0)
        seen = Observation(
            0.05,
            imu=(Imu(0.02, vec(0.0, 0.0, -GRAVITY), still),),
            mag=Magnetometer(0.01, vec(1.0, 0.0, 0.0)),
            range=Range(0.01, 1.0),
        )
        self._run(self.propagate(known, seen), seen.now)
        _, x, U, D = start
        feature_steps.begin(x, U, D, 0, np.zeros(2), *self._lens, self._fresh)
        slots = np.array([0])
        feature_steps.aim(x, U, D, slots, *self._lens)
        feature_steps.see(x, U, D, slots, np.zeros((1, 2)), *self._lens, 1.0, 9.0)

    def _align(self, known: UdVisionMemory, observation: Observation) -> UdVisionMemory:
        new = measurement_log.resting(replace(observation, gnss=None, baro=None))
        heard = initialization.gathered(known.heard, new, self._settings.align_for)
        state = filter_start.aligned(heard, self._settings)
        if state is None:
            return known._replace(heard=heard)
        last = heard.imu[-1]
        known = known._replace(heard=initialization.begin(), last=last, sighted_at=known.now)
        return _foreseen(known._replace(state=state))

    def _gathered(
        self, known: UdVisionMemory, samples: Mat, observation: Observation
    ) -> UdVisionMemory:
        """Return the memory with what was measured added to what the filter has before it."""
        last = known.last.copy()
        imu = intervals(samples, last, self._settings.max_gap)
        rows, bad = measurement_log.timely(
            measurements.measured(observation, self._settings, in_air=known.in_air), known.now
        )
        since = -math.inf if known.state is None else known.state.at - PUNCTUAL
        fresh = [row for row in rows if row[AT] > since]
        joined = np.concatenate((known.rows, np.array(fresh).reshape(-1, known.rows.shape[1])))
        return known._replace(
            last=last,
            imu=np.concatenate((known.imu, imu)),
            rows=joined[np.argsort(joined[:, AT], kind="stable")],
            late=known.late + len(rows) - len(fresh) + len(bad),
        )

    def _run(self, known: UdVisionMemory, until: float) -> UdVisionMemory:
        """Return the memory with the filter run to `until` (s), or as far as samples reach."""
        state = known.state
        if state is None or not until > state.at:
            return known
        x, U, D, rows = state.x.copy(), state.U.copy(), state.D.copy(), known.rows.copy()
        at = vehicle_steps.advance(
            x, U, D, state.at, known.imu, rows, until, self._noise, self._gates
        )
        known = known._replace(
            imu=known.imu[known.imu[:, END] > at],
            rows=rows[rows[:, state_layout.OUTCOME] == state_layout.PENDING],
        )
        return _settled(known, FilterState(at, x, U, D))

    def _usable(self, known: UdVisionMemory, state: FilterState, at: float) -> bool:
        return (
            known.in_air
            and known.looked_at < at == known.frame_at
            and abs(at - state.at) <= PUNCTUAL
            and -float(state.x[2]) >= self._settings.least_height
        )


def _heard(known: UdVisionMemory, seen: Observation) -> tuple[UdVisionMemory, float]:
    """Return the memory with the news of a frame, and when that was exposed, -inf without one."""
    frame = seen.frame
    if not known.in_air:
        known = known._replace(sighted_at=known.now)
    if frame is None or frame.image is None or not known.frame_at < frame.at <= known.now:
        return known, -math.inf
    late = known.state is not None and frame.at < known.state.at - PUNCTUAL
    return known._replace(frame_at=frame.at, came_at=known.now, late=known.late + late), frame.at


def _settled(known: UdVisionMemory, state: FilterState) -> UdVisionMemory:
    """Return the memory with a new state; one that is not sound is not taken."""
    _, x, U, D = state
    sound = np.isfinite(x).all() and np.isfinite(U).all() and (D >= 0.0).all()
    if not (sound and np.isfinite(D).all()):
        return known._replace(broken=True)
    return known._replace(state=state)


def _foreseen(known: UdVisionMemory) -> UdVisionMemory:
    """Return the memory with the state carried to the newest inertial sample."""
    state = known.state
    if state is None:
        return known
    ahead, fresh = state.x.copy(), np.empty((len(known.imu), 8))
    vehicle_steps.foresee(ahead, state.at, known.imu, fresh)
    if not np.isfinite(ahead).all():
        return known._replace(broken=True)
    times = known.track[:, 0]
    kept = known.track[(times <= state.at) & (times > known.now - KEPT)]
    return known._replace(ahead=ahead, track=np.concatenate((kept, fresh)))


def _counted(
    known: UdVisionMemory, nis: Vec3, gate: float, at: float, enough: int
) -> UdVisionMemory:
    """Return the memory with how the features of a frame at `at` (s) fared, by their ε (k,)."""
    used = int((nis < gate).sum())
    distances = [mahalanobis.distance(float(each), 2) for each in nis]
    known = known._replace(
        looked_at=at,
        used=used,
        refused=len(nis) - used,
        distance=mahalanobis.averaged(known.distance, distances, known.now),
    )
    return known if used < enough else known._replace(sighted_at=at, used_at=at)
