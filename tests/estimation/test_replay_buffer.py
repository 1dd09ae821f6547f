"""Measurements that come late, against the same ones delivered in order."""

from __future__ import annotations

import numpy as np
import pytest

from missionkit.estimation.error_state_ekf import replay_buffer, state_layout
from missionkit.estimation.error_state_ekf.measurement_log import row
from missionkit.frames import Timed, interpolate
from missionkit.geometry import GRAVITY, Transform, vec

NOISE = np.square([0.02, 0.0015, 3e-4, 2e-5, 0.01, 2.0, 0.5])
GATES = np.array([0.0, 15.1, 18.4, 21.1])
TICKS, STEP = 30, 5


def start():
    x = np.array([0, 0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 6.0, 1.0, -1.0])
    return replay_buffer.begin(0.0, x, np.diag(np.repeat([1.0, 0.1, 0.01, 0.01, 1e-5, 1.0], 3)))


@pytest.fixture
def flight():
    """Inertial intervals of each tick, and measurements, two of them at the very same time."""
    rng = np.random.default_rng(3)
    imu = np.zeros((TICKS * STEP, 8))
    imu[:, 0] = 0.01 * np.arange(1, TICKS * STEP + 1)
    imu[:, 1:7] = rng.normal(size=(len(imu), 6)) * 0.3 + [0, 0, -GRAVITY, 0, 0, 0]
    kinds = [
        state_layout.FIX,
        state_layout.FIX_VELOCITY,
        state_layout.SIGHT,
        state_layout.SIGHT,
        state_layout.HEIGHT,
    ]
    places = {state_layout.SIGHT: vec(6.0, 1.0, -1.0)}
    times = rng.uniform(0.01, TICKS * 0.05 - 0.35, size=25)
    times[1] = times[0]
    times[2] = imu[20, 0]
    rows = [
        row(k, t, places.get(k, np.zeros(3)) + 0.2 * rng.normal(size=3), np.full(3, 0.04))
        for k, t in zip(kinds * 5, times, strict=True)
    ]
    return imu.reshape(TICKS, STEP, 8), rows


def fly(imu, deliveries):
    """`deliveries`: (tick, row); returns the end and how many rows were decided."""
    past, decided, late = start(), 0, 0
    for n, steps in enumerate(imu):
        rows = [r.copy() for tick, r in deliveries if tick == n]
        out = replay_buffer.extended(past, steps, rows, NOISE, GATES, 0.5)
        past, decided, late = out.history, decided + len(out.decided), late + out.late
    return past, decided, late


def test_delay_changes_nothing(flight):
    imu, rows = flight
    rng = np.random.default_rng(4)
    tick_of = [int(r[state_layout.AT] // 0.05) for r in rows]
    punctual, count, _ = fly(imu, list(zip(tick_of, rows, strict=True)))
    delayed, count_delayed, late = fly(
        imu, [(n + int(rng.integers(0, 6)), r) for n, r in zip(tick_of, rows, strict=True)]
    )
    assert count == count_delayed == len(rows)
    assert late == 0
    np.testing.assert_allclose(delayed.xs[-1], punctual.xs[-1], atol=1e-9)
    np.testing.assert_allclose(delayed.Ps[-1], punctual.Ps[-1], atol=1e-9)
    np.testing.assert_allclose(delayed.track, punctual.track, atol=1e-9)


def test_ignoring_the_delay_would_matter(flight):
    """The same rows stamped with the time they arrive give another answer."""
    imu, rows = flight
    exact, _, _ = fly(imu, [(int(r[state_layout.AT] // 0.05) + 3, r) for r in rows])
    naive = []
    for r in rows:
        stamped = r.copy()
        stamped[state_layout.AT] += 0.15
        naive.append((int(stamped[state_layout.AT] // 0.05), stamped))
    wrong, _, _ = fly(imu, naive)
    assert np.abs(wrong.xs[-1][:3] - exact.xs[-1][:3]).max() > 1e-3


def test_a_measurement_older_than_the_history_is_dropped_and_counted(flight):
    imu, _ = flight
    old = row(state_layout.FIX, 0.4, vec(0, 0, 0), np.full(3, 0.1))
    _, decided, late = fly(imu, [(28, old)])
    assert (decided, late) == (0, 1)
    _, decided, late = fly(imu, [(15, old)])
    assert (decided, late) == (1, 0)


def test_a_measurement_ahead_of_the_samples_waits_for_them(flight):
    imu, _ = flight
    ahead = row(state_layout.FIX, 0.073, vec(0, 0, 0), np.full(3, 0.1))
    out = replay_buffer.extended(start(), imu[0], [ahead], NOISE, GATES, 0.5)
    assert len(out.decided) == 0
    assert replay_buffer.outcome(out.history, ahead) == state_layout.PENDING
    out = replay_buffer.extended(out.history, imu[1], [], NOISE, GATES, 0.5)
    assert replay_buffer.outcome(out.history, ahead) == state_layout.ACCEPTED


def test_the_past_passed_in_is_not_changed(flight):
    imu, rows = flight
    past = start()
    for n in range(3):
        past = replay_buffer.extended(past, imu[n], [], NOISE, GATES, 0.5).history
    copies = [a.copy() for a in past]
    replay_buffer.extended(
        past, imu[3], [r for r in rows if r[state_layout.AT] < 0.2], NOISE, GATES, 0.5
    )
    for a, b in zip(past, copies, strict=True):
        np.testing.assert_array_equal(a, b)


def test_poses_in_between(flight):
    imu, _ = flight
    past, _, _ = fly(imu, [])
    a, b = past.track[-2], past.track[-1]
    pose = replay_buffer.pose_at(past, 0.5 * (a[0] + b[0]))
    np.testing.assert_allclose(pose.translation, 0.5 * (a[1:4] + b[1:4]), atol=1e-12)
    assert replay_buffer.pose_at(past, 0.3) is None
    assert replay_buffer.pose_at(past, b[0] + 0.01) is not None
    assert replay_buffer.pose_at(past, b[0] + 0.1) is None


def test_the_pose_between_two_rows_is_that_of_the_frame_tree_to_the_bit():
    rng = np.random.default_rng(3)
    turns = rng.normal(size=(20, 4))
    turns /= np.linalg.norm(turns, axis=1)[:, None]
    track = np.column_stack([0.01 * np.arange(20), rng.normal(size=(20, 3)), turns])
    poses = [Timed(it[0], Transform(it[4:8], it[1:4])) for it in track]
    for at in rng.uniform(0.0, 0.19, 50):
        pose = replay_buffer.pose_in(track, at)
        expected = interpolate(poses, at)
        assert pose.rotation.tobytes() == expected.rotation.tobytes()
        assert pose.translation.tobytes() == expected.translation.tobytes()
