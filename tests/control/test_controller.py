from __future__ import annotations

import math
import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from missionkit.control.controller import Control, ControlMemory
from missionkit.control.velocity_limits import Limits
from missionkit.geometry import IDENTITY, vec
from missionkit.messages import Estimate, Guidance, HalfSpace, Health, Mode

HEALTH = Health(True, False, 0.0, 0.0, 0.1, 0)
anything = st.floats(allow_nan=True, allow_infinity=True)
triples = st.tuples(anything, anything, anything).map(np.array)
flown = st.floats(-1e4, 1e4)
flown_triples = st.tuples(flown, flown, flown).map(np.array)


def estimate(position, velocity):
    return Estimate(0.0, position, velocity, IDENTITY, np.zeros(3), HEALTH)


def within_limits(setpoint, limits: Limits, control: Control) -> bool:
    x, y, z = setpoint.velocity
    return (
        math.hypot(x, y) <= limits.speed + 1e-9
        and -limits.climb - 1e-9 <= z <= limits.descent + 1e-9
        and abs(setpoint.yaw_rate) <= math.radians(control.yaw.max_rate_deg) + 1e-9
    )


@given(triples, triples, triples, triples, anything, anything, anything, st.sampled_from(Mode))
def test_the_output_is_finite_and_within_limits_for_any_input(
    goal, reference, position, velocity, speed, yaw, dt, mode
):
    control, memory = Control(), ControlMemory()
    guidance = Guidance(goal, speed, reference, yaw)
    for _ in range(3):
        setpoint, memory = control.step(
            memory, mode, guidance, estimate(position, velocity), dt, push=reference
        )
        assert np.isfinite(setpoint.velocity).all()
        assert math.isfinite(setpoint.yaw_rate)
        assert within_limits(setpoint, control.limits, control)


@given(flown_triples, flown_triples, flown_triples, st.floats(0.0, 20.0))
def test_acceleration_and_guidance_speed_are_respected(goal, velocity, reference, speed):
    control, memory = Control(), ControlMemory()
    last = np.zeros(3)
    for _ in range(40):
        setpoint, memory = control.step(
            memory,
            Mode.TRAJECTORY,
            Guidance(goal, speed, reference),
            estimate(np.zeros(3), velocity),
            0.05,
        )
        change = setpoint.velocity - last
        last = setpoint.velocity
        assert np.hypot(*change[:2]) <= control.limits.acceleration * 0.05 + 1e-9
        assert abs(change[2]) <= control.limits.vertical_acceleration * 0.05 + 1e-9
        assert np.linalg.norm(last) <= speed + 1e-9


def test_recovers_from_a_tick_that_was_not_a_number():
    control = Control()
    bad = estimate(vec(math.nan, 0, 0), np.zeros(3))
    good = estimate(np.zeros(3), np.zeros(3))
    guidance = Guidance(vec(10, 0, 0), 5.0)
    memory = control.begin()
    for _ in range(5):
        first, memory = control.step(memory, Mode.GPS, guidance, good, 0.05)
    held, memory = control.step(memory, Mode.GPS, guidance, bad, 0.05)
    again, memory = control.step(memory, Mode.GPS, guidance, good, 0.05)
    assert 0.0 < held.velocity[0] < first.velocity[0]
    assert again.velocity[0] > held.velocity[0]


def test_mode_none_is_zero_at_once():
    control = Control()
    memory = ControlMemory(velocity=(3.0, 0.0, 0.0))
    guidance = Guidance(vec(10, 0, 0), 5.0)
    seen = estimate(np.zeros(3), np.zeros(3))
    setpoint, memory = control.step(memory, Mode.NONE, guidance, seen, 0.05)
    assert not setpoint.velocity.any()
    assert memory == control.begin()


@pytest.mark.parametrize("dt", [0.1, 0.2, 5.0])
def test_after_a_long_gap_the_velocity_changes_no_more_than_after_a_short_one(dt):
    control, seen = Control(), estimate(np.zeros(3), np.zeros(3))
    guidance = Guidance(vec(100, 0, -100), 8.0)
    setpoint, _ = control.step(ControlMemory(), Mode.GPS, guidance, seen, dt)
    north, _, down = setpoint.velocity
    assert north == pytest.approx(control.limits.acceleration * min(dt, 0.2))
    assert down == pytest.approx(-control.limits.vertical_acceleration * min(dt, 0.2))


