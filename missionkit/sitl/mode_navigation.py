"""Setpoints of the inner autopilot in each mode.

https://docs.px4.io/main/en/flight_modes_mc/;
https://ardupilot.org/dev/docs/copter-commands-in-guided-mode.html.
"""

from __future__ import annotations

import math

from missionkit.geometry import wrap
from missionkit.messages import Action, Command
from missionkit.sitl import landing_target, mission_progress, return_home
from missionkit.sitl.flight_modes import FlightTask
from missionkit.sitl.flight_primitives import (
    act,
    cruise,
    there,
    to,
)
from missionkit.sitl.setpoint_tracking import SetpointTarget, turned
from missionkit.sitl.sitl_state import Orbit, SitlState


def steer(state: SitlState, dt: float) -> None:
    """Tell the vehicle what to do in the next `dt` (s)."""
    if not state.armed:
        return
    command = _command(state, dt)
    if command is not None:
        state.body.apply(command._replace(payload=state.payload))


def _command(state: SitlState, dt: float) -> Command | None:
    if state.mode.does is FlightTask.COMMANDED:
        return _commanded(state, dt)
    if state.mode.does is FlightTask.TAKE_OFF:
        return _take_off(state, land_in=FlightTask.HOLD)
    if state.mode.does is FlightTask.MISSION:
        return _mission(state)
    if state.mode.does is FlightTask.RETURN:
        return return_home.steer(state)
    if state.mode.does is FlightTask.LAND:
        return landing_target.steer(state)
    return _stay(state)


def _stay(state: SitlState) -> Command | None:
    """Hold, at the current or the commanded position."""
    if state.orbit is not None:
        return to(state, _round(state, state.orbit))
    return act(state, Action.HOLD, "hold") if state.aim is None else to(state, state.aim)


def _round(state: SitlState, orbit: Orbit) -> SetpointTarget:
    """Return the target on a circle, facing its centre."""
    out = state.body.position - orbit.centre
    angle = math.atan2(out[1], out[0])
    n, e, d = map(float, orbit.centre)
    on = (n + orbit.radius * math.cos(angle), e + orbit.radius * math.sin(angle), d)
    ahead = (-orbit.speed * math.sin(angle), orbit.speed * math.cos(angle), 0.0)
    return SetpointTarget(state.now, position=on, velocity=ahead, yaw=wrap(angle + math.pi))


def _commanded(state: SitlState, dt: float) -> Command | None:
    if state.phase in {"take_off", "climb"}:
        return _take_off(state, land_in=None)
    if state.target is None or _stays_down(state, state.target):
        return act(state, Action.HOLD, "hold")
    state.target = turned(state.target, dt)
    if state.target.leans:
        state.body.unwind()
    return to(state, state.target)


def _stays_down(state: SitlState, target: SetpointTarget) -> bool:
    """Say whether a target is not flown from the ground.

    ArduPilot takes off by command, or by an attitude with the thrust to climb
    (`ArduCopter/mode_guided.cpp`, angle_control_run).
    """
    climb = target.velocity[2]  # of the thrust, see `setpoint_messages`
    lifts = target.attitude is not None and climb is not None and climb < 0.0
    return state.dialect.name == "ardupilot" and not state.in_air and not lifts


def _take_off(state: SitlState, land_in: FlightTask | None) -> Command | None:
    """Climb; enter the mode that does `land_in` at the top."""
    if state.phase != "climb":
        state.begin("climb")
        return Command(action=Action.TAKE_OFF, height=state.height - float(state.home[2]))
    if state.body.truth.mode == "hold" and state.now - state.phase_since > 0.1:
        state.begin("")
        if land_in is not None:
            state.fly(land_in)
    return None


def _mission(state: SitlState) -> Command | None:
    """Fly the items one after the other."""
    leg = mission_progress.leg(state, cruise(state))
    if leg is None:
        return act(state, Action.HOLD, "hold")
    if leg.action is not None:
        return _mission_action(state, leg)
    state.aim = leg.aim
    if leg.aim is not None and there(state, leg.aim, leg.radius):
        mission_progress.arrived(state, leg)
    return None if leg.aim is None else to(state, leg.aim)


def _mission_action(state: SitlState, leg: mission_progress.MissionLeg) -> Command | None:
    if leg.action is FlightTask.TAKE_OFF:
        state.height = leg.height
        command = _take_off(state, land_in=None)
        if command is None and state.phase == "":
            mission_progress.arrived(state, leg)
        return command
    if leg.action is FlightTask.RETURN:
        return return_home.steer(state)
    return act(state, Action.LAND, "land")
