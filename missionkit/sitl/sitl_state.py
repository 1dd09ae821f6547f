"""State of the simulated autopilot; the other modules read and change it."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

from missionkit.geometry import Vec3, vec
from missionkit.messages import (
    Baro,
    Battery,
    Gnss,
    Imu,
    Magnetometer,
    Observation,
    OpticalFlow,
    Range,
    Scan,
)
from missionkit.sim.gimbal import SimulatedGimbal
from missionkit.sim.pad_landing import PadTarget
from missionkit.sitl.flight_modes import FlightMode, FlightTask, ModeTable
from missionkit.sitl.geodetic import Earth
from missionkit.sitl.parameter_protocol import Parameters
from missionkit.sitl.peer_channel import Channel, Sender
from missionkit.sitl.pymavlink_dialect import Message, mavlink
from missionkit.sitl.setpoint_tracking import SetpointTarget
from missionkit.sitl.simulated_body import SimulatedBody
from missionkit.sitl.stored_plans import Plans
from missionkit.sitl.wire_faults import WireFaults

ALERT = mavlink.MAV_SEVERITY_ALERT
SEVERITY_WARNING = mavlink.MAV_SEVERITY_WARNING
SEVERITY_INFO = mavlink.MAV_SEVERITY_INFO
DEAD_RECKONING = 10.0  # s, ArduPilot: AP_NavEKF3 posRetryTimeUseVel_ms
FLOW_PARAMETERS = {"px4": ("EKF2_OF_CTRL", 1), "ardupilot": ("EK3_SRC1_VELXY", 5)}
"""Parameter that lets the estimator use optical flow, and the value that does."""
FLOW_HELD = 5.0  # s that it continues without flow, as EKF2_NOAID_TOUT
GCS = mavlink.MAV_TYPE_GCS
JOURNAL_LENGTH = 100_000  # notes
TEXT_LENGTH = 50  # characters of a STATUSTEXT


class JournalNote(NamedTuple):
    """Something that happened."""

    at: float  # s, simulated
    wall: float  # s, of the machine's clock
    what: str  # setpoint, command, mode, said
    which: str


class Orbit(NamedTuple):
    """A circle that is flown, clockwise seen from above if `speed` is positive."""

    centre: Vec3  # (3,), m, NED
    radius: float  # m
    speed: float  # m/s


@dataclass(slots=True)
class Sensed:
    """The newest reading of each sensor."""

    imu: Imu = field(default_factory=lambda: Imu(0.0, vec(0.0, 0.0, 0.0), vec(0.0, 0.0, 0.0)))
    gnss: Gnss | None = None
    baro: Baro | None = None
    mag: Magnetometer | None = None
    scan: Scan | None = None
    battery: Battery | None = None
    flow: OpticalFlow | None = None
    range: Range | None = None
    flow_held_at: float = -math.inf  # s, when it last stood, or saw the ground pass

    def update(self, seen: Observation) -> None:
        """Take over what arrived."""
        if seen.imu:
            self.imu = seen.imu[-1]
        self.gnss = seen.gnss or self.gnss
        self.baro = seen.baro or self.baro
        self.mag = seen.mag or self.mag
        self.scan = seen.scan or self.scan
        self.battery = seen.battery or self.battery
        self.range = seen.range or self.range
        if seen.flow is not None:
            self.flow = seen.flow
            if seen.flow.quality > 0.0:
                self.flow_held_at = seen.flow.at


@dataclass(slots=True)
class SitlState:
    """Everything about one simulated autopilot, in simulated seconds."""

    dialect: ModeTable
    body: SimulatedBody
    earth: Earth
    parameters: Parameters
    troubles: WireFaults
    mode: FlightMode
    home: Vec3  # (3,), m, NED
    wall: Callable[[], float]
    gimbal: SimulatedGimbal
    journal: deque[JournalNote] = field(default_factory=lambda: deque(maxlen=JOURNAL_LENGTH))
    channels: list[Channel] = field(default_factory=list)
    sensed: Sensed = field(default_factory=Sensed)
    plans: Plans = field(default_factory=Plans)
    system: int = 1
    heartbeat: float = 1.0  # s between two
    booted: float = 0.0
    silent_until: float = 0.0  # restarting
    target: SetpointTarget | None = None  # the newest setpoint
    aim: SetpointTarget | None = None  # target of an autonomous flight
    orbit: Orbit | None = None
    phase: str = ""  # of an autonomous flight
    phase_since: float = 0.0
    origin_set: bool = False
    speed: float | None = None  # m/s, asked for by DO_CHANGE_SPEED
    armed_at: float = math.inf
    flown: bool = False  # since it was armed
    peers: dict[Sender, tuple[float, int]] = field(default_factory=dict)  # last heartbeat, type
    failsafe: str = ""  # the one that took over, until the mode is changed or it disarms
    pending: tuple[float, FlightTask] | None = None  # what a failsafe does, and when
    payload: str | None = None  # actuator that is on
    photos: int = 0  # taken
    devices: dict[str, float] = field(default_factory=dict)  # as ordered last
    pad: PadTarget | None = None  # of LANDING_TARGET, in its own local frame
    gimbal_owner: Sender | None = None  # who has primary control of it
    height: float = 2.5  # m above home, of the next take-off
    grounded_at: float = 0.0
    warned: set[str] = field(default_factory=set)
    lost_gnss_at: float = math.inf
    late_acks: list[tuple[float, Channel, Message]] = field(default_factory=list)

    @property
    def now(self) -> float:
        """Simulated time (s)."""
        return self.body.now

    @property
    def armed(self) -> bool:
        """Whether the rotors turn."""
        return self.body.armed

    @property
    def in_air(self) -> bool:
        """Whether it is off the ground."""
        return not self.body.on_ground

    @property
    def gnss_lost(self) -> bool:
        """Whether there is no fix."""
        return self.now >= self.lost_gnss_at

    @property
    def by_flow(self) -> bool:
        """Whether its estimator uses optical flow: enabled, and on the ground or flow in sight."""
        chosen = (
            self.parameters[FLOW_PARAMETERS[self.dialect.name][0]]
            == FLOW_PARAMETERS[self.dialect.name][1]
        )
        return chosen and self.now - self.sensed.flow_held_at <= FLOW_HELD

    @property
    def positioned(self) -> bool:
        """Whether it has a position of its own."""
        return self.by_flow or not (self.gnss_lost or self.sensed.gnss is None)

    @property
    def blind(self) -> bool:
        """Whether the position is given up, some time after the last fix."""
        if self.by_flow:
            return False
        if self.dialect.name == "px4":
            return self.now - self.lost_gnss_at > 1e-6 * self.parameters["EKF2_NOAID_TOUT"]
        return self.now - self.lost_gnss_at > DEAD_RECKONING

    @property
    def micros(self) -> int:
        """Time since boot (µs)."""
        return self.since_boot(self.now)

    def since_boot(self, at: float) -> int:
        """Return a simulated time as µs since boot, not before it."""
        return max(0, round(1e6 * (at - self.booted)))

    def enter(self, mode: FlightMode) -> None:
        """Change the flight mode; the failsafe, if any, is over."""
        if mode is not self.mode:
            self.mode = mode
            self.note("mode", mode.name)
            if self.dialect.name == "ardupilot":
                self.target = None  # GUIDED begins standing still; PX4 has setpoints before
            self.begin("")
        self.failsafe, self.pending = "", None

    def begin(self, phase: str) -> None:
        """Begin a phase of an autonomous flight."""
        self.phase, self.phase_since, self.aim, self.orbit = phase, self.now, None, None

    def fly(self, flight: FlightTask) -> None:
        """Change to the mode that does so."""
        self.enter(self.dialect.doing(flight))

    def silence(self, kind: int | None = None, system: int | None = None) -> float:
        """Return the time (s) since a station of that kind last sent, infinite if never."""
        heard = [
            at
            for who, (at, what) in self.peers.items()
            if kind in {None, what} and system in {None, who.system}
        ]
        return self.now - max(heard, default=-math.inf)

    def note(self, what: str, which: str) -> None:
        """Keep in the journal that something happened now."""
        self.journal.append(JournalNote(self.now, self.wall(), what, which))

    def say(self, text: str, severity: int = SEVERITY_INFO) -> None:
        """Tell everyone."""
        self.note("said", text)
        for channel in self.channels:
            for part in range(0, len(text), TEXT_LENGTH):
                words = text[part : part + TEXT_LENGTH].encode()
                channel.send(mavlink.MAVLink_statustext_message(severity, words), self.now)

    def warn_once(self, key: str, text: str, severity: int = SEVERITY_WARNING) -> None:
        """Tell everyone, once until `warned` forgets it.

        Args:
            key: by which it is remembered.
            text: of the STATUSTEXT.
            severity: MAV_SEVERITY.
        """
        if key not in self.warned:
            self.warned.add(key)
            self.say(text, severity)


def take_over(state: SitlState, name: str, flight: FlightTask, *, wait: float = 0.0) -> None:
    """Let a failsafe fly; `wait` (s) of holding come first. Each takes over once.

    Args:
        state: of the autopilot, changed.
        name: of the failsafe, for the STATUSTEXT and the journal.
        flight: what it does.
        wait: s, of holding before.
    """
    if name in state.warned or state.mode.does is flight:
        return
    state.warn_once(name, f"Failsafe activated: {name}", ALERT)
    if wait > 0.0:
        state.fly(FlightTask.HOLD)
        state.pending = (state.now + wait, flight)
    else:
        state.fly(flight)
    state.failsafe = name
