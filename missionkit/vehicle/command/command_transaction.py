"""One command to the autopilot: sent, repeated, acknowledged; without an answer it is unknown."""

from __future__ import annotations

import threading
from collections.abc import Callable, Sequence
from enum import StrEnum
from typing import NamedTuple

from missionkit.vehicle.link.message_cache import Cache, Message
from missionkit.vehicle.link.message_link import MessageLink

ATTEMPT = 0.3  # s until a command is repeated
ATTEMPTS = 4
ACK = "COMMAND_ACK"
_ACK_ACCEPTED, _IN_PROGRESS = 0, 5  # MAV_RESULT
RESULTS = {
    1: "temporarily rejected",
    2: "denied",
    3: "unsupported",
    4: "failed",
    6: "cancelled",
    7: "only as COMMAND_LONG",
    8: "only as COMMAND_INT",
    9: "unsupported frame",
}


def send_command(
    wire: MessageLink, command: int, values: Sequence[float | None], attempt: int = 0
) -> None:
    """Send a COMMAND_LONG.

    Args:
        wire: the link.
        command: MAV_CMD.
        values: of its first parameters, None: NaN; the others are 0.
        attempt: how often it was sent before.

    Raises:
        RuntimeError: there is no link.
    """
    params = (*values, *(0.0,) * (7 - len(values)))
    named = {f"param{n}": value for n, value in enumerate(params, 1)}
    wire.send("COMMAND_LONG", command=command, confirmation=attempt, **named)


class CommandOutcome(StrEnum):
    """How a command ended, as far as is known."""

    DONE = "done"  # telemetry shows it
    ACCEPTED = "accepted"  # acknowledged; nothing in telemetry would show it
    REFUSED = "refused"
    UNCONFIRMED = "unconfirmed"  # acknowledged, but telemetry does not show it
    UNKNOWN = "unknown"  # no answer: it may have happened, or may yet
    ABANDONED = "abandoned"  # missionkit no longer commands, or something more urgent came


class Result(NamedTuple):
    """How a command ended, why, and how long that took (s, wall; None: no answer)."""

    outcome: CommandOutcome
    why: str = ""
    took: float | None = None

    @property
    def good(self) -> bool:
        """Whether the requested state holds."""
        return self.outcome in {CommandOutcome.DONE, CommandOutcome.ACCEPTED}


class Acks:
    """Hears acknowledgements on MAVSDK's thread, where none is missed."""

    def __init__(self, cache: Cache) -> None:
        self._heard: dict[int, tuple[int, float]] = {}
        self._lock = threading.Lock()
        cache.listen(self._hear)

    def _hear(self, message: Message) -> None:
        if message.name == ACK and message["result"] != _IN_PROGRESS:
            with self._lock:
                self._heard[int(message["command"])] = (int(message["result"]), message.arrived)

    def since(self, command: int, at: float) -> tuple[int, float] | None:
        """Return result and time of the newest answer to a command that came after `at` (s)."""
        with self._lock:
            heard = self._heard.get(command)
        return heard if heard is not None and heard[1] >= at else None


class Ask(NamedTuple):
    """A command, and what shows that it was carried out."""

    command: int  # MAV_CMD
    params: tuple[float | None, ...] = ()  # None: NaN
    shows: Callable[[], bool] | None = None  # by telemetry
    patience: float = 1.0  # s after the answer


class Desk(NamedTuple):
    """Resources of every command."""

    wire: MessageLink
    cache: Cache
    acks: Acks
    give_up: Callable[[], bool]  # something more urgent came
    pace: float = 1.0  # seconds of the vehicle in one of the wall


def transact(desk: Desk, ask: Ask) -> Result:
    """Carry out one command; blocks the calling thread for at most a few seconds.

    Lost acknowledgements do not matter where telemetry shows the effect, and an acknowledgement
    does not count where it does not.
    """
    begun = desk.cache.wall()

    def shown() -> bool:
        beat = desk.cache.latest("HEARTBEAT")
        confirmed = beat is not None and beat.arrived >= begun
        return confirmed and ask.shows is not None and ask.shows()

    heard = _asked(desk, ask, begun, shown)
    took = None if heard is None else heard[1] - begun
    if heard is not None and heard[0] != _ACK_ACCEPTED:
        return Result(CommandOutcome.REFUSED, RESULTS.get(heard[0], f"result {heard[0]}"), took)
    if ask.shows is None and heard is not None:
        return Result(CommandOutcome.ACCEPTED, "", took)
    patience = ask.patience / desk.pace if ask.shows is not None else 0.0
    desk.cache.wait(lambda: shown() or desk.give_up(), patience)
    if shown():
        return Result(CommandOutcome.DONE, "", took)
    if desk.give_up():
        return Result(CommandOutcome.ABANDONED, "overtaken", took)
    if heard is None:
        return Result(CommandOutcome.UNKNOWN, "no answer")
    return Result(CommandOutcome.UNCONFIRMED, "accepted, but telemetry does not show it", took)


def _asked(
    desk: Desk, ask: Ask, begun: float, shown: Callable[[], bool]
) -> tuple[int, float] | None:
    """Ask until there is an answer, or telemetry shows that none is needed."""

    def settled() -> bool:
        return desk.acks.since(ask.command, begun) is not None or shown() or desk.give_up()

    for attempt in range(ATTEMPTS):
        if not desk.give_up():
            send_command(desk.wire, ask.command, ask.params, attempt)
        if desk.cache.wait(settled, ATTEMPT):
            break
    return desk.acks.since(ask.command, begun)
