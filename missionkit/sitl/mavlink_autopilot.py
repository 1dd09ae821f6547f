"""The simulated autopilot without its sockets: messages in, messages out, time in slices."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

from missionkit.geometry import vec
from missionkit.sim.fault_injection import Fault
from missionkit.sim.random_blocks import streams as random_streams
from missionkit.sim.world import World
from missionkit.sitl import (
    autopilot_failsafes,
    command_protocol,
    gimbal_manager,
    landing_target,
    setpoint_messages,
    status_messages,
    stream_scheduler,
)
from missionkit.sitl.flight_modes import FlightTask, ModeTable
from missionkit.sitl.geodetic import (
    ARDUPILOT_RADIUS,
    PX4_RADIUS,
    Earth,
    GeographicPoint,
)
from missionkit.sitl.mission_protocol import MissionProtocol
from missionkit.sitl.mode_navigation import steer
from missionkit.sitl.parameter_protocol import Parameters
from missionkit.sitl.peer_channel import Channel, sender
from missionkit.sitl.pymavlink_dialect import Message, mavlink
from missionkit.sitl.simulated_body import SimulatedBody
from missionkit.sitl.sitl_state import SitlState
from missionkit.sitl.wire_faults import BODY_FAULTS, WireFaults

SLICE = 0.01  # s, between two looks at the links
BURST = 10  # PARAM_VALUEs in one slice


class MavlinkAutopilot:
    """A vehicle behind MAVLink.

    Args:
        world: what it flies in.
        dialect: whose manners it has.
        seed: of everything random.
        faults: what goes wrong, and when.
        origin: where the world's origin is on the Earth.
        wall: tells the time (s) that the journal shows beside the simulated one.
        system: its MAVLink system id.
    """

    def __init__(
        self,
        world: World,
        dialect: ModeTable,
        seed: int,
        faults: Sequence[Fault],
        origin: GeographicPoint,
        wall: Callable[[], float],
        system: int = 1,
    ) -> None:
        px4 = dialect.name == "px4"
        body = SimulatedBody(world, seed, [fault for fault in faults if fault.name in BODY_FAULTS])
        self.state = SitlState(
            dialect=dialect,
            body=body,
            earth=Earth(origin, PX4_RADIUS if px4 else ARDUPILOT_RADIUS),
            parameters=Parameters(dialect.name, bytewise=dialect.bytewise),
            troubles=WireFaults(faults, random_streams(seed)["link"].spawn(1)[0]),
            mode=dialect.initial,
            home=vec(*world.start, 0.0),
            wall=wall,
            gimbal=gimbal_manager.at_rest(),
            system=system,
        )
        self._messages = stream_scheduler.Messages()
        self._missions = MissionProtocol()

    def connect(self, write: Callable[[bytes], None]) -> Channel:
        """Return a conversation with a new peer, who is written to by `write`."""
        channel = Channel(write, self.state.system, self.state.troubles)
        stream_scheduler.begin(self.state, channel)
        self.state.channels.append(channel)
        return channel

    def disconnect(self, channel: Channel) -> None:
        """End a conversation."""
        if channel in self.state.channels:
            self.state.channels.remove(channel)

    def listen(self) -> None:
        """Answer what has arrived."""
        state = self.state
        for channel in tuple(state.channels):
            for message in channel.messages(state.now):
                if state.now >= state.silent_until and self._is_for_us(message):
                    self._hear(channel, message)
            channel.flush(state.now)

    def step(self) -> None:
        """Let one slice of time pass."""
        state = self.state
        self.listen()
        _strike(state)
        autopilot_failsafes.watch(state)
        steer(state, SLICE)
        if not state.in_air:
            state.sensed.flow_held_at = state.now
        state.body.by_flow = state.by_flow
        state.body.faulty([fault for fault in state.troubles.faults if fault.name in BODY_FAULTS])
        state.sensed.update(state.body.advance(round(state.now / SLICE + 1.0) * SLICE))
        lost = state.troubles.without_fixes(state.now)
        state.lost_gnss_at = math.inf if lost is None else state.now - lost
        if state.now >= state.silent_until:
            self._talk()
        for channel in state.channels:
            channel.flush(state.now)

    def _talk(self) -> None:
        state = self.state
        stream_scheduler.send_due(state, self._messages)
        self._missions.step(state)
        for channel in state.channels:
            for message in channel.pending[:BURST]:
                channel.send(message, state.now)
            del channel.pending[:BURST]
        for due, channel, ack in tuple(state.late_acks):
            if state.now >= due:
                channel.send(ack, state.now)
                state.late_acks.remove((due, channel, ack))

    def _is_for_us(self, message: Message) -> bool:
        system = getattr(message, "target_system", 0)
        component = getattr(message, "target_component", 0)
        return system in {0, self.state.system} and component in {0, 1}

    def _hear(self, channel: Channel, message: Message) -> None:
        kind = message.get_type()
        if kind in {"COMMAND_LONG", "COMMAND_INT"}:
            command_protocol.hear(self.state, channel, message)
        elif kind.startswith("MISSION_"):
            self._missions.hear(self.state, channel, message)
        elif kind in SERVICES:
            SERVICES[kind](self.state, channel, message)


def _strike(state: SitlState) -> None:
    """Let faults that happen once happen."""
    number = state.troubles.strikes("pilot_mode", state.now)
    mode = None if number is None else state.dialect.mode(int(number))
    if mode is not None:
        state.say(f"Pilot took over: {mode.name}")
        state.enter(mode)
    silent = state.troubles.strikes("reboot", state.now)
    if silent is not None:
        restart(state, silent)


def restart(state: SitlState, silent: float) -> None:
    """Restart after `silent` s; in flight it holds, as after ArduPilot's watchdog.

    https://ardupilot.org/copter/docs/common-watchdog.html
    """
    state.silent_until = state.booted = state.now + silent
    state.peers.clear()
    state.warned.clear()
    state.late_acks.clear()
    state.target = state.speed = None
    state.enter(state.dialect.doing(FlightTask.HOLD) if state.in_air else state.dialect.initial)
    for channel in state.channels:
        channel.pending.clear()
        stream_scheduler.begin(state, channel)


def _heartbeat(state: SitlState, _: Channel, message: Message) -> None:
    state.peers[sender(message)] = (state.now, message.type)
    state.warned.discard("GCS connection lost")
    state.warned.discard("GCS")


def _set_mode(state: SitlState, _: Channel, message: Message) -> None:
    command_protocol.change_mode(state, state.dialect.mode(message.custom_mode))


def _setpoint(state: SitlState, _: Channel, message: Message) -> None:
    target = setpoint_messages.read(state, message)
    guided = state.mode.does is FlightTask.COMMANDED
    state.note("setpoint", message.get_type())
    if target is None or (state.dialect.name == "ardupilot" and not guided):
        return
    state.target = target
    if state.dialect.name == "ardupilot" and state.in_air:
        state.phase = ""  # a setpoint ends a take-off


def _list_parameters(state: SitlState, channel: Channel, _: Message) -> None:
    channel.pending = [
        state.parameters.param_value_message(name) for name in state.parameters.names
    ]


def _read_parameter(state: SitlState, channel: Channel, message: Message) -> None:
    name = state.parameters.find(message.param_id, message.param_index)
    if name is not None:
        channel.send(state.parameters.param_value_message(name), state.now)


def _set_parameter(state: SitlState, channel: Channel, message: Message) -> None:
    if state.parameters.accept(message.param_id, message.param_value):
        channel.send(state.parameters.param_value_message(message.param_id), state.now)


def _group(state: SitlState, channel: Channel, message: Message) -> None:
    if state.dialect.name == "px4":
        return  # it knows SET_MESSAGE_INTERVAL only
    rate = message.req_message_rate if message.start_stop else 0
    stream_scheduler.ask_group(state, channel, message.req_stream_id, rate)


def _ping(state: SitlState, channel: Channel, message: Message) -> None:
    if message.target_system == 0:
        answer = mavlink.MAVLink_ping_message(message.time_usec, message.seq, *sender(message))
        channel.send(answer, state.now)


def _timesync(state: SitlState, channel: Channel, message: Message) -> None:
    if message.tc1 == 0:
        nanos = 1000 * state.micros
        channel.send(mavlink.MAVLink_timesync_message(nanos, message.ts1), state.now)


def _no_logs(state: SitlState, channel: Channel, _: Message) -> None:
    channel.send(mavlink.MAVLink_log_entry_message(0, 0, 0, 0, 0), state.now)


def _version(state: SitlState, channel: Channel, _: Message) -> None:
    channel.send(status_messages.autopilot_version(state), state.now)


def _origin(state: SitlState, channel: Channel, _: Message) -> None:
    """Say where the origin is: it is set by the first fix and stays there."""
    if state.sensed.gnss is not None:
        channel.send(status_messages.gps_global_origin(state), state.now)


Service = Callable[[SitlState, Channel, Message], None]
SERVICES: dict[str, Service] = {
    "HEARTBEAT": _heartbeat,
    "SET_MODE": _set_mode,
    "SET_POSITION_TARGET_LOCAL_NED": _setpoint,
    "SET_POSITION_TARGET_GLOBAL_INT": _setpoint,
    "SET_ATTITUDE_TARGET": _setpoint,
    "PARAM_REQUEST_LIST": _list_parameters,
    "PARAM_REQUEST_READ": _read_parameter,
    "PARAM_SET": _set_parameter,
    "REQUEST_DATA_STREAM": _group,
    "PING": _ping,
    "TIMESYNC": _timesync,
    "LOG_REQUEST_LIST": _no_logs,
    "SET_GPS_GLOBAL_ORIGIN": _origin,
    "AUTOPILOT_VERSION_REQUEST": _version,
    "LANDING_TARGET": landing_target.hear,
}
