"""From the newest messages to the observation of one tick, every time on the mission's clock."""

from __future__ import annotations

import math
import threading
from collections import deque
from collections.abc import Iterable
from typing import NamedTuple

from missionkit.geometry import IDENTITY, Quat, Vec3
from missionkit.messages import (
    Baro,
    Battery,
    Frame,
    Gnss,
    Imu,
    Magnetometer,
    Observation,
    Scan,
    VehicleStatus,
)
from missionkit.vehicle import readings
from missionkit.vehicle.cache import Cache, Message
from missionkit.vehicle.origin import Origin
from missionkit.vehicle.state import State
from missionkit.vehicle.streams import CLOCKED, QUEUED, boot_time
from missionkit.vehicle.timing import BootClock, MissionClock
from missionkit.vehicle.words import event_of

FRESH = 1.0  # s; older attitude or speed is not used to complete another reading
AHEAD = 0.05  # s that a stamp may lie after the arrival: the clocks are only estimated
TURNS = 64  # attitudes kept, a second of them and more
FOREIGN = frozenset(("OBSTACLE_DISTANCE",))  # not always from the autopilot
RARELY = 0.1  # s between two readings of magnetometer and barometer, as the filter wants them


class Datum(NamedTuple):
    """What positions and heights of a flight are measured from."""

    origin: Origin | None = None
    ground: float | None = None  # m, pressure altitude of home


class Inertial(NamedTuple):
    """What HIGHRES_IMU brought."""

    imu: tuple[Imu, ...]
    mag: Magnetometer | None
    baro: Baro | None


