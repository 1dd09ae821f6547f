"""Parts that exist only while connected, and how they carry out a tick's command."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress

from missionkit.errors import VehicleError
from missionkit.geometry import Vec3, vec
from missionkit.messages import Action, AutopilotSetpoint, Command, PositionSetpoint, Wrench
from missionkit.vehicle.autopilot_dialect import GIMBAL_INTERVALS, OPTIONAL, Dialect
from missionkit.vehicle.command.autopilot_commands import OFFBOARD_MODE, Commander
from missionkit.vehicle.command.control_authority import ControlAuthority
from missionkit.vehicle.command.device_orders import DeviceQueue
from missionkit.vehicle.command.gimbal_orders import GimbalOrders
from missionkit.vehicle.command.payload import Payload
from missionkit.vehicle.command.setpoint_encoding import leashed, message
from missionkit.vehicle.command.setpoint_stream import STALE, ZERO_VELOCITY, Streamer
from missionkit.vehicle.link.clocks import MissionClock, wall
from missionkit.vehicle.link.connection import Link
from missionkit.vehicle.link.link_lifecycle import LinkLifecycle
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.link.message_check import MessageCheck
from missionkit.vehicle.link.message_rates import HEARTBEAT, Streams
from missionkit.vehicle.link.time_sync import TimeSync
from missionkit.vehicle.telemetry.autopilot_state import AutopilotState
from missionkit.vehicle.telemetry.flight_phase import FlightPhase
from missionkit.vehicle.telemetry.message_readings import triple
from missionkit.vehicle.telemetry.mission_origin import MissionOrigin
from missionkit.vehicle.telemetry.observer import Observer

CATCH_UP_TIME = 0.3  # s, wall, until what had queued up during a standstill is worked off
PLACED = 0.5  # s, wall, for which a reported position counts
NO_OFFSET = vec(0.0, 0.0, 0.0)
HEARTBEAT_GAP = 2.0  # s between two heartbeats: the link was gone


class ConnectedVehicle:
    """Everything that shares one link.

    Args:
        link: to the autopilot.
        lifecycle: of the link.
        dialect: of the autopilot.
        cache: where its messages are.
        clock: mission time.
        tell: takes an event for the mission.
        note: takes a sentence for the record.
        check: decides which messages are trusted.
        pace: seconds of the vehicle in one of the wall.
        idle: called when setpoints stop on purpose.
        wanted: the mission's origin, if it has one.
        gimbal: whether the camera is on a gimbal.
    """

    def __init__(
        self,
        link: Link,
        lifecycle: LinkLifecycle,
        dialect: Dialect,
        cache: Cache,
        clock: MissionClock,
        tell: Callable[[str], None],
        note: Callable[[str], None],
        check: MessageCheck,
        pace: float,
        idle: Callable[[], None] = lambda: None,
        wanted: MissionOrigin | None = None,
        *,
        gimbal: bool = False,
    ) -> None:
        self.link = link
        self.dialect = dialect
        self.state = AutopilotState(cache, dialect)
        self.phase = FlightPhase(cache, dialect)
        self.time_sync = TimeSync(link, wall, pace, note)
        self.observer = Observer(cache, self.phase, clock, self.time_sync.take, wanted)
        self.authority = ControlAuthority(
            dialect, self._let_go, tell, self._unheard, self.state.whereabouts, note
        )
        self._idle = idle
        self.streamer = Streamer(self._emit, self._listens, wall, pace, paused=self._pauses)
        self.commander = Commander(link, cache, dialect, self.state, self.authority.order, pace)
        intervals = dialect.intervals if not gimbal else {**dialect.intervals, **GIMBAL_INTERVALS}
        self.streams = Streams(link, cache, intervals, OPTIONAL, pace)
        self.payload = Payload(link, cache, pace)
        self.devices = DeviceQueue(link, cache, note, tell, pace)
        self.gimbal = GimbalOrders(link, cache, note, tell, pace)
        self._lifecycle = lifecycle
        self._check = check
        self._cache = cache
        self._pace = pace

    def start(self) -> None:
        """Begin."""
        self._lifecycle.identified(self.streams.forgotten)
        self._cache.listen(self.streams.hear)
        self._cache.listen(self.time_sync.hear)
        beat = self._cache.latest("HEARTBEAT")
        if beat is not None:
            self.authority.hear(beat)
        self._check.report_to(
            self.authority, self._rebooted, lambda: self.streams.request(HEARTBEAT)
        )
        self.streams.maintain()
        self.streamer.start()
        self.commander.start()

    def leave(self) -> None:
        """Stop commanding. Blocks the calling thread for at most a few seconds."""
        self.streamer.stop()
        self.commander.stop()
        self.payload.release()
        if not self.authority.ours or not self.state.in_air:
            self._idle()
        elif self.state.mode == self.dialect.offboard_word:
            with suppress(RuntimeError):  # no link, no hold: its failsafe will
                self._emit(ZERO_VELOCITY)
                self.commander.carry_out((Action.HOLD, None))
        elif self.authority.aim == self.state.mode:
            self._idle()

    def obey(self, command: Command, at: float) -> None:
        """Carry out what the tick due at wall time `at` (s) wants, if it is ours to command."""
        self.payload.want(command.payload if self.authority.ours else None)
        if not self.authority.ours:
            self.devices.drop()
            self.gimbal.drop()
            return
        self.devices.want(command.orders)
        self.gimbal.want(command.gimbal)
        if command.action is not None:
            self._act(command.action, command.height, at)
        elif isinstance(command.setpoint, Wrench):
            raise VehicleError("an autopilot takes no wrench: free flyers are simulated only")
        elif command.setpoint is not None:
            self._steer(command.setpoint, at)
        else:
            self._rest(at)

    def _act(self, action: Action, height: float | None, at: float) -> None:
        self.streamer.tell(ZERO_VELOCITY, at)
        if action is Action.TAKE_OFF:
            self.phase.take_off(height)
        elif action is not Action.ARM:
            self.phase.end()
        if not self._shows(action):
            self.commander.want((action, height if action is Action.TAKE_OFF else None))

    def _steer(self, setpoint: AutopilotSetpoint, at: float) -> None:
        state, dialect = self.state, self.dialect
        self.phase.steer()
        self.streamer.tell(setpoint, at)
        if not state.armed or not state.in_air or state.mode == dialect.offboard_word:
            return
        if self.streamer.streaming(wall()) * self._pace >= dialect.warm:
            self.commander.want((OFFBOARD_MODE, None))

    def _rest(self, at: float) -> None:
        self.streamer.tell(ZERO_VELOCITY, at)
        if self.state.mode == "offboard":
            self.commander.want((Action.HOLD, None))
        self.phase.rest()

    def _shows(self, action: Action) -> bool:
        """Say whether telemetry shows already what an action would bring about."""
        mode, armed = self.state.mode, self.state.armed
        return {
            Action.ARM: armed is True,
            Action.TAKE_OFF: mode == "take_off",
            Action.HOLD: mode == self.dialect.hold_word,
            Action.LAND: mode == "land",
            Action.PRECISION_LAND: mode == self.dialect.precise_word,
            Action.RETURN: mode == "return",
            Action.DISARM: armed is False,
        }[action]

    def _let_go(self) -> None:
        self.streamer.quiet()
        self.commander.drop()
        self._idle()

    def _rebooted(self) -> None:
        self.streams.forgotten()
        self.authority.rebooted(flying=bool(self.state.armed))
        self.observer.forget()

    def _unheard(self) -> bool:
        """Whether setpoints had stopped, or the link was gone, before the present heartbeat."""
        silent = (wall() - self.streamer.last) * self._pace > STALE
        steering = self.authority.aim == "offboard"
        return (silent and steering) or self._lifecycle.gap > HEARTBEAT_GAP

    def _listens(self) -> bool:
        """Whether a setpoint may be sent: in control, heard from recently, in a suitable mode."""
        state, dialect = self.state, self.dialect
        if not self.authority.ours or not state.armed:
            return False
        if self._lifecycle.at(wall()) != "live":
            return False
        if state.heard < self.streamer.woken + CATCH_UP_TIME:
            return False  # received messages may have waited while the process was stopped
        if dialect.early:
            # ignored outside offboard, and needed to enter it
            return state.mode not in {"land", "precision_land"}
        return state.mode == dialect.offboard_word and not self.phase.climbing

    def _pauses(self) -> bool:
        """Tell the guardian if setpoints stop on purpose; waking up does not count as one."""
        if self.state.heard < self.streamer.woken + CATCH_UP_TIME:
            return False
        self._idle()
        return True

    def _emit(self, setpoint: AutopilotSetpoint) -> None:
        start = self.observer.start
        if isinstance(setpoint, PositionSetpoint):
            setpoint = self._reachable(setpoint, start)
        name, fields = message(setpoint, wall(), NO_OFFSET if start is None else start)
        self.link.send(name, **fields)

    def _reachable(self, setpoint: PositionSetpoint, start: Vec3 | None) -> AutopilotSetpoint:
        """Return what to send for a position; `ZERO_VELOCITY` while its place is not known."""
        placed = self._cache.latest("LOCAL_POSITION_NED", PLACED)
        here = None if placed is None else triple(placed.fields, "x", "y", "z")
        if start is None or here is None:
            return ZERO_VELOCITY
        return leashed(setpoint, here - start, self.dialect.leash)