@pytest.mark.parametrize(
    ("shove", "gap", "waits"),
    [(1.0, 50.0, True), (1.0, None, True), (0.0, 50.0, False), (0.0, 0.05, True)],
)
def test_the_integrator_waits_while_avoidance_or_a_plane_moves_the_vehicle(shove, gap, waits):
    control, seen = Control(), estimate(np.zeros(3), vec(0.2, 0, 0))
    bound = None if gap is None else HalfSpace(vec(gap, 0, 0), vec(-1, 0, 0))
    guidance, push = Guidance(vec(0.5, 0, 0), 2.0), vec(0, shove, 0)
    memory = ControlMemory(velocity=(0.5, 0.0, 0.0))
    _, memory = control.step(memory, Mode.GPS, guidance, seen, 0.05, push=push, bound=bound)
    assert memory.pushed is waits
    charged = memory.pid
    _, memory = control.step(memory, Mode.GPS, guidance, seen, 0.05, push=push, bound=bound)
    assert (memory.pid == charged) is waits


@pytest.mark.parametrize("avoid", [True, False])
def test_push_counts_only_where_the_guidance_allows_it(avoid):
    control, memory = Control(), ControlMemory()
    seen = estimate(np.zeros(3), np.zeros(3))
    guidance = Guidance(vec(50, 0, 0), 2.0, avoid=avoid)
    for _ in range(60):
        setpoint, memory = control.step(
            memory, Mode.GPS, guidance, seen, 0.05, push=vec(-2.0, 1.0, 0.0)
        )
    expected = (0.0, 1.0, 0.0) if avoid else (2.0, 0.0, 0.0)
    np.testing.assert_allclose(setpoint.velocity, expected, atol=1e-6)


@pytest.mark.parametrize(("gap", "turns"), [(5.0, False), (1.0, True)])
def test_near_its_goal_the_yaw_law_turns_to_the_heading_that_is_wanted_there(gap, turns):
    """The third branch of P1's law; before it the nose looks at the goal."""
    control, goal = Control(), vec(10.0, 0.0, -5.0)
    guidance = Guidance(goal, 2.0, final_yaw=math.pi / 2)
    here = estimate(goal - vec(gap, 0.0, 0.0), np.zeros(3))
    setpoint, memory = control.step(ControlMemory(), Mode.GPS, guidance, here, 0.05)
    assert (setpoint.yaw_rate > 0.5) is turns
    assert memory.yaw.held == pytest.approx(math.pi / 2 if turns else 0.0)
    odd, memory = control.step(memory, Mode.GPS, guidance._replace(final_yaw=math.nan), here, 0.05)
    assert math.isfinite(odd.yaw_rate)
    assert math.isfinite(memory.yaw.held)


def test_memory_can_be_saved_and_control_is_pure():
    control = Control()
    seen = estimate(vec(1, 2, 3), vec(0.5, 0, 0))
    guidance = Guidance(vec(9, 9, 0), 5.0)
    _, memory = control.step(control.begin(), Mode.GPS, guidance, seen, 0.05)
    saved = pickle.loads(pickle.dumps(memory))  # noqa: S301
    one, after_one = control.step(memory, Mode.GPS, guidance, seen, 0.05)
    two, after_two = control.step(saved, Mode.GPS, guidance, seen, 0.05)
    assert one.velocity.tobytes() == two.velocity.tobytes()
    assert after_one == after_two


@pytest.mark.parametrize(
    "section",
    [
        {"gsp": {}},
        {"gps": {"kp": [0.0, 1.0]}},
        {"limits": {"speed": float("nan")}},
        {"alpha": 1.5},
        {"yaw": {"near": 60.0}},
    ],
)
def test_wrong_sections_are_refused(section):
    with pytest.raises(ValidationError):
        Control.model_validate(section)


def test_section_as_a_mission_writes_it():
    control = Control.model_validate(
        {"visual": {"kp": [0.5, 0.6]}, "limits": {"speed": 6}, "yaw": {"far": 40}}
    )
    assert control.visual.kp == (0.5, 0.6)
    assert control.limits.speed == 6.0
