"""Decides which heartbeats are trusted: a single unexpected packet is not enough.

A change of mode or of arming that missionkit expects is trusted at once. Any other is
trusted once a second heartbeat in a row says the same; until then the old state counts.
The second one is requested, so that a pilot does not have to wait for it. What another kind of
vehicle says is ignored, unless it says so three times and nothing else is heard.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

from missionkit.vehicle.link.message_cache import Fields

ARMED = 0x80  # MAV_MODE_FLAG_SAFETY_ARMED
APART = 0.15  # s between two that agree: old ones overtaken on the way come closer together
STRANGERS = 3  # heartbeats in a row of another kind of vehicle
ALTERNATING = 3  # changes of kind and back: two vehicles
STEADY = 10  # heartbeats in a row of one kind: the other one has gone


class HeartbeatState(NamedTuple):
    """The relevant content of a heartbeat."""

    mode: int  # custom_mode
    armed: bool


Expected = Callable[[HeartbeatState], bool]


class Believed(NamedTuple):
    """Result of the check of a heartbeat."""

    fields: Fields | None  # to be passed on; None: it is ignored
    doubted: HeartbeatState | None = None  # its actual content, which is not trusted yet
    retracted: HeartbeatState | None = (
        None  # content of the previous one, which this one does not confirm
    )
    stranger: bool = False  # another kind of vehicle says so for the third time
    odd: bool = False  # the first one of another kind


def heartbeat_state(fields: Fields) -> HeartbeatState:
    """Return mode and arming of a heartbeat."""
    return HeartbeatState(int(fields["custom_mode"]), bool(int(fields["base_mode"]) & ARMED))


class HeartbeatCheck:
    """Keeps the trusted heartbeat, and the one still in doubt."""

    def __init__(self) -> None:
        self._fields: Fields | None = None  # last trusted
        self._doubted: HeartbeatState | None = None
        self._since = 0.0  # s, when that was first received
        self._strangers = 0
        self._alternated = 0
        self._steady = 0  # heartbeats in a row of the vehicle's own kind

    @property
    def contested(self) -> bool:
        """Whether vehicles of two kinds answer in turn."""
        return self._alternated >= ALTERNATING

    def hear(self, fields: Fields, expected: Expected, at: float) -> Believed:
        """Take a heartbeat in.

        Args:
            fields: what it says.
            expected: says whether that needs no second one.
            at: s, of the vehicle, when it came.
        """
        before = self._fields
        if before is None:
            return self._believe(fields)
        if _kind(fields) != _kind(before):
            self._strangers += 1
            return Believed(None, stranger=self._strangers == STRANGERS, odd=self._strangers == 1)
        self._steady = 0 if self._strangers else self._steady + 1
        if self._strangers:
            self._alternated += 1
        elif self._steady >= STEADY:
            self._alternated = 0
        self._strangers = 0
        now, doubted = heartbeat_state(fields), self._doubted
        if now == heartbeat_state(before) or expected(now):
            return self._believe(fields, _retracted(doubted, now))
        if now == doubted and at - self._since >= APART:
            return self._believe(fields)
        if now != doubted:
            self._since = at
        self._doubted = now
        return Believed(before, doubted=now)

    def _believe(self, fields: Fields, retracted: HeartbeatState | None = None) -> Believed:
        self._fields, self._doubted = fields, None
        return Believed(fields, retracted=retracted)


def _retracted(doubted: HeartbeatState | None, now: HeartbeatState) -> HeartbeatState | None:
    """Return what was doubted, if the next heartbeat speaks against it."""
    landed = doubted is not None and doubted.armed and not now.armed  # in that mode, perhaps
    return None if now == doubted or landed else doubted


def _kind(fields: Fields) -> tuple[int, int]:
    return int(fields.get("autopilot", 0)), int(fields.get("type", 0))
