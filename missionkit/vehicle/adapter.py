"""The port `Vehicle` over MAVLink.

    telemetry -> cache -> observation -> [tick] -> command -> setpoints, or one action at a time

Four threads share it: the event loop (ticks), MAVSDK's (brings messages, notices the pilot), the
streamer's and the commander's. None of the last three waits for the first.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any, TypeVar

from missionkit.errors import VehicleError
from missionkit.messages import CONTROL_RESUMED, Command, Observation, Record, Setpoint
from missionkit.vehicle.autopilot_dialect import Dialect, dialect_of
from missionkit.vehicle.camera.frame_source import FrameSource, NoCamera
from missionkit.vehicle.command import velocity_correction
from missionkit.vehicle.command.autopilot_commands import CommandReport
from missionkit.vehicle.command.command_transaction import CommandOutcome
from missionkit.vehicle.command.estimate_sharing import SHARE_NOTHING, Share, Sharing
from missionkit.vehicle.command.setpoint_stream import Streamer
from missionkit.vehicle.command.velocity_correction import Correction
from missionkit.vehicle.connected_vehicle import ConnectedVehicle
from missionkit.vehicle.event_notes import EventNotes
from missionkit.vehicle.guardian.policy import USUAL, Patience
from missionkit.vehicle.identification import identified
from missionkit.vehicle.link.clocks import MissionClock, wall
from missionkit.vehicle.link.connection import Link
from missionkit.vehicle.link.guardian_client import Guardian
from missionkit.vehicle.link.link_address import Address
from missionkit.vehicle.link.link_lifecycle import REACHED, LinkLifecycle
from missionkit.vehicle.link.link_lock import LinkLock
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.link.message_check import MessageCheck
from missionkit.vehicle.link.message_rates import NAMES, QUEUED, Streams
from missionkit.vehicle.link.traffic_link import TrafficLink
from missionkit.vehicle.telemetry.autopilot_state import AutopilotState
from missionkit.vehicle.telemetry.mission_origin import MissionOrigin
from missionkit.vehicle.telemetry.observer import Observer, TimedVelocity
from missionkit.vehicle.telemetry.raw_imu_conversion import RawImuConverter
from missionkit.vehicle.telemetry.reported_pose import Pose, reported_pose
from missionkit.vehicle.telemetry.required_inputs import Reliance
from missionkit.vehicle.telemetry.simulation_lag import SimulationLag

ANSWER_TIMEOUT = 10.0  # s to wait for an answer
CENSUS = 1.2  # s (of the vehicle) in which every autopilot on a link sends a heartbeat
WORDS_WITHIN = 3.0  # s (wall; longer where time passes slowly) to wait for a heartbeat

T = TypeVar("T")


class MavsdkVehicle:
    """A PX4 or ArduPilot vehicle behind the port `Vehicle`.

    Args:
        address: where it is.
        camera: gives frames; none by default.
        pace: seconds of the vehicle in one of the wall, for simulated autopilots.
        patience: s to wait for an answer.
        lock: against a second process on the same link.
        share: which parts of the estimate are sent to the autopilot; nothing by default.
        system: MAVLink system id of the vehicle, where several share the link.
        guard: how long the guardian bears silence; None: no guardian, for who only looks.
        relies_on: inputs whose absence is a problem (`reliance`).
        wanted: the mission's origin, if it has one; None: the vehicle's home is the origin.
        traffic: to the other vehicles of its fleet, if it flies in one.
        gimbal: whether the camera is on a gimbal, whose attitude every frame then needs.
        lands_precisely: the mission orders the autopilot's own precision landing.
    """

    def __init__(
        self,
        address: Address,
        camera: FrameSource | None = None,
        pace: float = 1.0,
        patience: float = ANSWER_TIMEOUT,
        lock: LinkLock | None = None,
        share: Share = SHARE_NOTHING,
        system: int | None = None,
        guard: Patience | None = USUAL,
        relies_on: Iterable[str] = (),
        wanted: MissionOrigin | None = None,
        traffic: TrafficLink | None = None,
        *,
        gimbal: bool = False,
        lands_precisely: bool = False,
    ) -> None:
        self.address = address
        self.cache = Cache(wall, QUEUED)
        self.reports: list[CommandReport] = []  # of every command that has ended
        self._camera = NoCamera() if camera is None else camera
        self._pace = pace
        self._patience = patience
        self._lock = lock or LinkLock(address)
        self._clock = MissionClock(pace)
        self._lag = SimulationLag(self.cache)
        self._lifecycle = LinkLifecycle(pace)
        self.cache.listen(self._lifecycle.hear)
        self._share = share
        self._system = system
        self._guard = guard
        self._wanted = wanted
        self._lands_precisely = lands_precisely
        self._gimbal = gimbal
        self.traffic = traffic
        self._guardian: Guardian | None = None
        self._sharing: Sharing | None = None
        self._notes = EventNotes()
        self._check = MessageCheck(self.cache, self._notes.note, self._notes.remark, pace)
        self._now = 0.0
        self._correction = Correction()
        self._reliance = Reliance(relies_on)
        self._workers = ThreadPoolExecutor(2, thread_name_prefix="vehicle")
        self._parts: ConnectedVehicle | None = None

    @property
    def dialect(self) -> Dialect:
        """The autopilot's dialect."""
        return self._joined.dialect

    @property
    def wants_set(self) -> tuple[str, ...]:
        """Parameters of the autopilot that must not be 0 for this mission."""
        return self.dialect.precise_parameters if self._lands_precisely else ()

    @property
    def state(self) -> AutopilotState:
        """Status reported by the autopilot."""
        return self._joined.state

    @property
    def link(self) -> Link:
        """The link, for parameters and fences."""
        return self._joined.link

    @property
    def observer(self) -> Observer:
        """Converts messages to observations."""
        return self._joined.observer

    @property
    def streamer(self) -> Streamer:
        """Sends the setpoints."""
        return self._joined.streamer

    @property
    def streams(self) -> Streams:
        """Requests the telemetry streams."""
        return self._joined.streams

    @property
    def guardian(self) -> Guardian | None:
        """Process that owns the link, and stops the vehicle when this process falls silent."""
        return self._guardian

    @property
    def in_control(self) -> bool:
        """Whether missionkit commands; no: a pilot, or the autopilot by itself."""
        return self._joined.authority.ours

    @property
    def link_state(self) -> str:
        """State of the link (`link_lifecycle.STATES`)."""
        return self._lifecycle.at(wall())

    @property
    def control_state(self) -> str:
        """State of control authority (`control_authority`); "" while not connected."""
        return "" if self._parts is None else self._parts.authority.state

    @property
    def contested(self) -> bool:
        """Whether two vehicles answer with one system id."""
        return self._check.contested

    @property
    def camera_problem(self) -> str:
        """Current problem of the camera, "" if there is none."""
        return self._camera.problem

    async def connect(self) -> None:
        """Reach the vehicle; one that has been reached stays so.

        Raises:
            VehicleError: the link is in use or no vehicle answered, with what to check.
        """
        if self._lifecycle.state in REACHED:
            return
        if not self._lifecycle.fire("connect"):
            raise VehicleError(f"{self.address.url}: the link is {self._lifecycle.state}")
        try:
            await asyncio.to_thread(self._lock.take)
            await asyncio.to_thread(self._be_guarded)
            local = None if self._guardian is None else self._guardian.local
            link = await Link.open(self.address, self._patience, self._system, local)
            try:
                await self._join(link)
            except BaseException:
                link.close()
                raise
        except BaseException:
            self._lifecycle.fire("refuse")
            self._let_go()
            raise

    def maintain(self) -> None:
        """Ask for streams that are missing, and for the vehicle's time. Call it now and then."""
        self._joined.streams.maintain()
        self._joined.time_sync.ask()

    async def observe(self, until: float) -> Observation:
        """Return all that was sensed since the last call, at mission time `until` (s)."""
        parts = self._joined
        self._clock.tick(until, wall())
        self._now = until
        if not self._camera.running:
            self._camera.start(self)
        self.maintain()
        self._take_reports(parts)
        events = self._notes.take_events()
        frame = self._camera.latest(min(until, parts.observer.moved_until))
        seen = parts.observer.observe(until, frame, events)
        parts.phase.see()
        if frame is not None and frame.gimbal is None:
            frame = frame._replace(gimbal=parts.observer.gimbal.at(frame.at))
        seen = replace(
            seen,
            frame=frame,
            problems=seen.problems + self._reliance.problems(seen),
            in_control=parts.authority.ours,
        )
        if self.traffic is None:
            return seen
        return replace(seen, traffic=self.traffic.others(until, parts.observer.origin))

    async def send(self, command: Command) -> None:
        """Carry out `command`. Nothing is sent while a pilot or the autopilot commands."""
        parts, at = self._joined, self._clock.wall(self._now)
        if at is not None:
            parts.obey(self._corrected(command, parts.observer), at)

    def _corrected(self, command: Command, observer: Observer) -> Command:
        """Return the command with the error of the autopilot's own velocity taken out."""
        own, known_at = command.own_velocity, min(self._now, observer.moved_until)
        self._correction = velocity_correction.step(
            self._correction,
            self._now,
            None if own is None else TimedVelocity(known_at, own),
            observer.moving(velocity_correction.COMPARABLE_AGE / self._pace),
        )
        if not isinstance(command.setpoint, Setpoint):
            return command
        setpoint = velocity_correction.corrected(command.setpoint, self._correction)
        return command._replace(setpoint=setpoint)

    def tell(self, record: Record, seen: Observation) -> None:
        """Tell the autopilot, and the fleet, what is to be shared; an observer of the flight."""
        if self.traffic is not None and self._parts is not None:
            self.traffic.tell(record, self._parts.observer.origin)
        if self._sharing is not None and self._parts is not None:
            self._sharing(record, seen)

    async def close(self) -> None:
        """Release the vehicle, for good; one that follows our setpoints is ordered to hold."""
        parts, self._parts = self._parts, None
        if self._camera.running:
            self._camera.stop()
        if parts is not None:
            await asyncio.to_thread(parts.leave)  # not behind unanswered calls
            await asyncio.to_thread(self._workers.shutdown, cancel_futures=True)
            parts.link.close()
        self._lifecycle.fire("close")
        self._workers.shutdown(wait=False)
        await asyncio.to_thread(self._let_go)

    def resume_control(self) -> None:
        """Command again after a pilot's takeover. Only a person may ask for this."""
        authority = self._joined.authority
        if not authority.ours and self._guardian is not None:
            self._guardian.given()
        if authority.resume():
            self._notes.note(CONTROL_RESUMED)

    async def call(self, function: Callable[..., T], *args: Any) -> T:
        """Run a blocking function of the link without stopping the event loop."""
        return await asyncio.get_running_loop().run_in_executor(self._workers, function, *args)

    async def hear(self, name: str, patience: float) -> bool:
        """Wait until a message of a name is there; say whether it is."""
        found = self.cache.wait
        return await self.call(found, lambda: self.cache.latest(name) is not None, patience)

    def lag(self, now: float) -> float:
        """Return how far (s) a simulated autopilot's clock has fallen behind mission time `now`."""
        return self._lag.at(now)

    def put_off(self, wait: float) -> None:
        """Take note that mission time stood still for `wait` (s, of the wall)."""
        self._clock.put_off(wait)

    def mission_time(self, wall_time: float) -> float | None:
        """Return the mission time (s) at a wall time, None before the first tick."""
        return self._clock.at(wall_time)

    @property
    def _joined(self) -> ConnectedVehicle:
        if self._parts is None:
            raise VehicleError(f"{self.address.url}: not connected")
        return self._parts

    @property
    def _words_within(self) -> float:
        return max(WORDS_WITHIN, self._patience) / min(1.0, self._pace)

    async def _join(self, link: Link) -> None:
        self._lifecycle.fire("answer")
        link.listen(NAMES.values(), RawImuConverter(self._check))
        begun = wall()
        await self.hear("HEARTBEAT", self._words_within)
        await asyncio.sleep(max(0.0, CENSUS / self._pace - (wall() - begun)))
        beat = await identified(
            link, self.cache, self.address, self._system, self._words_within, self.call
        )
        dialect = None if beat is None else dialect_of(int(beat["autopilot"]))
        if dialect is None:
            raise VehicleError(f"{self.address.url}: the autopilot is silent")
        idle = (lambda: None) if self._guardian is None else self._guardian.idle
        callbacks = self._notes.note, self._notes.remark, self._check
        self._parts = ConnectedVehicle(
            *(link, self._lifecycle, dialect, self.cache, self._clock),
            *(*callbacks, self._pace, idle),
            wanted=self._wanted,
            gimbal=self._gimbal,
        )
        start, stamp = (lambda: self.observer.start), self._clock.wall
        self._sharing = Sharing(self._share, link.send, start, stamp, dialect.target_frame)
        self._parts.start()

    def _be_guarded(self) -> None:
        if self._guard is not None:
            descriptor, overruled = self._lock.descriptor, self._overruled
            self._guardian = Guardian(
                self.address, descriptor, self._pace, self._guard, overruled, self._notes.note
            )

    def _overruled(self) -> None:
        if self._parts is not None:
            self._parts.authority.overruled()

    def _let_go(self) -> None:
        guardian, self._guardian = self._guardian, None
        if guardian is not None:
            guardian.close()
        self._lock.release()

    def _take_reports(self, parts: ConnectedVehicle) -> None:
        for report in parts.commander.reports():
            self.reports.append(report)
            if report.result.outcome is CommandOutcome.ABANDONED or report.result.good:
                continue
            ending = "refused" if report.result.outcome is CommandOutcome.REFUSED else "unconfirmed"
            self._notes.note(f"{report.wish[0]}_{ending}")

    def note(self, event: str) -> None:
        """Keep an event for the next observation."""
        self._notes.note(event)

    def take_remarks(self) -> tuple[str, ...]:
        """Return what is to be recorded since the last call, a sentence each."""
        return self._notes.take_remarks()

    def pose(self) -> Pose | None:
        """Return where the vehicle says it is."""
        parts = self._parts
        if parts is None:
            return None
        return reported_pose(self.cache, parts.observer, parts.dialect.sphere)
