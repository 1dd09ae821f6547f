"""Asking the vehicle for its time (TIMESYNC): how little its messages can have been delayed.

Stamp and arrival of a message bound its delay on one side only: a link on which messages queue up
looks like a clock that is slow. The answer to a question was stamped after the question was sent,
which bounds it on the other side. A simulated vehicle on a busy machine does have a slow clock.

Source: MAVLink common.xml, message 111, https://mavlink.io/en/services/timesync.html; both PX4 and
ArduPilot answer with the clock that stamps their messages.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable
from contextlib import suppress
from typing import NamedTuple

from missionkit.vehicle.link.message_cache import Fields, Message, Wall
from missionkit.vehicle.link.message_link import MessageLink

EVERY = 0.2  # s (of the vehicle) between two questions
OPEN = 50  # questions that may still be answered
SPAN = 10.0  # s (of the vehicle) over which the clocks' rates are compared
LATEST, DOUBLE = 10, 3  # questions looked back on, and how many of them two vehicles answered
MOST_RATE = 0.1  # share by which they may differ before it is reported


class Answer(NamedTuple):
    """Time reported by the vehicle, and when it was requested."""

    boot: float  # s since its boot
    sent: float  # s, wall


class TimeSync:
    """Asks now and then, and keeps the answers until they are taken.

    Args:
        wire: the link.
        wall: the wall clock (s).
        pace: seconds of the vehicle in one of the wall.
        note: takes a sentence for the record.
    """

    def __init__(
        self, wire: MessageLink, wall: Wall, pace: float, note: Callable[[str], None]
    ) -> None:
        self._wire = wire
        self._wall = wall
        self._pace = pace
        self._note = note
        self._open: deque[int] = deque(maxlen=OPEN)  # ns, wall
        self._heard: deque[tuple[int, int]] = deque(maxlen=OPEN)  # ns: since boot, wall
        self._asked: float | None = None
        self._first: Answer | None = None
        self._said = False

    def ask(self) -> None:
        """Ask, if it is time to. Call it at every tick."""
        now = self._wall()
        if self._asked is not None and (now - self._asked) * self._pace < EVERY:
            return
        self._asked = now
        nanos = int(1e9 * now)
        self._open.append(nanos)
        with suppress(RuntimeError):  # no link
            self._wire.send("TIMESYNC", tc1=0, ts1=nanos)

    def hear(self, message: Message) -> None:
        """Keep an answer, perhaps to another client, on the thread that brings it."""
        if message.name == "TIMESYNC" and (remote := int(message["tc1"] or 0)) > 0:
            self._heard.append((remote, int(message["ts1"] or 0)))

    def take(self) -> list[Answer]:
        """Return the answers to questions of ours since the last call."""
        heard = [self._heard.popleft() for _ in range(len(self._heard))]
        taken = [Answer(1e-9 * remote, 1e-9 * at) for remote, at in heard if at in self._open]
        if taken:
            self._compare(taken[-1])
        return taken

    def _compare(self, last: Answer) -> None:
        """Report, once, that the vehicle's time does not pass as fast as configured."""
        first = self._first
        if first is None or last.boot < first.boot:  # it has rebooted
            self._first = last
            return
        span = (last.sent - first.sent) * self._pace
        if self._said or span < SPAN:
            return
        self._first, rate = last, (last.boot - first.boot) / span
        if abs(rate - 1.0) > MOST_RATE:
            self._said = True
            self._note(
                f"the vehicle's clock runs at {rate:.2f} of the rate that --speed says: "
                "its simulation does not keep up; choose a lower one"
            )


class DoubleAnswers:
    """Notices that two vehicles answer the same question, each with its own time.

    It tells two vehicles of one system id apart even where their clocks started together.
    """

    def __init__(self) -> None:
        self._latest: deque[tuple[int, set[int]]] = deque(
            maxlen=LATEST
        )  # ns: requested at, answers

    def hear(self, fields: Fields) -> None:
        """Take a TIMESYNC message in."""
        boot, requested_at = int(fields["tc1"] or 0), int(fields["ts1"] or 0)
        if boot <= 0:  # a question of the vehicle's own
            return
        for known, answers in self._latest:
            if known == requested_at:
                answers.add(boot)
                return
        self._latest.append((requested_at, {boot}))

    @property
    def contested(self) -> bool:
        """Whether several of the latest questions have two different answers."""
        return sum(len(answers) > 1 for _, answers in self._latest) >= DOUBLE
