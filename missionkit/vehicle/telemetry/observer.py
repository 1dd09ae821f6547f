"""From the newest messages to the observation of one tick, every time on the mission's clock."""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Iterable
from typing import NamedTuple

from missionkit.geodesy import Origin
from missionkit.geometry import Vec3
from missionkit.messages import (
    Baro,
    Battery,
    Frame,
    Gnss,
    Imu,
    Magnetometer,
    Observation,
    VehicleStatus,
)
from missionkit.vehicle.link.clocks import MissionClock
from missionkit.vehicle.link.message_cache import Cache, Fields, Message
from missionkit.vehicle.link.time_sync import Answer
from missionkit.vehicle.telemetry import batteries, message_readings
from missionkit.vehicle.telemetry.autopilot_state import AutopilotState
from missionkit.vehicle.telemetry.frame_changes import FrameChanges
from missionkit.vehicle.telemetry.gimbal_attitude import GimbalReadings
from missionkit.vehicle.telemetry.home_position import home_message, local_home, place_of
from missionkit.vehicle.telemetry.mission_origin import MissionOrigin, misplacement, world_origin
from missionkit.vehicle.telemetry.ordered_arrivals import Arrivals
from missionkit.vehicle.telemetry.range_sensors import RangeSensors
from missionkit.vehicle.telemetry.status_text import event_of

COMPLETION_AGE = 1.0  # s; older attitude or speed is not used to complete another reading
DATE_AGE = 5.0  # s, wall; an older message about the date was looked at before
DATED = 1.5e9  # s since 1970: a clock that reads less was never set
RARELY = 0.1  # s between two readings of magnetometer and barometer, as the filter wants them


class Datum(NamedTuple):
    """Datum of the positions and heights of a flight."""

    origin: Origin | None = None
    ground: float | None = None  # m, pressure altitude of home


class InertialReadings(NamedTuple):
    """Data from HIGHRES_IMU."""

    imu: tuple[Imu, ...]
    mag: Magnetometer | None
    baro: Baro | None


class TimedVelocity(NamedTuple):
    """A velocity and when it was true."""

    at: float  # s, mission
    velocity: Vec3  # (3,), m/s, NED


