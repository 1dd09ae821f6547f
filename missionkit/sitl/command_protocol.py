"""COMMAND_LONG and COMMAND_INT: who does what, and what is acknowledged.

Results follow PX4 `src/modules/commander/Commander.cpp` (handle_command: a refusal is
TEMPORARILY_REJECTED) and ArduPilot `libraries/GCS_MAVLink/GCS_Common.cpp`,
`ArduCopter/GCS_Mavlink.cpp` (a refusal is FAILED).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from missionkit.geometry import norm
from missionkit.sim.fault_injection import Fault
from missionkit.sitl import arming_rules, gimbal_manager, mission_protocol, stream_scheduler
from missionkit.sitl.command_fields import CommandFields, order_of
from missionkit.sitl.flight_modes import FlightMode, FlightTask
from missionkit.sitl.peer_channel import Channel, Sender
from missionkit.sitl.pymavlink_dialect import Message, mavlink
from missionkit.sitl.setpoint_tracking import towards
from missionkit.sitl.sitl_state import Orbit, SitlState

RESULT_ACCEPTED = mavlink.MAV_RESULT_ACCEPTED
DENIED = mavlink.MAV_RESULT_DENIED
UNSUPPORTED = mavlink.MAV_RESULT_UNSUPPORTED
FAILED = mavlink.MAV_RESULT_FAILED
LONGEST_INTERVAL = 2**31 - 1  # µs
FARTHEST_HOME = 10_000.0  # m, from a new home
FORCE_MAGIC = 21196  # magic number of COMPONENT_ARM_DISARM
GNSS, BATTERY = mavlink.FAILURE_UNIT_SENSOR_GPS, mavlink.FAILURE_UNIT_SYSTEM_BATTERY
INJECTED = {GNSS: ("gnss_lost", None), BATTERY: ("battery_sag", 1.0)}
CHANGE_MODE = mavlink.MAV_DO_REPOSITION_FLAGS_CHANGE_MODE

Handler = Callable[[SitlState, CommandFields], int]


def refused(state: SitlState) -> int:
    """Return what this autopilot answers to what it could do, but not now."""
    px4 = state.dialect.name == "px4"
    return int(mavlink.MAV_RESULT_TEMPORARILY_REJECTED if px4 else FAILED)


def hear(state: SitlState, channel: Channel, message: Message) -> None:
    """Carry out a command and acknowledge it to who sent it.

    Args:
        state: of the autopilot, changed.
        channel: on which the command came, and on which it is acknowledged.
        message: COMMAND_LONG or COMMAND_INT.
    """
    order = order_of(message, channel)
    handler = HANDLERS.get(order.command)
    denied = state.troubles.active("command_denied", state.now)
    if denied is not None and denied[0] == order.command:
        result = refused(state)
    else:
        result = UNSUPPORTED if handler is None else handler(state, order)
    state.note("command", f"{order.command} {result} {order.number(1):g}")
    acknowledge(state, channel, order.who, order.command, result)


def acknowledge(state: SitlState, channel: Channel, who: Sender, command: int, result: int) -> None:
    """Send COMMAND_ACK, unless a fault keeps it.

    Args:
        state: with the faults that are active.
        channel: on which the command came.
        who: sent the command.
        command: MAV_CMD.
        result: MAV_RESULT.
    """
    ack = mavlink.MAVLink_command_ack_message(command, result, 0, 0, *who)
    if state.troubles.active("acks_lost", state.now):
        return
    late = state.troubles.active("acks_delayed", state.now)
    if late is None:
        channel.send(ack, state.now)
    else:
        state.late_acks.append((state.now + late[0], channel, ack))


def _done(state: SitlState, *, well: bool) -> int:
    return int(RESULT_ACCEPTED) if well else refused(state)


def _arm(state: SitlState, order: CommandFields) -> int:
    force = round(order.number(2)) == FORCE_MAGIC
    if order.number(1) == 1.0:
        return _done(state, well=arming_rules.arm(state))
    return _done(state, well=arming_rules.disarm(state, force=force))


def change_mode(state: SitlState, mode: FlightMode | None) -> int:
    """Enter a mode that a station requests."""
    if mode is None:
        return refused(state)
    return _done(state, well=arming_rules.change(state, mode))


def _set_mode(state: SitlState, order: CommandFields) -> int:
    main, sub = round(order.number(2)), round(order.number(3))
    number = sub << 24 | main << 16 if state.dialect.name == "px4" else main
    return change_mode(state, state.dialect.mode(number))


def _take_off(state: SitlState, order: CommandFields) -> int:
    """PX4: a mode, height above the sea. ArduPilot: in GUIDED and armed, height above home."""
    if state.dialect.name == "px4":
        state.height = state.parameters["MIS_TAKEOFF_ALT"]
        if order.height is not None:
            state.height = order.height - (state.earth.origin.height - float(state.home[2]))
        return change_mode(state, state.dialect.doing(FlightTask.TAKE_OFF))
    ready = state.mode.does is FlightTask.COMMANDED and state.armed and not state.in_air
    if not ready or order.height is None:
        return int(FAILED)
    state.height, state.target = order.height, None
    state.begin("take_off")
    return int(RESULT_ACCEPTED)


def _fly(flight: FlightTask) -> Handler:
    def handler(state: SitlState, _: CommandFields) -> int:
        return change_mode(state, state.dialect.doing(flight))

    return handler


def _reposition(state: SitlState, order: CommandFields) -> int:
    """Fly to a place: PX4 holds there, ArduPilot is guided there."""
    px4 = state.dialect.name == "px4"
    mode = state.dialect.doing(FlightTask.HOLD if px4 else FlightTask.COMMANDED)
    if state.mode is not mode and not round(order.number(2)) & CHANGE_MODE:
        return int(DENIED)
    if not state.in_air or not arming_rules.change(state, mode):
        return refused(state)
    yaw = order.params[3]
    aim = towards(state.now, order.place(state, state.body.position), yaw=yaw, speed=state.speed)
    if px4:
        state.aim = aim
    else:
        state.target = aim
    return int(RESULT_ACCEPTED)


def _orbit(state: SitlState, order: CommandFields) -> int:
    """Fly circles: PX4 only. The sign of the radius is the direction."""
    if state.dialect.name != "px4":
        return int(UNSUPPORTED)
    radius, speed = order.number(1), order.params[1] or state.parameters["MPC_XY_CRUISE"] / 2.0
    mode = state.dialect.named("ORBIT")
    if abs(radius) < 1.0 or not state.in_air or not arming_rules.change(state, mode):
        return refused(state)
    centre = order.place(state, state.body.position)
    state.orbit = Orbit(centre, abs(radius), math.copysign(speed, radius))
    return int(RESULT_ACCEPTED)


def _pause(state: SitlState, order: CommandFields) -> int:
    if order.number(1) == 1.0:
        return change_mode(state, state.dialect.doing(FlightTask.MISSION))
    return change_mode(state, state.dialect.doing(FlightTask.HOLD))


def _start_mission(state: SitlState, order: CommandFields) -> int:
    ready = bool(state.plans.mission) and (state.armed or state.dialect.name == "px4")
    if not ready or not mission_protocol.set_current(state, round(order.number(1))):
        return refused(state)
    return change_mode(state, state.dialect.doing(FlightTask.MISSION))


def _speed(state: SitlState, order: CommandFields) -> int:
    state.speed = order.number(2) if order.number(2) > 0.0 else None
    return int(RESULT_ACCEPTED)


def _set_home(state: SitlState, order: CommandFields) -> int:
    if order.number(1) == 1.0:
        state.home = state.body.position.copy()
        return int(RESULT_ACCEPTED)
    home = order.place(state, state.home)
    if norm(home - state.body.position) > FARTHEST_HOME:
        return refused(state)
    state.home = home
    return int(RESULT_ACCEPTED)


def _interval(state: SitlState, order: CommandFields) -> int:
    known = stream_scheduler.ask(
        state, order.channel, round(order.number(1)), order.number(2) / 1e6
    )
    return int(RESULT_ACCEPTED if known else FAILED if state.dialect.name == "px4" else DENIED)


def _tell_interval(state: SitlState, order: CommandFields) -> int:
    number = round(order.number(1))
    if not 0 <= number < 1 << 16:
        return int(DENIED)
    beat = order.channel.streams.get(number)
    interval = -1 if beat is None else min(LONGEST_INTERVAL, round(1e6 * beat.interval))
    known = stream_scheduler.known(state, number)
    answer = mavlink.MAVLink_message_interval_message(number, interval if known else 0)
    order.channel.send(answer, state.now)
    return int(RESULT_ACCEPTED)


def _tell(state: SitlState, number: int, order: CommandFields) -> int:
    if not stream_scheduler.known(state, number):
        return int(DENIED if state.dialect.name == "px4" else FAILED)
    message = stream_scheduler.MESSAGE_BUILDERS[number](state)
    if message is None:
        return refused(state)
    order.channel.send(message, state.now)
    return int(RESULT_ACCEPTED)


def _request(state: SitlState, order: CommandFields) -> int:
    return _tell(state, round(order.number(1)), order)


def _tells(number: int) -> Handler:
    def handler(state: SitlState, order: CommandFields) -> int:
        return _tell(state, number, order)

    return handler


def _reboot(state: SitlState, order: CommandFields) -> int:
    if order.number(1) not in {1.0, 3.0} or state.armed:
        return refused(state)
    state.troubles.add(Fault("reboot", 1.5, state.now + 0.1))
    return int(RESULT_ACCEPTED)


def _fail(state: SitlState, order: CommandFields) -> int:
    """Inject a failure of GNSS or battery; PX4 wants SYS_FAILURE_EN."""
    if state.dialect.name == "px4" and not state.parameters["SYS_FAILURE_EN"]:
        return int(DENIED)
    unit, kind = round(order.number(1)), round(order.number(2))
    if unit not in INJECTED or kind not in {0, 1}:
        return int(UNSUPPORTED)
    name, value = INJECTED[unit]
    if kind == mavlink.FAILURE_TYPE_OK:
        state.troubles.clear(name)
    else:
        state.troubles.add(Fault(name, value, state.now))
    return int(RESULT_ACCEPTED)


def _actuate(state: SitlState, order: CommandFields) -> int:
    """Switch an actuator on (above the middle) or off."""
    servo = order.command == mavlink.MAV_CMD_DO_SET_SERVO
    value = (order.number(2) - 1500.0) if servo else order.number(1)
    name = f"servo{round(order.number(1))}" if servo else "actuator"
    state.payload = name if value > 0.0 else None
    state.body.payload = state.payload
    if servo:
        state.devices[f"servo {round(order.number(1))}"] = order.number(2)
    return int(RESULT_ACCEPTED)


def _photo(state: SitlState, order: CommandFields) -> int:
    """Take a photo; PX4 leaves the camera protocol to a camera, ArduPilot speaks it."""
    protocol = order.command == mavlink.MAV_CMD_IMAGE_START_CAPTURE
    if protocol and state.dialect.name == "px4":
        return int(UNSUPPORTED)
    if not protocol and order.number(5) != 1.0:
        return int(DENIED)
    state.photos += 1
    return int(RESULT_ACCEPTED)


def _switch(state: SitlState, order: CommandFields) -> int:
    """Switch a relay, which is counted from 0, or move a gripper, counted from 1."""
    relay = order.command == mavlink.MAV_CMD_DO_SET_RELAY
    number = round(order.number(1)) + (1 if relay else 0)
    if number < 1 or order.number(2) not in {0.0, 1.0}:
        return int(DENIED)
    state.devices[f"{'relay' if relay else 'gripper'} {number}"] = order.number(2)
    return int(RESULT_ACCEPTED)


def _terminate(state: SitlState, order: CommandFields) -> int:
    if order.number(1) > 0.5:
        state.say("Flight termination", mavlink.MAV_SEVERITY_EMERGENCY)
        state.body.kill()
    return int(RESULT_ACCEPTED)


def _go_to_item(state: SitlState, order: CommandFields) -> int:
    return _done(state, well=mission_protocol.set_current(state, round(order.number(1))))


HANDLERS: Mapping[int, Handler] = {
    mavlink.MAV_CMD_COMPONENT_ARM_DISARM: _arm,
    mavlink.MAV_CMD_DO_SET_MODE: _set_mode,
    mavlink.MAV_CMD_NAV_TAKEOFF: _take_off,
    mavlink.MAV_CMD_NAV_LAND: _fly(FlightTask.LAND),
    mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH: _fly(FlightTask.RETURN),
    mavlink.MAV_CMD_DO_REPOSITION: _reposition,
    mavlink.MAV_CMD_DO_ORBIT: _orbit,
    mavlink.MAV_CMD_DO_PAUSE_CONTINUE: _pause,
    mavlink.MAV_CMD_MISSION_START: _start_mission,
    mavlink.MAV_CMD_DO_SET_MISSION_CURRENT: _go_to_item,
    mavlink.MAV_CMD_DO_CHANGE_SPEED: _speed,
    mavlink.MAV_CMD_DO_SET_HOME: _set_home,
    mavlink.MAV_CMD_SET_MESSAGE_INTERVAL: _interval,
    mavlink.MAV_CMD_GET_MESSAGE_INTERVAL: _tell_interval,
    mavlink.MAV_CMD_REQUEST_MESSAGE: _request,
    mavlink.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES: _tells(
        mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION
    ),
    mavlink.MAV_CMD_GET_HOME_POSITION: _tells(mavlink.MAVLINK_MSG_ID_HOME_POSITION),
    mavlink.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN: _reboot,
    mavlink.MAV_CMD_INJECT_FAILURE: _fail,
    mavlink.MAV_CMD_DO_SET_ACTUATOR: _actuate,
    mavlink.MAV_CMD_DO_SET_SERVO: _actuate,
    mavlink.MAV_CMD_IMAGE_START_CAPTURE: _photo,
    mavlink.MAV_CMD_DO_DIGICAM_CONTROL: _photo,
    mavlink.MAV_CMD_DO_SET_RELAY: _switch,
    mavlink.MAV_CMD_DO_GRIPPER: _switch,
    mavlink.MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE: gimbal_manager.configure,
    mavlink.MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW: gimbal_manager.turn,
    mavlink.MAV_CMD_DO_MOUNT_CONTROL: gimbal_manager.mount_control,
    mavlink.MAV_CMD_DO_FLIGHTTERMINATION: _terminate,
}
