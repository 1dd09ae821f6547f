"""Failsafes of the autopilot.

PX4: https://docs.px4.io/main/en/config/safety.html; `src/modules/commander/failsafe/failsafe.cpp`
(fromOffboardLossActParam, fromNavDllOrRclActParam, fromBatteryWarningActParam) and
`framework.cpp` (hold for COM_FAIL_ACT_T before the action, except after an offboard loss).
ArduPilot: https://ardupilot.org/copter/docs/radio-failsafe.html, /gcs-failsafe.html,
/failsafe-battery.html, /ekf-inav-failsafe.html, /ac2_guidedmode.html (GUID_TIMEOUT),
`ArduCopter/crash_check.cpp`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from missionkit.sitl import fence_breach
from missionkit.sitl.flight_modes import FlightTask
from missionkit.sitl.setpoint_tracking import SetpointTarget
from missionkit.sitl.sitl_state import ALERT, GCS, SitlState, take_over

OFFBOARD_LOSS = {3: FlightTask.RETURN, 4: FlightTask.LAND, 5: FlightTask.HOLD}  # COM_OBL_RC_ACT
OFFBOARD_PILOT = {0: "POSCTL", 1: "ALTCTL", 2: "STABILIZED"}
LINK_LOSS = {1: FlightTask.HOLD, 2: FlightTask.RETURN, 3: FlightTask.LAND}  # NAV_DLL_ACT
GCS_LOSS = {  # FS_GCS_ENABLE
    1: FlightTask.RETURN,
    2: FlightTask.RETURN,
    3: FlightTask.RETURN,
    4: FlightTask.RETURN,
    5: FlightTask.LAND,
    7: FlightTask.HOLD,
}
UNMONITORED, VOLTAGE_ONLY = 0, 3  # BATT_MONITOR
BATTERY_LOW = {1: FlightTask.LAND, 2: FlightTask.RETURN, 3: FlightTask.RETURN, 4: FlightTask.RETURN}
RC_LOSS = {1: FlightTask.HOLD, 2: FlightTask.RETURN, 3: FlightTask.LAND}  # NAV_RCL_ACT
RC_EXCEPT = {
    FlightTask.MISSION: 1,
    FlightTask.HOLD: 2,
    FlightTask.COMMANDED: 4,
}  # bits of COM_RCL_EXCEPT
RADIO_LOSS = {
    1: FlightTask.RETURN,
    3: FlightTask.LAND,
    4: FlightTask.RETURN,
    5: FlightTask.RETURN,
}  # FS_THR_ENABLE
RADIO_GOES_ON = {FlightTask.MISSION: 1, FlightTask.COMMANDED: 4}  # bits of FS_OPTIONS
PILOT_GOES_ON = 16  # bit of FS_OPTIONS
CRASHED_FOR = 2.0  # s until a crashed vehicle disarms
Watch = Callable[[SitlState], None]


def watch(state: SitlState) -> None:
    """Do what is due now."""
    _pending(state)
    _follow_ground(state)
    if state.armed:
        for look in WATCHES[state.dialect.name]:
            look(state)


def _pending(state: SitlState) -> None:
    if state.pending is not None and state.now >= state.pending[0]:
        name, flight = state.failsafe, state.pending[1]
        state.fly(flight)
        state.failsafe = name


def _follow_ground(state: SitlState) -> None:
    """Notice take-off and landing, and disarm after some time on the ground."""
    if not state.armed:
        if state.armed_at < math.inf and state.now > state.armed_at + 0.1:
            state.armed_at, state.failsafe, state.pending = math.inf, "", None
        state.grounded_at = state.now
        return
    if state.in_air:
        state.flown, state.grounded_at = True, state.now
        return
    waited = state.now - max(state.grounded_at, min(state.armed_at, state.now))
    crashed = state.body.truth.crashed
    if waited > (CRASHED_FOR if crashed else _patience(state)):
        state.say("Crash: disarmed" if crashed else "Disarmed by auto disarm")
        state.body.kill()


def _patience(state: SitlState) -> float:
    """Return how long (s) it stays armed on the ground."""
    if state.dialect.name == "ardupilot":
        return state.parameters["DISARM_DELAY"] or math.inf
    name = "COM_DISARM_LAND" if state.flown else "COM_DISARM_PRFLT"
    wait = state.parameters[name]
    return wait if wait > 0.0 else math.inf


def _offboard_lost(state: SitlState) -> None:
    if state.mode.does is not FlightTask.COMMANDED or state.target is None:
        return
    if state.now - state.target.at <= state.parameters["COM_OF_LOSS_T"]:
        return
    action = int(state.parameters["COM_OBL_RC_ACT"])
    state.say("Failsafe activated: offboard signal lost", ALERT)
    if action in OFFBOARD_LOSS:
        state.fly(OFFBOARD_LOSS[action])
    elif action in {6, 7}:
        state.body.kill()
    elif not _has_rc(state):  # without a remote control a manual mode cannot be flown
        state.fly(FlightTask.RETURN)
    else:
        state.enter(state.dialect.named(OFFBOARD_PILOT.get(action, "POSCTL")))
    state.failsafe = "offboard signal lost"


def _guided_lost(state: SitlState) -> None:
    target = state.target
    if state.mode.does is not FlightTask.COMMANDED or target is None or not target.moves:
        return
    if state.now - target.at > state.parameters["GUID_TIMEOUT"]:
        state.target = SetpointTarget(math.inf, velocity=(0.0, 0.0, 0.0))


def _link_lost(state: SitlState) -> None:
    action = LINK_LOSS.get(int(state.parameters["NAV_DLL_ACT"]))
    if state.mode.does is FlightTask.LAND:
        return
    if action and state.in_air and state.silence(kind=GCS) > state.parameters["COM_DL_LOSS_T"]:
        take_over(state, "GCS connection lost", action, wait=state.parameters["COM_FAIL_ACT_T"])


def _gcs_lost(state: SitlState) -> None:
    action = GCS_LOSS.get(int(state.parameters["FS_GCS_ENABLE"]))
    if state.mode.does is FlightTask.PILOT and int(state.parameters["FS_OPTIONS"]) & PILOT_GOES_ON:
        return
    gone = state.silence(system=int(state.parameters["SYSID_MYGCS"]))
    if action and state.in_air and state.parameters["FS_GCS_TIMEOUT"] < gone < math.inf:
        take_over(state, "GCS", action)


def _rc_silence(state: SitlState) -> float:
    """Return for how long (s) nothing has come from the remote control."""
    lost = state.troubles.active("rc_lost", state.now)
    return 0.0 if lost is None else lost[1]


def _has_rc(state: SitlState) -> bool:
    """Return whether PX4 may leave the vehicle to a pilot; COM_RC_IN_MODE 4: never."""
    value = state.parameters
    return value["COM_RC_IN_MODE"] != 4 and _rc_silence(state) <= value["COM_RC_LOSS_T"]


def _rc_lost(state: SitlState) -> None:
    """Source: PX4 `failsafe.cpp` (checkStateAndMode, manual control loss)."""
    value, does = state.parameters, state.mode.does
    if _rc_silence(state) <= value["COM_RC_LOSS_T"]:
        state.warned.discard("RC lost")
        return
    action = RC_LOSS.get(int(value["NAV_RCL_ACT"]))
    excepted = int(value["COM_RCL_EXCEPT"]) & RC_EXCEPT.get(does, 0)
    if action and state.in_air and does is not FlightTask.LAND and not excepted:
        take_over(state, "RC lost", action, wait=value["COM_FAIL_ACT_T"])


def _radio_lost(state: SitlState) -> None:
    """Source: ArduCopter `events.cpp` (failsafe_radio_on_event)."""
    value, does = state.parameters, state.mode.does
    if _rc_silence(state) <= value["RC_FS_TIMEOUT"]:
        state.warned.discard("radio")
        return
    action = RADIO_LOSS.get(int(value["FS_THR_ENABLE"]))
    goes_on = int(value["FS_OPTIONS"]) & RADIO_GOES_ON.get(does, 0)
    if action and state.in_air and does is not FlightTask.LAND and not goes_on:
        take_over(state, "radio", action)


def _battery_low(state: SitlState) -> None:
    value, charge = state.parameters, state.body.charge
    action = int(value["COM_LOW_BAT_ACT"])
    if charge < value["BAT_EMERGEN_THR"] and action:
        take_over(state, "battery emergency", FlightTask.LAND)
    elif charge < value["BAT_CRIT_THR"] and action:
        flight = FlightTask.LAND if action == 2 else FlightTask.RETURN
        take_over(state, "battery critical", flight, wait=value["COM_FAIL_ACT_T"])
    elif charge < value["BAT_LOW_THR"]:
        state.warn_once("battery", "Low battery level! Return advised")


def _volts_low(state: SitlState) -> None:
    value, reading = state.parameters, state.sensed.battery
    monitor = int(value["BATT_MONITOR"])
    if reading is None or monitor == UNMONITORED:
        return
    left = math.inf if monitor == VOLTAGE_ONLY else reading.charge * value["BATT_CAPACITY"]
    for level, name in (("LOW", "battery low"), ("CRT", "battery critical")):
        action = BATTERY_LOW.get(int(value[f"BATT_FS_{level}_ACT"]))
        low = left < value[f"BATT_{level}_MAH"] or reading.voltage < value[f"BATT_{level}_VOLT"]
        if low and action:
            take_over(state, name, action)


def _position_lost(state: SitlState) -> None:
    if state.blind:
        _blind(state, "position lost")


def _ekf_lost(state: SitlState) -> None:
    if state.parameters["FS_EKF_ACTION"] and state.blind:
        _blind(state, "EKF variance")


def _blind(state: SitlState, name: str) -> None:
    if state.mode.needs_position and state.in_air:
        state.warned.discard(name)
        take_over(state, name, FlightTask.LAND)


WATCHES: Mapping[str, tuple[Watch, ...]] = {
    "px4": (_offboard_lost, _rc_lost, _link_lost, _battery_low, _position_lost, fence_breach.watch),
    "ardupilot": (_guided_lost, _radio_lost, _gcs_lost, _volts_low, _ekf_lost, fence_breach.watch),
}
