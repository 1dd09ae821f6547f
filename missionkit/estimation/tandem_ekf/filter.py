"""The free flyer's navigator: memory in, memory out."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from missionkit.estimation import mahalanobis
from missionkit.estimation.error_state_ekf import measurement_log, replay_buffer
from missionkit.estimation.error_state_ekf.process_model import intervals
from missionkit.estimation.error_state_ekf.state_layout import ACCEL, END, GYRO
from missionkit.estimation.navigator import NavState
from missionkit.estimation.tandem_ekf import filter_memory, initialization, state_output
from missionkit.estimation.tandem_ekf.acceptance import Acceptance, counted
from missionkit.estimation.tandem_ekf.centre_of_mass import centre, sound
from missionkit.estimation.tandem_ekf.filter_memory import FlyerMemory
from missionkit.estimation.tandem_ekf.filter_steps import advance
from missionkit.estimation.tandem_ekf.measurement_rows import MeasurementRows, rows_of
from missionkit.estimation.tandem_ekf.parameters import CompoundEkf, FlyerEkf
from missionkit.estimation.tandem_ekf.state_layout import (
    ACCEPTED,
    AT,
    FORCE,
    GATE_1,
    GATE_3,
    KIND,
    LEVER,
    NIS,
    OUTCOME,
    QUATERNION,
    RANGE,
    RATE,
    TIME,
)
from missionkit.geometry import Mat, Transform, Vec3
from missionkit.messages import AnchorRange, Features, Imu, Observation, Sighting

KEEP = 12
"""Poses kept, one an observation."""


class FlyerFilter:
    """Tandem or compound error-state EKF of a free flyer.

    Source: P3 sections II to IV; parameters and equations: `TandemEkf`.
    """

    def __init__(self, settings: FlyerEkf, surveyed: Mapping[str, tuple[Vec3, float]]) -> None:
        self._settings = settings
        self._compound = isinstance(settings, CompoundEkf)
        self._surveyed = surveyed
        self._kernel = initialization.settings_of(settings)
        self._lever = self._kernel[LEVER : LEVER + 3].copy()
        self._gates = {1: float(self._kernel[GATE_1]), 3: float(self._kernel[GATE_3])}
        self._sources = MeasurementRows.of(settings)

    def warm_up(self) -> None:
        """Compile the kernels, or load them, by a moment's flight with every measurement."""
        anchor, place = next(iter(self._settings.anchors.items()))
        far = math.dist(place, self._settings.position)
        frames = [
            Features(0.02, name, tuple(it.features), np.zeros((len(it.features), 3)))
            for name, it in self._settings.targets.items()
        ]
        seen = Observation(
            0.02,
            imu=tuple(Imu(at, np.zeros(3), np.zeros(3)) for at in (0.0, 0.01, 0.02)),
            ranges=(AnchorRange(0.015, anchor, far),),
            features=tuple(frames),
        )
        self.read(self.propagate(self.begin(), seen))

    def begin(self) -> FlyerMemory:
        """Return the memory before the first observation."""
        x, P, A = initialization.start(self._settings, compound=self._compound)
        return filter_memory.begin(x, P, A, self._lever, len(self._sources.numbers))

    def propagate(self, known: FlyerMemory, observation: Observation) -> FlyerMemory:
        """Return the memory after one observation: everything in it in the order of its time."""
        last = known.last.copy()
        imu = intervals(measurement_log.samples(observation.imu), last, self._settings.max_gap)
        known = known._replace(now=observation.now)
        x, P, A = known.x.copy(), known.P.copy(), known.A.copy()
        if not math.isfinite(known.last[0]):
            if not len(imu):
                return known
            imu = _begun(x, imu)
        rows, heard, unusable, late = rows_of(self._sources, known.heard, observation)
        before = rows[:, AT] < x[TIME] - self._settings.max_delay
        advance(x, P, A, imu, rows, self._kernel)
        if not sound(x, P, A):
            return _refused(known, observation.now)
        place, covariance = centre(x, P, A, self._lever)
        known = known._replace(
            last=last,
            x=x,
            P=P,
            A=A,
            centre=place,
            covariance=covariance,
            heard=heard,
            late=known.late + late + int(before.sum()),
            track=_tracked(known.track, place, x),
        )
        return _judged(known, rows[~before], unusable, self._gates)

    def fuse(self, known: FlyerMemory, sightings: tuple[Sighting, ...]) -> FlyerMemory:  # noqa: ARG002
        """Return the memory as it is: sightings of markers are not used."""
        return known

    def pose_at(self, known: FlyerMemory, at: float) -> Transform | None:
        """Return body to mother-ship at `at` (s), None outside the last half second."""
        return replay_buffer.pose_in(known.track, at)

    def read(self, known: FlyerMemory) -> NavState:
        """Return the current estimate; that of the start before the first inertial sample."""
        return state_output.state(known, self._sources, self._surveyed, self._settings)


def _judged(
    known: FlyerMemory, rows: Mat, unusable: Sequence[str], gates: Mapping[int, float]
) -> FlyerMemory:
    """Count what was accepted: each range, and each frame as one.

    To the mean distance, a refused measurement adds that of its gate: it did not touch the state,
    and one outlier would drown fifty good ranges.
    """
    ranges, frames, rejected = known.ranges, known.frames, known.rejected
    for why in unusable:
        ranges, rejected = counted(ranges, known.now, accepted=False, why=why), rejected + 1
    whole: dict[float, tuple[float, bool]] = {}  # of each frame: its time, and any point of it
    distances: list[float] = []
    for row in rows.tolist():
        kind, at, accepted = row[KIND], row[AT], row[OUTCOME] == ACCEPTED
        rejected = 0 if accepted else rejected + 1
        m = 1 if kind == RANGE else 3
        distances.append(mahalanobis.distance(row[NIS] if accepted else gates[m], m))
        if kind == RANGE:
            ranges = counted(ranges, at, accepted=accepted)
        else:
            whole[kind] = (at, accepted or (kind in whole and whole[kind][1]))
    for at, accepted in whole.values():
        frames = counted(frames, at, accepted=accepted)
    distance = mahalanobis.averaged(known.distance, distances, known.now)
    return known._replace(ranges=ranges, frames=frames, rejected=rejected, distance=distance)


def _tracked(track: Mat, place: Vec3, x: Vec3) -> Mat:
    """Return the track with the newest pose."""
    if len(track) and x[TIME] <= track[-1, 0]:
        return track
    row = np.empty((1, 8))
    row[0, 0], row[0, 1:4], row[0, 4:8] = x[TIME], place[:3], x[QUATERNION:RATE]
    return np.concatenate((track[1 - KEEP :], row))


def _begun(x: Vec3, imu: Mat) -> Mat:
    """Let the state begin at the first usable sample; return the intervals after it.

    The first interval has no length, and half the mean of a sample and of nothing in it.
    """
    x[TIME] = imu[0, END]
    x[RATE:FORCE] = 2.0 * imu[0, GYRO : GYRO + 3]
    x[FORCE:TIME] = 2.0 * imu[0, ACCEL : ACCEL + 3]
    return imu[1:]


def _refused(known: FlyerMemory, now: float) -> FlyerMemory:
    """Return the memory without an observation that made the filter unsound."""
    why = "the latest measurements left the filter numerically invalid"
    lost = Acceptance(known.ranges.at, 1.0, diverged=True, why=why)
    return known._replace(now=now, ranges=lost)
