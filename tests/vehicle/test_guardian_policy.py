"""When the guardian steps in: every state with every event, without sockets or clock."""

import pytest

from missionkit.vehicle.guardian import policy
from missionkit.vehicle.guardian.policy import NEVER_YET, GuardianPhase, GuardianState

STEERED = GuardianState(GuardianPhase.STEERED, last_setpoint_at=10.0, ours=True)
STATES = {
    "watching": GuardianState(),
    "streaming": GuardianState(last_setpoint_at=10.0),  # setpoints, in another mode than theirs
    "steered": STEERED,
    "braking": STEERED._replace(phase=GuardianPhase.BRAKING),
    "holding": STEERED._replace(phase=GuardianPhase.HOLDING, since=10.5),
    "held": STEERED._replace(phase=GuardianPhase.HELD, since=10.5),
}
EVENTS = {
    "setpoint": lambda guard: policy.setpoint(guard, 10.6),
    "silent": policy.silent,
    "in_our_mode": lambda guard: policy.heard(guard, ours=True),
    "in_another": lambda guard: policy.heard(guard, ours=False),
    "stands": lambda guard: policy.moves(guard, 11.6, 0.1),
    "stands_at_once": lambda guard: policy.moves(guard, 10.7, 0.1),
    "flies_on": lambda guard: policy.moves(guard, 11.6, 2.0),
    "gone": lambda guard: policy.gone(guard, 10.6),
    "given": policy.given,
    "after_0.4_s": lambda guard: policy.waited(guard, 10.4),
    "after_0.6_s": lambda guard: policy.waited(guard, 10.6),
    "after_1.1_s": lambda guard: policy.waited(guard, 11.1),
    "after_6_s": lambda guard: policy.waited(guard, 16.0),
}
ENDS = {  # state: what each event leads to, where that is another one
    "watching": {},
    "streaming": {"in_our_mode": "steered", "gone": "holding"},
    "steered": {
        "silent": "watching",
        "in_another": "watching",
        "gone": "holding",
        "given": "watching",
        "after_0.6_s": "braking",
        "after_1.1_s": "holding",
        "after_6_s": "holding",
    },
    "braking": {
        "setpoint": "steered",
        "silent": "watching",
        "in_another": "watching",
        "gone": "holding",
        "given": "watching",
        "after_1.1_s": "holding",
        "after_6_s": "holding",
    },
    "holding": {
        "in_another": "held",
        "stands": "held",
        "given": "watching",
        "after_6_s": "held",
    },
    "held": {"given": "watching"},
}


@pytest.mark.parametrize("event", EVENTS)
@pytest.mark.parametrize("state", STATES)
def test_every_state_and_event(state, event):
    before = STATES[state]
    after = EVENTS[event](before)
    assert after.phase == ENDS[state].get(event, before.phase)
    assert after.refuses == (after.phase in {"holding", "held"})
    assert after.brakes == (after.phase in {"braking", "holding"})


def test_zero_velocity_comes_at_once_and_another_mode_only_after_a_heartbeat_that_came_later():
    holding = policy.gone(STEERED, 10.1)
    assert holding.brakes
    assert not holding.asks
    assert policy.heard(holding, ours=True).asks


@pytest.mark.parametrize("event", ["in_another", "stands", "after_6_s"])
def test_it_ends_with_its_process_when_nothing_is_left_to_stop(event):
    holding = policy.gone(STATES["holding"], 10.6)
    assert not holding.over
    assert EVENTS[event](holding).over


@pytest.mark.parametrize("state", ["watching", "steered", "braking"])
def test_after_a_mission_that_ended_by_its_own_command_the_guardian_is_idle(state):
    assert policy.gone(policy.silent(STATES[state]), 10.2).over


def test_a_mission_that_wakes_up_is_refused_until_a_person_gives_control_back():
    held = STATES["held"]
    for event in ("setpoint", "silent", "in_our_mode", "in_another", "after_6_s"):
        held = EVENTS[event](held)
        assert held.refuses
    awake = policy.setpoint(policy.given(policy.heard(held, ours=True)), 20.0)
    assert awake == GuardianState(GuardianPhase.STEERED, last_setpoint_at=20.0, ours=True)


def test_setpoints_from_before_the_process_took_control_count_for_nothing():
    assert policy.given(STEERED).last_setpoint_at == NEVER_YET
