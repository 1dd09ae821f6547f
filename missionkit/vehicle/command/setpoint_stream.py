"""Streams setpoints from one thread; silent when no new commands come.

A setpoint is sent only because a tick commanded it. The thread shares nothing
with the event loop, so that a loop that hangs cannot keep the vehicle flying:

    age of the newest command    what goes out
    up to STALE (0.5 s)          the command, at once when it is new, and again while it is fresh
    up to SILENT (1.5 s)         zero velocity, whatever it was: the vehicle holds
    older                        nothing: the autopilot's own failsafe takes over

A stalled interpreter sends nothing either, which leads to the same failsafe. Once it continues it
waits for telemetry that is newer than its waking: the world has changed meanwhile.

A setpoint with a number that is not finite is zero velocity from the start.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import NamedTuple, Protocol

from missionkit.geometry import vec
from missionkit.messages import AutopilotSetpoint, Setpoint
from missionkit.vehicle.command.setpoint_encoding import sound

STALE = 0.5  # s
SETPOINTS_STOP_AFTER = 1.5  # s
SETPOINT_RATE = 20.0  # Hz
SENDING_DELAY = 0.05  # s between deciding and sending: the process stood still just then
ZERO_VELOCITY = Setpoint(vec(0.0, 0.0, 0.0), 0.0)

Gate = Callable[[], bool]


class Emitter(Protocol):
    """Puts one setpoint on the wire."""

    def __call__(self, setpoint: AutopilotSetpoint) -> None:
        """Send it now."""


class TimedSetpoint(NamedTuple):
    """The newest command, and when the tick that gave it was due (s, wall)."""

    setpoint: AutopilotSetpoint
    at: float


def due(newest: TimedSetpoint | None, now: float, pace: float = 1.0) -> AutopilotSetpoint | None:
    """Return what to send at wall time `now` (s), None for silence.

    Args:
        newest: the newest command.
        now: wall time.
        pace: how many seconds of the vehicle pass in one of the wall.
    """
    if newest is None:
        return None
    age = (now - newest.at) * pace
    if age > SETPOINTS_STOP_AFTER:
        return None
    return newest.setpoint if age <= STALE else ZERO_VELOCITY


class Streamer:
    """Sends setpoints from its own thread.

    Args:
        emit: puts one on the wire.
        gate: says whether the vehicle still follows us; called before every setpoint.
        wall: the wall clock (s).
        pace: seconds of the vehicle in one of the wall.
        rate: how often (Hz) a fresh command is repeated when no new one comes.
        paused: called while the gate is closed, until it has noted (True) that setpoints stop on
            purpose.
    """

    def __init__(
        self,
        emit: Emitter,
        gate: Gate,
        wall: Callable[[], float],
        pace: float = 1.0,
        rate: float = SETPOINT_RATE,
        paused: Gate = lambda: True,
    ) -> None:
        self._emit = emit
        self._gate = gate
        self._wall = wall
        self._pace = pace
        self._repeat = 1.04 / (rate * pace)  # a tick that is a little late is not overtaken
        self._told: TimedSetpoint | None = None
        self._news = threading.Condition()
        self._fresh = False
        self._ended = False
        self._paused = paused
        self._flows = False
        self._since: float | None = None
        self._looked = wall()
        self.woken = float("-inf")  # s, wall, when the process last woke up after a standstill
        self.sent = 0
        self.failed = 0
        self.last = float("-inf")  # s, wall, when the last one went out
        self._thread = threading.Thread(target=self._run, name="setpoints", daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def tell(self, setpoint: AutopilotSetpoint, at: float) -> None:
        """Take over a command whose tick was due at wall time `at` (s)."""
        with self._news:
            self._told = TimedSetpoint(setpoint if sound(setpoint) else ZERO_VELOCITY, at)
            self._fresh = True
            self._news.notify()

    def quiet(self) -> None:
        """Send nothing until the next command."""
        with self._news:
            self._told = None
            self._fresh = False
            self._since = None

    def streaming(self, now: float) -> float:
        """Return for how long (s, wall) setpoints have gone out without a break."""
        since = self._since
        broken = since is None or (now - self.last) * self._pace > STALE
        return 0.0 if since is None or broken else now - since

    def stop(self) -> None:
        """End the thread."""
        with self._news:
            self._ended = True
            self._news.notify()
        if self._thread.is_alive():
            self._thread.join(2.0)

    def once(self) -> bool:
        """Send what is due now, if anything; say whether something went out."""
        now = self._wall()
        if (now - self._looked) * self._pace > STALE:
            self.woken = now
        self._looked = now
        setpoint = self._allowed(due(self._told, now, self._pace))
        if setpoint is None or self._wall() - now > SENDING_DELAY:
            self._since = None
            return False
        try:
            self._emit(setpoint)
        except RuntimeError:  # the link is being closed, or refuses: silence is safe
            self.failed += 1
            return False
        if self._since is None or (now - self.last) * self._pace > STALE:
            self._since = now
        self.last = now
        self.sent += 1
        self._flows = True
        return True

    def _allowed(self, setpoint: AutopilotSetpoint | None) -> AutopilotSetpoint | None:
        """Return the setpoint, or None while the vehicle does not listen to us."""
        if setpoint is None or self._gate():
            return setpoint
        if self._flows:
            self._flows = not self._paused()
        return None

    def _run(self) -> None:
        while True:
            with self._news:
                if not self._fresh and not self._ended:
                    self._news.wait(self._repeat)
                if self._ended:
                    return
                self._fresh = False
            self.once()
