"""State machine of the link: how far connecting has come, and whether the autopilot is heard.

    unconnected -> connecting -> identifying -> live <-> silent     any of them -> closed
                         `-----------'-> refused -> connecting

The autopilot is silent while its last heartbeat is older than `LINK_LOST_AFTER`; it may already be
heard again by the time anyone looks.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any

from transitions import Machine

from missionkit.vehicle.link.message_cache import Message

LINK_LOST_AFTER = 3.0  # s (of the vehicle) without a heartbeat

REACHED = ("live", "silent")
STATES = ("unconnected", "connecting", "identifying", *REACHED, "refused", "closed")
TRANSITIONS: list[list[Any]] = [  # trigger, from, to
    ["connect", ["unconnected", "refused"], "connecting"],
    ["answer", "connecting", "identifying"],  # an autopilot is there
    ["identify", "identifying", "live"],  # it is one that missionkit flies
    ["refuse", ["connecting", "identifying"], "refused"],  # no answer, or the wrong one
    ["lose", "live", "silent"],
    ["hear", "silent", "live"],
    ["close", [state for state in STATES if state != "closed"], "closed"],
]


class LinkLifecycle:
    """The state of one link. Any thread may ask or fire.

    Args:
        pace: seconds of the vehicle in one of the wall.
    """

    state: str
    trigger: Any  # of transitions, by name
    may_trigger: Any

    def __init__(self, pace: float = 1.0) -> None:
        self.gap = 0.0  # s (of the vehicle) between the last two heartbeats
        self._pace = pace
        self._heard: float | None = None  # s, wall, when the last heartbeat came
        self._returned: Callable[[], None] = lambda: None
        self._lock = threading.RLock()
        Machine(
            self,
            states=list(STATES),
            transitions=TRANSITIONS,
            initial="unconnected",
            auto_transitions=False,
        )

    def fire(self, trigger: str) -> bool:
        """Take a transition of TRANSITIONS; say whether there is one from here."""
        with self._lock:
            return bool(self.may_trigger(trigger) and self.trigger(trigger))

    def identified(self, returned: Callable[[], None]) -> None:
        """Note that missionkit flies what answers; `returned` is called after every silence."""
        with self._lock:
            self._returned, self.gap = returned, 0.0
            self.fire("identify")

    def hear(self, message: Message) -> None:
        """Watch one message, on the thread that brings it."""
        if message.name != "HEARTBEAT":
            return
        with self._lock:
            self.at(message.arrived)
            before = message.arrived if self._heard is None else self._heard
            self.gap = (message.arrived - before) * self._pace
            self._heard = message.arrived
            back = self.fire("hear")
        if back:
            self._returned()

    def at(self, now: float) -> str:
        """Return the state at wall time `now` (s)."""
        with self._lock:
            heard = now if self._heard is None else self._heard
            if (now - heard) * self._pace > LINK_LOST_AFTER:
                self.fire("lose")
            return self.state
