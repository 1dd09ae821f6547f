"""From the active state to a command."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from misbehaving import with_odd_ones
from rehearsed import short
from samples import calm

from missionkit.engine.act import act
from missionkit.engine.flight_state import BehaviorState
from missionkit.engine.prepared_mission import PreparedMission, begin, prepare
from missionkit.geometry import norm, vec
from missionkit.messages import Action, Command, Estimate, Step, VehicleStatus
from missionkit.plugin_containment import Containment

CATALOGUE = with_odd_ones()
DOWN = VehicleStatus(10.0, armed=False, in_air=False, ready=True, mode="hold")
GO_HOME = "{kind: return, behavior: {use: go_to, target: home, height: 5, speed: 2}}"


class Pilot:
    """Lets one state act, tick by tick."""

    def __init__(self, state: str, *, name: str = "x", avoid: bool = False) -> None:
        field = "" if avoid else "avoid: none\n"
        land = "" if name == "land" else "  land: {kind: land}\n"
        field += "targets: {t: {position: [9, 9, -5]}}\n"
        text = f"{field}initial: {name}\nstates:\n  {name}: {state}\n{land}"
        self.name = name
        self.plan: PreparedMission = prepare(short(text, CATALOGUE), CATALOGUE)
        self.acting: BehaviorState = begin(self.plan).acting
        self.contain = Containment()

    def act(self, *, entered: bool = False, **changes: Any) -> tuple[Command, Step]:
        seen: Estimate = calm(state=self.name, **changes)
        if entered:
            self.acting = self.acting._replace(begun=False, done=False, goal=None)
        self.acting, command, step = act(self.plan, self.acting, seen, (), self.contain)
        return command, step


def speeds(pilot: Pilot, ticks: int, **changes: Any) -> list[float]:
    return [norm(pilot.act(**changes)[0].setpoint.velocity) for _ in range(ticks)]


def test_guidance_becomes_a_setpoint_towards_the_goal_within_its_speed():
    pilot = Pilot(GO_HOME)
    away = {"position": vec(30.0, 40.0, -5.0)}
    going = speeds(pilot, 60, **away)
    assert max(going) == pytest.approx(2.0, abs=0.01)
    command, _ = pilot.act(**away)
    np.testing.assert_allclose(command.setpoint.velocity, (-1.2, -1.6, 0.0), atol=0.01)
    assert command.action is None


@pytest.mark.parametrize("says", ["raise", "nothing", "nan", "two axes", "nan goal", "odd note"])
def test_a_behaviour_that_fails_makes_the_vehicle_hold(says):
    pilot = Pilot(f"{{kind: custom, behavior: {{use: odd, says: {says}}}}}")
    command, step = pilot.act(entered=True)
    assert norm(command.setpoint.velocity) == 0.0
    assert command.action is None
    assert step.note == "holding: a plug-in misbehaves"
    assert len(pilot.acting.failing) == 1
    assert pilot.acting.failing[0].startswith("odd ")


def test_no_goal_is_followed_while_the_estimate_has_diverged():
    pilot = Pilot(GO_HOME)
    away = {"position": vec(30.0, 40.0, -5.0)}
    assert speeds(pilot, 60, **away)[-1] == pytest.approx(2.0, abs=0.01)
    lost = {**away, "health": calm().health._replace(diverged=True)}
    slowing = speeds(pilot, 60, **lost)
    limit = pilot.plan.law.control.limits.acceleration
    assert slowing[-1] == pytest.approx(0.0, abs=0.01)
    assert max(-np.diff(slowing)) <= limit * pilot.plan.period + 1e-9
    command, step = pilot.act(**lost, velocity=vec(3.0, 0.0, 0.0))
    assert (step.note, step.done) == ("holding: the estimate has diverged", False)
    assert norm(command.setpoint.velocity) < 0.01
    assert speeds(pilot, 60, **away)[-1] == pytest.approx(2.0, abs=0.01)


def test_a_failure_in_flight_brings_the_vehicle_to_rest_within_the_limits():
    pilot = Pilot(GO_HOME)
    away = {"position": vec(30.0, 40.0, -5.0)}
    speeds(pilot, 60, **away)
    slowing = []
    for _ in range(60):
        pilot.contain.note("gust raised ValueError: no")
        slowing += speeds(pilot, 1, **away)
    assert slowing[-1] == pytest.approx(0.0, abs=0.01)
    assert all(after < before for before, after in pairwise(slowing))
    limit = pilot.plan.law.control.limits.acceleration
    assert max(-np.diff(slowing)) <= limit * pilot.plan.period + 1e-9


def test_a_guard_that_fails_holds_the_vehicle_and_the_behaviours_memory():
    pilot = Pilot("{kind: custom, behavior: {use: odd, says: well}}")
    pilot.act(entered=True)
    assert (pilot.acting.behavior, pilot.acting.failing) == ("kept", ())
    goal = pilot.acting.goal
    pilot.contain.note("gust raised ValueError: no")
    _, step = pilot.act()
    assert step.guidance is None
    assert (pilot.acting.behavior, pilot.acting.goal) == ("kept", goal)
    assert pilot.acting.failing == ("gust raised ValueError: no",)
    pilot.act()
    assert pilot.acting.failing == ()


def test_a_behaviour_that_cannot_begin_holds_for_that_tick():
    pilot = Pilot("{kind: custom, behavior: stillborn}")
    pilot.act(entered=True)
    assert pilot.acting.failing == ("stillborn raised RuntimeError: not today",)
    _, step = pilot.act()
    assert (step.note, pilot.acting.failing) == ("began with None", ())


def test_a_landing_continues_whatever_fails():
    pilot = Pilot("{kind: land}", name="land")
    pilot.contain.note("gust raised ValueError: no")
    assert pilot.act(entered=True)[0] == Command(action=Action.LAND)
    assert pilot.acting.failing == ("gust raised ValueError: no",)


@pytest.mark.parametrize("says", ["raise", "odd action", "nothing"])
def test_where_the_landing_itself_fails_the_autopilot_lands(says):
    pilot = Pilot(f"{{kind: land, behavior: {{use: odd, says: {says}}}}}", name="land")
    command, step = pilot.act(entered=True)
    assert command == Command(action=Action.LAND)
    assert (step.note, step.done) == ("landing: a plug-in misbehaves", False)


def test_while_the_autopilot_takes_off_no_setpoint_disturbs_it():
    pilot = Pilot("{kind: idle, behavior: {use: take_off, height: 4}}")
    rising = DOWN._replace(armed=True)
    assert pilot.act(entered=True, status=DOWN)[0] == Command(action=Action.ARM)
    assert pilot.act(status=rising)[0] == Command(action=Action.TAKE_OFF, height=4.0)
    climbing = rising._replace(in_air=True, mode="take_off")
    assert pilot.act(status=climbing, position=vec(0, 0, -1))[0] == Command(height=4.0)


def test_on_the_ground_nothing_is_commanded_without_guidance():
    pilot = Pilot("{kind: custom}")
    assert pilot.act(entered=True, status=DOWN)[0] == Command()
    assert pilot.act(status=None)[0] == Command()
    assert pilot.act()[0].setpoint is not None


def test_entering_a_state_drops_the_previous_behaviours_memory():
    pilot = Pilot("{kind: custom}")
    pilot.acting = pilot.acting._replace(behavior="old", begun=True, done=True, goal="old goal")
    pilot.act(entered=True, position=vec(1.0, 2.0, -3.0))
    np.testing.assert_array_equal(pilot.acting.behavior, (1.0, 2.0, -3.0))
    assert (pilot.acting.done, pilot.acting.goal) == (False, None)
    pilot.act(position=vec(9.0, 9.0, -9.0))
    np.testing.assert_array_equal(pilot.acting.behavior, (1.0, 2.0, -3.0))


def test_obstacles_push_unless_the_guidance_forbids_it():
    """A wall of points 2 m ahead on the way home."""
    away, wall = vec(30.0, 0.0, -5.0), np.array([[28.0, y, -5.0] for y in np.linspace(-3, 3, 25)])
    free, warned = (Pilot(GO_HOME, avoid=avoid) for avoid in (False, True))
    for pilot in (free, warned):
        speeds(pilot, 40, position=away, obstacles=wall, scanned_at=10.0)
    unhindered, pushed = (
        pilot.act(position=away, obstacles=wall, scanned_at=10.0)[0].setpoint.velocity[0]
        for pilot in (free, warned)
    )
    assert unhindered == pytest.approx(-2.0, abs=0.05)
    assert pushed > -0.5


@pytest.mark.parametrize(
    "state",
    [
        "{kind: custom, behavior: {use: odd, says: raise}}",
        "{kind: custom, behavior: {use: servo, target: t}}",
        GO_HOME,
    ],
    ids=["a plug-in misbehaves", "a marker is out of sight", "the the position of goal is unknown"],
)
def test_standing_still_is_holding_a_place(state):
    """Pushed 2 m off, it comes back: a velocity of zero would drift with the wind."""
    pilot = Pilot(state)
    pilot.act(entered=True, position=vec(3.0, 4.0, -5.0), home=None)
    for _ in range(20):
        command, step = pilot.act(position=vec(3.0, 6.0, -5.0), home=None)
    assert step.guidance is None
    assert command.setpoint.velocity[1] == pytest.approx(-1.5, abs=0.1)
    np.testing.assert_allclose(pilot.acting.held.position, (3.0, 4.0, -5.0))


def test_the_place_is_where_the_vehicle_comes_to_rest_and_is_given_up_with_the_next_goal():
    pilot = Pilot(GO_HOME)
    pilot.contain.note("gust raised ValueError: no")
    pilot.act(velocity=vec(3.0, 0.0, 0.0))
    assert 2.0 < pilot.acting.held.position[0] < 3.0
    pilot.act()
    assert pilot.acting.held is None


def test_without_a_sound_estimate_no_place_is_held():
    pilot = Pilot("{kind: custom, behavior: {use: odd, says: raise}}")
    lost = calm().health._replace(diverged=True)
    command, _ = pilot.act(entered=True, health=lost, position=vec(3.0, 4.0, -5.0))
    assert pilot.acting.held is None
    command, _ = pilot.act(health=lost, position=vec(3.0, 9.0, -5.0))
    assert norm(command.setpoint.velocity) == 0.0


def test_a_scanner_that_falls_silent_stops_the_vehicle():
    pilot = Pilot(GO_HOME, avoid=True)
    away, nothing = vec(30.0, 0.0, -5.0), np.empty((0, 3))
    speeds(pilot, 40, position=away, obstacles=nothing, scanned_at=10.0)
    command, step = pilot.act(now=10.4, position=away, scanned_at=10.0)
    assert (step.note, command.setpoint.velocity[0]) == ("", pytest.approx(-2.0, abs=0.05))
    command, step = pilot.act(now=10.6, position=away, scanned_at=10.0)
    assert step.note == "holding: the obstacle scanner is silent"
    assert norm(command.setpoint.velocity) <= 0.5


def test_braking_before_an_obstacle_does_not_wait_for_the_comfort_limit():
    pilot = Pilot(GO_HOME.replace("speed: 2", "speed: 6"), avoid=True)
    away, clear = vec(30.0, 0.0, -5.0), np.empty((0, 3))
    fast = {"position": away, "velocity": vec(-6.0, 0.0, 0.0), "scanned_at": 10.0}
    speeds(pilot, 60, **fast, obstacles=clear)
    wall = np.array([[26.0, 0.0, -5.0]])
    command, _ = pilot.act(**{**fast, "scanned_at": 10.1}, obstacles=wall)
    assert command.setpoint.velocity[0] > 0.0
    assert pilot.acting.control.pushed


def test_before_a_landing_the_vehicle_is_brought_to_rest_by_a_velocity_of_zero():
    pilot = Pilot("{kind: land}", name="land")
    flying = VehicleStatus(10.0, armed=True, in_air=True, ready=True, mode="offboard")
    lost = calm().health._replace(diverged=True)
    command, _ = pilot.act(entered=True, status=flying, velocity=vec(4, 0, 0), health=lost)
    assert command.action is None
    assert norm(command.setpoint.velocity) == 0.0
    assert pilot.acting.held is None
    command, _ = pilot.act(now=14.5, status=flying, velocity=vec(4, 0, 0))
    assert command == Command(action=Action.LAND)
