"""The flight home: climb, fly, wait, land.

PX4: https://docs.px4.io/main/en/flight_modes_mc/return.html (RTL_RETURN_ALT within a cone of
RTL_CONE_ANG around home). ArduPilot: https://ardupilot.org/copter/docs/rtl-mode.html (RTL_ALT,
RTL_CONE_SLOPE, RTL_LOIT_TIME).
"""

from __future__ import annotations

import math

from missionkit.geometry import Vec3, vec
from missionkit.messages import Action, Command
from missionkit.sitl.flight_primitives import (
    act,
    cruise,
    there,
    to,
)
from missionkit.sitl.setpoint_tracking import SetpointTarget, towards
from missionkit.sitl.sitl_state import SitlState

ARRIVAL_RADIUS = 0.5  # m, counts as there


def _level_gap(state: SitlState, position: Vec3) -> float:
    gap = position - state.body.position
    return math.hypot(gap[0], gap[1])


def _return_height(state: SitlState, away: float) -> float:
    """Return the height (m) above home to return at, from `away` (m)."""
    value, height = state.parameters, float(state.home[2] - state.body.position[2])
    if state.dialect.name == "px4":
        cone = away / math.tan(math.radians(max(1.0, value["RTL_CONE_ANG"])))
        return max(height, min(value["RTL_RETURN_ALT"], cone))
    cone = max(2.0, away * value["RTL_CONE_SLOPE"]) if value["RTL_CONE_SLOPE"] else math.inf
    wanted = max(value["RTL_ALT"] / 100.0, height + value["RTL_CLIMB_MIN"] / 100.0)
    return max(height, min(wanted, cone))


def steer(state: SitlState) -> Command | None:
    """Climb, fly home, wait, land."""
    away = _level_gap(state, state.home)
    if state.phase == "":
        state.begin("climb")
        top = float(state.home[2]) - _return_height(state, away)
        here = state.body.position
        state.aim = towards(state.now, vec(here[0], here[1], top))
    aim = state.aim
    if aim is None:  # on the way down
        return act(state, Action.LAND, "land")
    if there(state, aim, ARRIVAL_RADIUS):
        _next_leg(state, aim)
    return None if state.aim is None else to(state, state.aim)


def _next_leg(state: SitlState, aim: SetpointTarget) -> None:
    height = aim.position[2] or 0.0
    if state.phase == "climb":
        state.begin("home")
        over_home = vec(state.home[0], state.home[1], height)
        state.aim = towards(state.now, over_home, speed=cruise(state))
    elif state.phase == "home":
        state.begin("wait")
        state.aim = aim
    elif state.now - state.phase_since >= _pause(state):
        state.begin("land")


def _pause(state: SitlState) -> float:
    return 0.0 if state.dialect.name == "px4" else state.parameters["RTL_LOIT_TIME"] / 1000.0
