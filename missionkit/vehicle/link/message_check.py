"""Checks incoming messages before they are used: heartbeats, and the autopilot's timestamps.

    link -> MessageCheck -> cache -> everything else

A message that is not trusted goes no further, and the record says so.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from typing import Protocol

from missionkit.vehicle.link.boot_epoch import BootEpoch, Stamp
from missionkit.vehicle.link.heartbeat_check import HeartbeatCheck, HeartbeatState
from missionkit.vehicle.link.message_cache import Cache, Fields, Message
from missionkit.vehicle.link.message_rates import CLOCKED, boot_time
from missionkit.vehicle.link.time_sync import DoubleAnswers
from missionkit.vehicle.link.vehicle_type import type_name

MODE_COMMANDS = frozenset((20, 21, 22, 176, 400))  # MAV_CMD: what a heartbeat shows the effect of
ACCEPTED = 0  # MAV_RESULT
SETTLING = 0.3  # s of the vehicle after which a heartbeat shows what an accepted command did
TWO_VEHICLES = "two_vehicles"  # the event
ORDERED = "LOCAL_POSITION_NED"  # slow enough that a link keeps its order, mostly
ASK_EVERY = 0.2  # s of the vehicle between two requests for a heartbeat, at least


class Judge(Protocol):
    """Receiver of checked heartbeats."""

    def expects(self, now: HeartbeatState) -> bool:
        """Say whether the content of a heartbeat is expected."""

    def hear(self, message: Message) -> None:
        """Take in a trusted heartbeat."""

    def doubt(self, message: Message) -> None:
        """Note an unexpected heartbeat."""

    def accepted(self, command: int) -> None:
        """Note that heartbeats show from now on what a command (MAV_CMD) did."""

    @property
    def unsettled(self) -> bool:
        """Whether the last heartbeat has to be confirmed by another one."""

    def replaced(self, by: str) -> None:
        """Note that another kind of vehicle answers now."""


class MessageCheck:
    """Passes trusted messages on to the cache.

    Args:
        cache: takes it.
        tell: takes an event for the mission.
        note: takes a sentence for the record.
        pace: seconds of the vehicle in one of the wall.
    """

    def __init__(
        self,
        cache: Cache,
        tell: Callable[[str], None],
        note: Callable[[str], None],
        pace: float = 1.0,
    ) -> None:
        self._cache = cache
        self._tell = tell
        self._note = note
        self._heartbeats = HeartbeatCheck()
        self._epoch = BootEpoch(pace)
        self._answers = DoubleAnswers()
        self._pace = pace
        self._judge: Judge | None = None
        self._rebooted: Callable[[], None] = lambda: None
        self._ask_again: Callable[[], None] = lambda: None
        self._contested = False
        self._due = False  # a heartbeat is to be requested
        self._asked = -math.inf  # s of the vehicle, when one was last requested
        self._accepted: tuple[int, float] | None = None  # MAV_CMD, and when (s of the vehicle)

    @property
    def contested(self) -> bool:
        """Whether two vehicles answer with one system id."""
        return any(it.contested for it in (self._heartbeats, self._epoch, self._answers))

    def report_to(
        self, judge: Judge, rebooted: Callable[[], None], ask_again: Callable[[], None]
    ) -> None:
        """Say from now on who judges heartbeats.

        Args:
            judge: knows what is expected.
            rebooted: called when the autopilot has restarted.
            ask_again: requests another heartbeat at once.
        """
        self._judge, self._rebooted, self._ask_again = judge, rebooted, ask_again

    def __call__(self, name: str, fields: Fields) -> None:
        """Take a message in."""
        if name == "HEARTBEAT":
            self._heartbeat(fields)
        elif name not in CLOCKED or self._sound(Message(name, fields, self._cache.wall())):
            self._cache.put(name, fields)
        if name == "TIMESYNC":
            self._answers.hear(fields)
        if name == "COMMAND_ACK":
            self._acknowledged(int(fields["command"]), int(fields["result"]))
        self._ask_if_due()
        before, self._contested = self._contested, self.contested
        if self._contested and not before:
            self._tell(TWO_VEHICLES)
            self._note("two vehicles use the same system id: give each its own")

    def _acknowledged(self, command: int, result: int) -> None:
        """Ask for a heartbeat: what the command did shows at once, a pilot's next mode too."""
        if command not in MODE_COMMANDS:
            return
        self._due = True
        if result == ACCEPTED:
            self._accepted = command, self._cache.wall() * self._pace

    def _settle(self, judge: Judge) -> None:
        """Say what was accepted long enough ago to show."""
        if self._accepted is None:
            return
        command, at = self._accepted
        if self._cache.wall() * self._pace - at >= SETTLING:
            self._accepted = None
            judge.accepted(command)

    def _heartbeat(self, fields: Fields) -> None:
        judge = self._judge
        expected = _anything if judge is None else judge.expects
        found = self._heartbeats.hear(fields, expected, self._cache.wall() * self._pace)
        if found.fields is not None:
            self._cache.put("HEARTBEAT", found.fields)
        if found.odd:
            kind = type_name(int(fields["type"]))
            self._note(f"a heartbeat of a {kind} was ignored: the vehicle is of another type")
        if found.retracted is not None:
            how = "armed" if found.retracted.armed else "disarmed"
            self._note(
                f"a heartbeat of custom mode {found.retracted.mode:#x}, {how}, was ignored: "
                "the next one did not confirm it"
            )
        if judge is None:
            return
        self._settle(judge)
        message = Message("HEARTBEAT", fields, self._cache.wall())
        if found.doubted is not None:
            judge.doubt(message)
            self._due = True
        elif found.fields is not None:
            judge.hear(message)
            self._due |= judge.unsettled
        if found.stranger:
            judge.replaced(type_name(int(fields["type"])))

    def _ask_if_due(self) -> None:
        """Ask for a heartbeat if one is due; too soon after the last time it stays due."""
        now = self._cache.wall() * self._pace
        if not self._due or now - self._asked < ASK_EVERY:
            return
        self._due, self._asked = False, now
        with suppress(RuntimeError):  # no link: the next heartbeat comes by itself
            self._ask_again()

    def _sound(self, message: Message) -> bool:
        boot = boot_time(message)
        if boot is None:
            return True
        ordered = message.name == ORDERED
        worth = self._epoch.judge(boot, message.arrived, ordered=ordered)
        if worth is Stamp.ODD:
            self._note(
                f"ignored a {message.name}: its timestamp does not fit the autopilot's clock"
            )
        if worth is Stamp.REBOOTED:
            self._rebooted()
        return worth is not Stamp.ODD


def _anything(_: HeartbeatState) -> bool:
    return True
