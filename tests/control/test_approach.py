"""The position controller on a vehicle with lag: no overshoot, no oscillation."""

from __future__ import annotations

import numpy as np
import pytest
from lagging import fly

from missionkit.control.controller import Control
from missionkit.geometry import norm, vec
from missionkit.goal_pose import HOVER_SLACK
from missionkit.messages import Guidance, HalfSpace, Mode

MODES = (Mode.GPS, Mode.VISUAL, Mode.TRAJECTORY)


def settled_after(track, goal, tolerance=0.1):
    gap = np.linalg.norm(track.position - goal, axis=1)
    outside = np.flatnonzero(gap > tolerance)
    return track.time[outside[-1]] if gap[-1] < tolerance else np.inf


def overshoot(track, goal):
    return float(((track.position - goal) @ (goal / norm(goal))).max())


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("goal", [vec(40, 0, 0), vec(4, 3, 0), vec(1, 0, 0), vec(20, 20, -6)])
def test_arrives_without_overshoot(mode, goal):
    way = goal / norm(goal)
    before = (
        HalfSpace(goal + HOVER_SLACK * way, -way) if mode is Mode.VISUAL else None
    )  # as servo says
    top = 1.0 if mode is Mode.VISUAL else 5.0
    wait = norm(goal) / top + 8.0
    track = fly(Control(), lambda t: Guidance(goal, top), wait + 9.0, lambda t: mode, bound=before)
    assert overshoot(track, goal) < 0.1
    assert settled_after(track, goal) < wait
    assert np.linalg.norm(track.velocity, axis=1).max() < 5.05


@pytest.mark.parametrize("mode", MODES)
def test_integrator_takes_out_a_constant_disturbance(mode):
    goal, wind = vec(10, 0, -3), vec(0.4, 0.2, 0.1)
    track = fly(
        Control(), lambda t: Guidance(goal, 5.0), 40.0, lambda t: mode, disturbance=lambda t: wind
    )
    assert norm(track.position[-1] - goal) < 0.02
    assert settled_after(track, goal) < 20.0
    np.testing.assert_allclose(track.command[-1], -wind, atol=0.02)


def test_saturation_leaves_nothing_wound_up():
    """Held back for 20 s by a wind stronger than the speed limit, then let go."""
    goal = vec(0.8, 0, 0)

    def wind(t):
        return vec(-1.0, 0, 0) if t < 20.0 else np.zeros(3)

    track = fly(Control(), lambda t: Guidance(goal, 0.6), 45.0, disturbance=wind)
    assert overshoot(track, goal) < 0.2
    assert settled_after(track, goal) < 40.0


def test_trajectory_is_followed_without_lag_thanks_to_feed_forward():
    def circle(t):
        w, r = 0.3, 5.0
        position = vec(r * np.sin(w * t), r - r * np.cos(w * t), 0)
        return Guidance(position, 3.0, vec(r * w * np.cos(w * t), r * w * np.sin(w * t), 0))

    errors = {}
    for alpha in (0.0, 1.0):
        track = fly(Control(alpha_ff=alpha), circle, 30.0, lambda t: Mode.TRAJECTORY)
        wanted = np.array([circle(t).position for t in track.time])
        errors[alpha] = np.linalg.norm(track.position - wanted, axis=1)[200:].max()
    assert errors[1.0] < 0.35
    assert errors[0.0] > 2.0 * errors[1.0]


def test_change_of_mode_makes_no_bump():
    goal, wind = vec(5, 0, 0), vec(0.3, 0, 0)
    track = fly(
        Control(),
        lambda t: Guidance(goal, 5.0),
        40.0,
        mode=lambda t: Mode.GPS if t < 30.0 else Mode.VISUAL,
        disturbance=lambda t: wind,
    )
    late = track.time > 28.0
    assert np.linalg.norm(track.position[late] - goal, axis=1).max() < 0.05


def test_loss_of_guidance_stops_smoothly():
    goal = vec(100, 0, 0)
    control = Control()
    track = fly(control, lambda t: Guidance(goal, 5.0) if t < 8.0 else None, 14.0)
    steps = np.linalg.norm(np.diff(track.command, axis=0), axis=1)
    assert steps.max() <= control.limits.acceleration * 0.05 + 1e-9
    assert norm(track.command[-1]) < 1e-3
    assert norm(track.velocity[-1]) < 0.05


def test_yaw_servo_and_cruise():
    goal = vec(0, 30, 0)
    track = fly(Control(), lambda t: Guidance(goal, 5.0), 5.0)
    assert track.yaw[-1] == pytest.approx(np.pi / 2, abs=0.05)
    servo = fly(Control(), lambda t: Guidance(goal, 5.0, yaw=-2.5), 6.0)
    assert servo.yaw[-1] == pytest.approx(-2.5, abs=0.02)
    assert np.abs(np.diff(servo.yaw)).max() <= np.radians(60) * 0.05 + 1e-9
