"""The visual-inertial navigator: memory in, memory out."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from scipy.special import chdtri

from missionkit.estimation.error_state_ekf import (
    filter_memory,
    initialization,
    innovation_monitor,
    measurement_log,
    moving_target,
    process_model,
    realignment,
    replay_buffer,
    reset,
    state_output,
    target_attitude,
)
from missionkit.estimation.error_state_ekf.filter_memory import FilterMemory, TargetTrack
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.estimation.error_state_ekf.replay_buffer import ReplayBuffer
from missionkit.estimation.error_state_ekf.state_layout import (
    ACCEPTED,
    AT,
    FIX,
    FIX_VELOCITY,
    OUTCOME,
    REJECTED,
)
from missionkit.estimation.linear_algebra import multiply
from missionkit.estimation.navigator import NavState
from missionkit.frames import NO_MOTION, FrameTree, Timed, held
from missionkit.geometry import IDENTITY, Mat, Transform, Vec3
from missionkit.messages import Observation, Sighting

NO_IMU = np.empty((0, 7))


class ErrorStateEkf:
    """Error-state EKF with delayed measurements, alignment, gates and recovery.

    Source: P1 section 6.1; parameters and equations: `VisualInertialEkf`.
    """

    def __init__(
        self,
        settings: VisualInertialEkf,
        surveyed: Mapping[str, tuple[Vec3, float]],
        mount: Transform,
    ) -> None:
        s = self._settings = settings
        self._mount = mount
        self._names = tuple(surveyed)
        self._places = np.array([p for p, _ in surveyed.values()]).reshape(-1, 3)  # (m, 3), m, NED
        self._sds = np.array([sd for _, sd in surveyed.values()], dtype=np.float64)  # (m,), m
        walks = [s.accel_bias_walk, s.gyro_bias_walk, s.target_walk]
        self._noise = np.square([s.accel_noise, s.gyro_noise, *walks, s.gap_accel, s.gap_rate])
        self._gates = np.array([0.0, *(float(chdtri(m, 1.0 - s.gate)) for m in (1, 2, 3))])

    def begin(self) -> FilterMemory:
        """Return the memory before the first observation."""
        return filter_memory.begin(len(self._names))

    def propagate(self, known: FilterMemory, observation: Observation) -> FilterMemory:
        """Return the memory after one observation: alignment first, then prediction and update."""
        if not self._settings.gnss:
            observation = replace(observation, gnss=None)
        status = observation.status
        parked = known.parked if status is None else not (status.in_air or status.armed)
        known = known._replace(now=observation.now, broken=False, parked=parked)
        if known.past is None:
            return self._align(known, observation)
        samples = measurement_log.samples(observation.imu)
        gap = realignment.gap(samples, known.last)
        if known.missing or gap > self._settings.longest_gap:
            return self._realign(known, known.past, observation, gap)
        rows = measurement_log.observed(observation, self._settings)
        after = self._advance(known, known.past, samples, rows)
        more = after.monitor.refused[FIX] > known.monitor.refused[FIX]
        return self._recover(after) if more else after

    def fuse(self, known: FilterMemory, sightings: tuple[Sighting, ...]) -> FilterMemory:
        """Return the memory after sightings, each of which counts at its exposure's time.

        Sightings of targets that were not surveyed are left aside.
        """
        past, moving = known.past, self._settings.moving
        if past is None or known.missing:
            return known
        for sighting in (s for s in sightings if s.target in moving and s.target in self._names):
            known = self._followed(known, past, sighting)
        seen = [s for s in sightings if s.target in self._names and s.target not in moving]
        if not seen:
            return known
        rows = [self._row(s) for s in seen]
        known = self._advance(known, past, NO_IMU, rows)
        for sighting, row in zip(seen, rows, strict=True):
            known = self._look(known, sighting, row)
        return known

    def pose_at(self, known: FilterMemory, at: float) -> Transform | None:
        """Return body to world at `at` (s), None outside the last `max_delay` seconds."""
        return None if known.past is None else replay_buffer.pose_at(known.past, at)

    def frames(self, known: FilterMemory) -> FrameTree:
        """Return the chain world <- odom <- base <- camera, and the targets, over the buffer.

        Odom is the world without the resets of the position: `base` moves in it by motion and by
        corrections that pass the gates, never by a reset.  Source: P1 section 9.3.
        """
        track = () if known.past is None else map(replay_buffer.timed, known.past.track)
        jumps = known.corrections
        poses = [
            Timed(p.at, (held(jumps, p.at) or NO_MOTION).inverse() @ p.transform) for p in track
        ]
        tree = FrameTree().stepping("odom", "world", jumps).moving("base", "odom", poses)
        tree = tree.fixed("camera", "base", self._mount)
        for name, target in self.read(known).targets.items():
            rotation = IDENTITY if target.attitude is None else target.attitude
            tree = tree.fixed(name, "world", Transform(rotation, target.position))
        return tree

    def read(self, known: FilterMemory) -> NavState:
        """Return the current estimate; zeros and identity until aligned."""
        if known.past is None:
            return state_output.unaligned(self._names, self._places, self._sds, self._settings)
        return state_output.aligned(known, known.past, self._names, self._settings)

    def _row(self, seen: Sighting) -> Vec3:
        index = self._names.index(seen.target)
        return measurement_log.sighted(seen, index, self._mount, self._settings.bearing_sd)

    def _align(self, known: FilterMemory, observation: Observation) -> FilterMemory:
        new = measurement_log.resting(observation)
        heard = initialization.gathered(known.heard, new, self._settings.align_for)
        sds = np.hypot(self._sds, self._settings.fix_drift_sd)
        start = initialization.aligned(heard, self._places, sds, self._settings)
        if start is None:
            return known._replace(heard=heard)
        past = replay_buffer.begin(start.at, start.x, start.P)
        monitor = innovation_monitor.stood(known.monitor, heard.fixes)
        return known._replace(
            heard=initialization.begin(), last=heard.imu[-1], past=past, monitor=monitor
        )

    def _realign(
        self, known: FilterMemory, past: ReplayBuffer, observation: Observation, gap: float
    ) -> FilterMemory:
        """Gather what a new beginning takes; the old state stands, as diverged, until it is made.

        Another gap meanwhile begins the gathering again: a window of samples has no hole.
        """
        s, again = self._settings, gap > self._settings.longest_gap
        new = measurement_log.resting(observation)
        before = initialization.begin() if again else known.heard
        heard = initialization.gathered(before, new, realignment.SAMPLE_TIME)
        last = known.last if len(new.imu) == 0 else new.imu[-1]
        known = known._replace(heard=heard, last=last, missing=known.missing + gap * again)
        since = float(last[0] - past.times[-1])
        start = realignment.begun(heard, past.xs[-1], past.Ps[-1], since, s)
        if start is None:
            return known
        monitor = innovation_monitor.stood(innovation_monitor.begin(), heard.fixes)
        monitor = monitor._replace(late=known.monitor.late, resets=known.monitor.resets + 1)
        total = known.corrections[-1].transform.translation + start.x[0:3] - past.xs[-1][0:3]
        moved = Timed(start.at, Transform(IDENTITY, total))
        return known._replace(
            heard=initialization.begin(),
            past=replay_buffer.begin(start.at, start.x, start.P),
            monitor=monitor,
            corrections=(known.corrections[-1], moved),
            missing=0.0,
        )

    def _advance(
        self, known: FilterMemory, past: ReplayBuffer, samples: Mat, rows: list[Vec3]
    ) -> FilterMemory:
        """Add samples (n, 7) and log rows to `past`; if the result is unsound, change nothing."""
        s = self._settings
        good, bad = measurement_log.timely(rows, known.now)
        last = known.last.copy()
        imu = process_model.intervals(samples, last, s.max_gap)
        out = replay_buffer.extended(past, imu, good, self._noise, self._gates, s.max_delay)
        if not out.sound:
            return known._replace(broken=True)
        monitor = innovation_monitor.counted(known.monitor, out, bad, known.now)
        return known._replace(past=out.history, last=last, monitor=monitor)

    def _recover(self, known: FilterMemory) -> FilterMemory:
        """Believe a fix that was refused, if it is time to; the jump goes into world <- odom."""
        past = known.past
        fixes = [] if past is None else replay_buffer.newest(past, (FIX, FIX_VELOCITY))
        if past is None or not fixes or fixes[0][OUTCOME] != REJECTED:
            return known
        forget = reset.forget_vehicle(
            known.monitor, fixes, known.now, self._settings, parked=known.parked
        )
        if forget is None:
            return known
        at, again = float(fixes[0][AT]), [replay_buffer.pending(r) for r in fixes]
        known = self._advance(known, replay_buffer.without(past, fixes), NO_IMU, [forget, *again])
        before, after = past.xs[-1][0:3], (known.past or past).xs[-1][0:3]
        total = known.corrections[-1].transform.translation + after - before
        moved = Timed(at, Transform(IDENTITY, total))
        monitor = known.monitor._replace(resets=known.monitor.resets + 1)
        return known._replace(corrections=(known.corrections[-1], moved), monitor=monitor)

    def _look(self, known: FilterMemory, seen: Sighting, row: Vec3) -> FilterMemory:
        """Draw the consequences of one sighting for its target's track."""
        past, i = known.past, self._names.index(seen.target)
        body = None if past is None else replay_buffer.pose_at(past, seen.at)
        if past is None or body is None or not measurement_log.sound(seen):
            return known
        track, camera = known.tracks[i], body @ self._mount
        verdict = replay_buffer.outcome(past, row)
        if verdict == ACCEPTED:
            track = self._faced(track, seen, camera, past)
        elif verdict == REJECTED:
            count = self._settings.relocate_after
            place = camera.apply(seen.pose.translation)
            strays = np.concatenate((track.strays[1 - count :], place[None]))
            track = track._replace(strays=strays)
            sd = math.hypot(
                seen.position_sd,
                innovation_monitor.horizontal_sd(past.Ps[-1], self._settings.fix_drift_sd),
            )
            if reset.agreeing(strays, count, sd):
                again = [reset.forget_target(row), row]
                known = self._advance(known, replay_buffer.without(past, [row]), NO_IMU, again)
                track = TargetTrack(track.facing, seen.at)
        return known._replace(tracks=(*known.tracks[:i], track, *known.tracks[i + 1 :]))

    def _followed(self, known: FilterMemory, past: ReplayBuffer, seen: Sighting) -> FilterMemory:
        """Take in a sighting of a target that moves."""
        s, i = self._settings, self._names.index(seen.target)
        body = replay_buffer.pose_at(past, seen.at)
        if body is None or not measurement_log.sound(seen):
            return known
        place = (body @ self._mount).apply(seen.pose.translation)
        track = known.tracks[i]
        motion = moving_target.sighted(
            track.motion,
            seen.at,
            place,
            seen.position_sd,
            float(self._gates[3]),
            s.moving_accel,
            s.moving[seen.target],
        )
        track = track._replace(motion=motion, seen_at=motion.at)
        return known._replace(tracks=(*known.tracks[:i], track, *known.tracks[i + 1 :]))

    def _faced(
        self, track: TargetTrack, seen: Sighting, camera: Transform, past: ReplayBuffer
    ) -> TargetTrack:
        turn = track.facing
        if not seen.ambiguous:
            variance = seen.angle_sd**2 + state_output.angle_variance(past.Ps[-1])
            gate = float(self._gates[3])
            attitude = multiply(camera.rotation, seen.pose.rotation)
            turn = target_attitude.turned(turn, attitude, variance, seen.at, gate, self._settings)
        return TargetTrack(turn, seen.at)
