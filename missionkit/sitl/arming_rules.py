"""When the autopilot may be armed, and which modes it may enter.

PX4: `src/modules/commander/Commander.cpp` (handle_command, arm, disarm), `UserModeIntention.cpp`
(a mode that cannot run may be chosen while disarmed, not while armed), `ModeUtil/
mode_requirements.cpp`; https://docs.px4.io/main/en/flying/pre_flight_checks.html.
ArduPilot: `ArduCopter/AP_Arming_Copter.cpp`, `ArduCopter/mode.cpp` (Copter::set_mode);
https://ardupilot.org/copter/docs/common-prearm-safety-checks.html.
"""

from __future__ import annotations

from missionkit.sitl.flight_modes import FlightMode, FlightTask
from missionkit.sitl.sitl_state import GCS, SEVERITY_WARNING, SitlState

WARMING_UP = 1.0  # s after boot


def is_warming_up(state: SitlState) -> bool:
    """Say whether it was started a moment ago."""
    return state.now - state.booted < WARMING_UP


def problems(state: SitlState) -> list[str]:
    """Return why it cannot be armed in any mode, empty if it can."""
    truth = state.body.truth
    least = max(state.body.world.autopilot.arming_charge, _asked_charge(state))
    reasons = {
        "sensors are warming up": is_warming_up(state),
        "no position estimate": not state.positioned,
        "low battery": state.body.charge < least,
        "crashed": truth.crashed,
        "no connection to the ground control station": _needs_station(state),
        "a fault": state.troubles.active("arming_denied", state.now) is not None,
    }
    return [reason for reason, holds in reasons.items() if holds]


def _needs_station(state: SitlState) -> bool:
    """Return whether PX4 requires a ground station (NAV_DLL_ACT) and has none."""
    if state.dialect.name != "px4" or not state.parameters["NAV_DLL_ACT"]:
        return False
    return state.silence(kind=GCS) > state.parameters["COM_DL_LOSS_T"]


def _asked_charge(state: SitlState) -> float:
    return state.parameters["COM_ARM_BAT_MIN"] if state.dialect.name == "px4" else 0.0


def arm(state: SitlState) -> bool:
    """Arm if the checks pass; say why not otherwise."""
    if state.armed:
        return True
    found = problems(state)
    if not state.mode.arming or (refusal := cannot_run(state, state.mode)):
        found.append(f"mode {state.mode.name}" if not state.mode.arming else refusal)
    if found:
        word = "Arming denied" if state.dialect.name == "px4" else "Arm"
        state.say(f"{word}: {found[0]}", SEVERITY_WARNING)
        return False
    state.body.arm()
    state.armed_at, state.flown = state.now, False
    state.warned.clear()
    state.begin("")
    return True


def disarm(state: SitlState, *, force: bool) -> bool:
    """Stop the rotors if it is on the ground or forced."""
    if state.in_air and not force:
        state.say("Disarming denied: not landed", SEVERITY_WARNING)
        return False
    state.body.kill()
    return True


def cannot_run(state: SitlState, mode: FlightMode) -> str:
    """Return why a mode cannot be flown now, empty if it can."""
    if mode.needs_position and state.blind:
        return "no position"
    if mode.does is FlightTask.MISSION and not state.plans.mission:
        return "no mission"
    if mode.name == "OFFBOARD" and not streaming(state):
        return "no offboard signal"
    return ""


def streaming(state: SitlState) -> bool:
    """Return whether setpoints have arrived recently."""
    target = state.target
    return target is not None and state.now - target.at <= state.parameters["COM_OF_LOSS_T"]


def change(state: SitlState, mode: FlightMode) -> bool:
    """Enter a mode if it can be flown; say why not otherwise."""
    if refusal := cannot_run(state, mode):
        lenient = state.dialect.name == "px4" and not state.armed
        if not lenient or mode.does is FlightTask.MISSION:
            state.say(f"Mode {mode.name} refused: {refusal}", SEVERITY_WARNING)
            return False
    state.enter(mode)
    return True