class Observer:
    """Turns messages into observations.

    What arrived after a tick was due waits for the next one, so that ticks that catch up after a
    stall see what they would have seen in time.

    Args:
        cache: the newest messages.
        state: what the autopilot says about itself.
        clock: mission time.
    """

    def __init__(self, cache: Cache, state: State, clock: MissionClock) -> None:
        self.origin: Origin | None = None
        self._cache = cache
        self._state = state
        self._clock = clock
        self._boot = BootClock()
        self._ground: float | None = None  # m, pressure altitude of home
        self._waiting: dict[str, list[Message]] = {name: [] for name in QUEUED}
        self._told: dict[str, object] = {}
        self._forget = threading.Event()
        self._rare: dict[str, float] = {}
        self._turns: deque[tuple[float, Quat]] = deque(maxlen=TURNS)

    @property
    def start(self) -> Vec3 | None:
        """The mission's origin in the autopilot's local frame, (3,), m; None: not known."""
        home = self._cache.latest("HOME_POSITION")
        if self.origin is None or home is None:
            return None
        base = readings.triple(home.fields, "x", "y", "z")
        place = 1e-7 * home["latitude"], 1e-7 * home["longitude"], 1e-3 * home["altitude"]
        return None if base is None else base - self.origin.local(*place)

    @property
    def datum(self) -> Datum:
        """What is measured from."""
        return Datum(self.origin, self._ground)

    @property
    def moved_until(self) -> float:
        """Mission time (s) up to which motion is known; what was seen later waits for it."""
        sample = self._cache.latest("HIGHRES_IMU", FRESH)
        at = None if sample is None else self.mission_time(sample)
        return math.inf if at is None else at

    def settle(self, datum: Datum) -> None:
        """Measure from where an earlier process did, wherever the autopilot's home is now."""
        self.origin, self._ground = datum

    def forget(self) -> None:
        """Begin anew with the clock of an autopilot that has rebooted, at the next tick.

        Home stays where it was. May be called from any thread.
        """
        self._forget.set()

    def observe(self, now: float, frame: Frame | None, events: Iterable[str]) -> Observation:
        """Return all that arrived since the last call, at mission time `now` (s)."""
        if self._forget.is_set():
            self._forget.clear()
            self._boot.forget()
            self._waiting = {name: [] for name in QUEUED}
        self._learn()
        self._find_origin()
        for name in QUEUED:
            self._waiting[name].extend(self._cache.drain(name))
        inertial = self._inertial(now)
        self._note_turns(now)
        return Observation(
            now=now,
            imu=inertial.imu,
            gnss=self._fix(now),
            baro=inertial.baro,
            mag=inertial.mag,
            frame=frame,
            scan=self._scan(now),
            battery=self._battery(now),
            status=self._status(now),
            events=(*events, *self._texts(now)),
        )

    def mission_time(self, message: Message) -> float | None:
        """Return when something was measured (s, mission), by its stamp or else by its arrival.

        Obstacle sensors may stamp by a clock of their own: a stamp that lies after the arrival or
        long before it counts as none.
        """
        boot, arrived = boot_time(message), self._clock.at(message.arrived)
        stamped = None if boot is None else self._boot.mission(boot)
        if stamped is None or arrived is None or message.name not in FOREIGN:
            return arrived if stamped is None else stamped
        return stamped if -AHEAD <= arrived - stamped <= FRESH else arrived

    def _learn(self) -> None:
        for name in CLOCKED:
            message = self._cache.latest(name)
            if message is None or message is self._told.get("clock " + name):
                continue
            self._told["clock " + name] = message
            boot, arrived = boot_time(message), self._clock.at(message.arrived)
            if boot is not None and arrived is not None:
                self._boot.hear(boot, arrived)

    def _find_origin(self) -> None:
        home = self._cache.latest("HOME_POSITION")
        if self.origin is None and home is not None:
            self.origin = Origin(
                1e-7 * home["latitude"], 1e-7 * home["longitude"], 1e-3 * home["altitude"]
            )

    def _due(self, name: str, now: float) -> list[tuple[Message, float]]:
        """Return the messages of a name that were there by `now`, with their times."""
        timed = [(message, self.mission_time(message)) for message in self._waiting[name]]
        due = [(message, at) for message, at in timed if at is not None and at <= now]
        self._waiting[name] = [m for m, at in timed if at is None or at > now]
        return due

    def _inertial(self, now: float) -> Inertial:
        samples, mag, baro = [], None, None
        for message, at in self._due("HIGHRES_IMU", now):
            sample = readings.imu(message.fields, at)
            if sample is not None:
                samples.append(sample)
            field = readings.magnetometer(message.fields, at)
            if field is not None and self._seldom("mag", at):
                mag = field
            height = self._height(message, at)
            if height is not None and self._seldom("baro", at):
                baro = height
        return Inertial(tuple(samples), mag, baro)

    def _seldom(self, what: str, at: float) -> bool:
        """Say whether it is time for another reading."""
        if at - self._rare.get(what, -RARELY) < 0.99 * RARELY:
            return False
        self._rare[what] = at
        return True

    def _height(self, message: Message, at: float) -> Baro | None:
        if self._ground is None:
            above, pressure = self._state.height, readings.pressure_height(message.fields)
            if above is None or pressure is None:
                return None
            self._ground = pressure - above
        return readings.baro(message.fields, at, self._ground)

    def _fix(self, now: float) -> Gnss | None:
        due = self._due("GPS_RAW_INT", now)
        if not due or self.origin is None:
            return None
        local = self._cache.latest("LOCAL_POSITION_NED", FRESH)
        message, at = due[-1]
        climb = 0.0 if local is None or local["vz"] is None else -float(local["vz"])
        return readings.gnss(message.fields, at, self.origin, climb)

    def _scan(self, now: float) -> Scan | None:
        due = self._due("OBSTACLE_DISTANCE", now)
        if not due:
            return None
        message, at = due[-1]
        return readings.scan(message.fields, at, self._turned_at(at))

    def _turned_at(self, at: float) -> Quat:
        """Return the autopilot's attitude (body to world) at the time nearest to `at` (s)."""
        nearest = min(self._turns, key=lambda turn: abs(turn[0] - at), default=None)
        if nearest is None or abs(nearest[0] - at) > FRESH:
            return IDENTITY
        return nearest[1]

    def _note_turns(self, now: float) -> None:
        for message, at in self._due("ATTITUDE_QUATERNION", now):
            attitude = readings.turned(message.fields)
            if attitude is not None:
                self._turns.append((at, attitude))

    def _battery(self, now: float) -> Battery | None:
        message = self._news("BATTERY_STATUS")
        at = None if message is None else self._clock.at(message.arrived)
        if message is None or at is None:
            return None
        return readings.battery(message.fields, min(at, now))

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
        )
        if status == self._told.get("status"):
            return None
        self._told["status"] = status
        return status

    def _texts(self, now: float) -> list[str]:
        due = self._due("STATUSTEXT", now)
        return [event_of(int(message["severity"]), str(message["text"])) for message, _ in due]

    def _news(self, name: str) -> Message | None:
        message = self._cache.latest(name)
        if message is None or message is self._told.get(name):
            return None
        self._told[name] = message
        return message