class Observer:
    """Turns messages into observations.

    Args:
        cache: the newest messages.
        state: what the autopilot says about itself.
        clock: mission time.
        answers: of the vehicle to the question for its time, since the last call.
        wanted: the mission's origin; home is the origin of one without.
    """

    def __init__(
        self,
        cache: Cache,
        state: AutopilotState,
        clock: MissionClock,
        answers: Callable[[], Iterable[Answer]] = tuple,
        wanted: MissionOrigin | None = None,
    ) -> None:
        self.origin: Origin | None = None
        self._wanted = wanted
        self._frames = FrameChanges(cache)
        self._cache = cache
        self._state = state
        self._clock = clock
        self._arrivals = Arrivals(cache, clock, answers)
        self._around = RangeSensors(self._arrivals)
        self.gimbal = GimbalReadings(cache, self._arrivals)
        self._ground: float | None = None  # m, pressure altitude of home
        self._status_told: VehicleStatus | None = None
        self._forget = threading.Event()
        self._rare: dict[str, float] = {}
        self._packs = batteries.NO_PACKS
        self._fixed_at = -math.inf  # s, of the first receiver's last fix
        self._reported: set[str] = set()
        self._dated: float | None = None  # s since 1970, of mission time 0

    @property
    def start(self) -> Vec3 | None:
        """The mission's origin in the autopilot's local frame, (3,), m; None: not known."""
        home = home_message(self._cache)
        base = local_home(self._cache, by_degrees=self._frames.origin_moved)
        if self.origin is None or home is None or base is None:
            return None
        at = place_of(home)
        return base - self.origin.local(at.latitude, at.longitude, at.altitude)

    def moving(self, max_age: float) -> TimedVelocity | None:
        """Return the velocity the autopilot believes in, no older than that (s, wall)."""
        local = self._cache.latest("LOCAL_POSITION_NED", max_age)
        velocity = (
            None if local is None else message_readings.triple(local.fields, "vx", "vy", "vz")
        )
        at = None if local is None else self.mission_time(local)
        return None if velocity is None or at is None else TimedVelocity(at, velocity)

    @property
    def misplaced(self) -> str:
        """Why the mission cannot be flown from this home: without an origin it is not placed."""
        home = home_message(self._cache)
        if self.origin is not None or home is None:
            return ""
        return misplacement(self._wanted, place_of(home))

    @property
    def datum(self) -> Datum:
        """Datum of positions and heights."""
        return Datum(self.origin, self._ground)

    @property
    def moved_until(self) -> float:
        """Mission time (s) up to which motion is known; what was seen later waits for it."""
        sample = self._cache.latest("HIGHRES_IMU", COMPLETION_AGE)
        at = None if sample is None else self.mission_time(sample)
        return math.inf if at is None else at

    def settle(self, datum: Datum) -> None:
        """Measure from where an earlier process did, wherever the autopilot's home is now."""
        self.origin, self._ground = datum

    def forget(self) -> None:
        """Restart with the clock of an autopilot that has rebooted, at the next tick.

        Home stays where it was. May be called from any thread.
        """
        self._forget.set()

    def observe(self, now: float, frame: Frame | None, events: Iterable[str]) -> Observation:
        """Return all that arrived since the last call, at mission time `now` (s).

        Args:
            now: s.
            frame: of the camera, new at this tick.
            events: from the operator, beside those that the vehicle sent as texts.
        """
        if self._forget.is_set():
            self._forget.clear()
            self._arrivals.forget()
            self._dated = None
        self._arrivals.collect()
        self._find_origin()
        moved, sentences = self._frames.seen(armed=bool(self._state.armed))
        inertial, around = self._inertial(now), self._around
        scan, flow, reach = around.scan(now), around.flow(now), around.range(now)
        return Observation(
            now=now,
            imu=inertial.imu,
            gnss=self._fix(now),
            baro=inertial.baro,
            mag=inertial.mag,
            frame=frame,
            scan=scan,
            battery=self._battery(now),
            status=self._status(now),
            events=(*events, *moved, *self._texts(now)),
            flow=flow,
            range=reach,
            problems=(*sentences, *self._news_of_problems()),
            gimbal=self.gimbal.read(now),
            utc=self._utc(now),
        )

    def mission_time(self, message: Message) -> float | None:
        """Return when something was measured (s, mission), by its stamp or else by its arrival."""
        return self._arrivals.mission_time(message)

    def _find_origin(self) -> None:
        home = home_message(self._cache)
        if self.origin is None and home is not None and not self.misplaced:
            self.origin = world_origin(self._wanted, place_of(home))

    def _inertial(self, now: float) -> InertialReadings:
        samples, mag, baro = [], None, None
        for fields, at in self._arrivals.due("HIGHRES_IMU", now):
            sample = message_readings.imu(fields, at)
            if sample is not None:
                samples.append(sample)
            field = message_readings.magnetometer(fields, at)
            if field is not None and self._seldom("mag", at):
                mag = field
            height = self._height(fields, at)
            if height is not None and self._seldom("baro", at):
                baro = height
        return InertialReadings(tuple(samples), mag, baro)

    def _seldom(self, what: str, at: float) -> bool:
        """Say whether it is time for another reading."""
        if at - self._rare.get(what, -RARELY) < 0.99 * RARELY:
            return False
        self._rare[what] = at
        return True

    def _height(self, fields: Fields, at: float) -> Baro | None:
        if self._ground is None:
            above, pressure = self._state.height, message_readings.pressure_height(fields)
            if above is None or pressure is None:
                return None
            self._ground = pressure - above
        return message_readings.baro(fields, at, self._ground)

    def _fix(self, now: float) -> Gnss | None:
        """Return the newest fix of the first receiver, or of the second while that has none."""
        first = self._arrivals.due("GPS_RAW_INT", now)
        second = self._arrivals.due("GPS2_RAW", now)
        fixes = [(fields, at) for fields, at in first if message_readings.fixed(fields)]
        if fixes:
            self._fixed_at = fixes[-1][1]
        elif second and second[-1][1] - self._fixed_at > COMPLETION_AGE:
            fixes = second
        if not fixes or self.origin is None:
            return None
        local = self._cache.latest("LOCAL_POSITION_NED", COMPLETION_AGE)
        climb = None if local is None or local["vz"] is None else -float(local["vz"])
        return message_readings.gnss(*fixes[-1], self.origin, climb)

    def _battery(self, now: float) -> Battery | None:
        new = self._arrivals.arrived("BATTERY_STATUS", now)
        for fields, at in new:
            self._packs = batteries.heard(self._packs, fields, at)
        return batteries.battery(self._packs) if new else None

    def _news_of_problems(self) -> tuple[str, ...]:
        """Return the problems that have not been reported yet."""
        problems = dict.fromkeys((*self._around.problems(), *filter(None, (self.misplaced,))))
        new = tuple(each for each in problems if each not in self._reported)
        self._reported.update(new)
        return new

    def _utc(self, now: float) -> float | None:
        """Return the date (s since 1970) by SYSTEM_TIME; None: the vehicle has not said it."""
        message = self._cache.latest("SYSTEM_TIME", DATE_AGE)
        at = None if message is None else self.mission_time(message)
        date = 0.0 if message is None else 1e-6 * float(message["time_unix_usec"])
        if at is not None and date > DATED:
            self._dated = date - at
        return None if self._dated is None else self._dated + now

    def _status(self, now: float) -> VehicleStatus | None:
        heard, state = self._clock.at(self._state.heard), self._state
        if heard is None or state.mode is None:
            return None
        status = VehicleStatus(
            at=min(heard, now),
            armed=bool(state.armed),
            in_air=bool(state.in_air),
            ready=state.ready,
            mode=state.mode,
            failsafe=state.failsafe,
        )
        if status == self._status_told:
            return None
        self._status_told = status
        return status

    def _texts(self, now: float) -> list[str]:
        due = self._arrivals.due("STATUSTEXT", now)
        return [event_of(int(fields["severity"]), str(fields["text"])) for fields, _ in due]
