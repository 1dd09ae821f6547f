"""Who is at the helm, kept up to date on the thread that brings the heartbeats."""

from __future__ import annotations

import threading
from collections.abc import Callable

from missionkit.vehicle.authority import Authority, lost, ordered, reported, resumed
from missionkit.vehicle.cache import Message
from missionkit.vehicle.dialect import Dialect, word
from missionkit.vehicle.streams import REBOOTED

PILOT_TAKEOVER = "pilot_takeover"
FAILSAFE_TAKEOVER = "failsafe_takeover"  # it had not heard us: the autopilot acted by itself
_ARMED = 0x80  # MAV_MODE_FLAG_SAFETY_ARMED
_CRITICAL = 5  # MAV_STATE: both autopilots say so while a failsafe of theirs is active
_REFUGES = frozenset(("hold", "brake", "land", "return", "smart_return"))  # what failsafes choose


class Helm:
    """Notices within one heartbeat that somebody else commands, and keeps it so until asked.

    Args:
        dialect: of the autopilot.
        let_go: called at once when the helm is lost, on the thread that brings the heartbeat.
        tell: takes an event for the mission.
        unheard: says, at a heartbeat, whether the autopilot may not have heard us for a while.
    """

    def __init__(
        self,
        dialect: Dialect,
        let_go: Callable[[], None],
        tell: Callable[[str], None],
        unheard: Callable[[], bool],
    ) -> None:
        self._dialect = dialect
        self._let_go = let_go
        self._tell = tell
        self._unheard = unheard
        self._lock = threading.Lock()
        self._now = Authority()

    @property
    def ours(self) -> bool:
        """Whether we may command."""
        return self._now.ours

    @property
    def aim(self) -> str:
        """The mode we asked for last."""
        return self._now.aim

    def hear(self, message: Message) -> None:
        """Take a heartbeat in."""
        if message.name != "HEARTBEAT":
            return
        mode = word(self._dialect, int(message["custom_mode"]))
        armed = bool(int(message["base_mode"]) & _ARMED)
        with self._lock:
            before, self._now = self._now, reported(self._now, mode, armed=armed)
            taken = before.ours and not self._now.ours
        if taken:
            alarmed = int(message["system_status"]) == _CRITICAL and mode in _REFUGES
            by_itself = alarmed or self._unheard()
            self._give_way(FAILSAFE_TAKEOVER if by_itself else PILOT_TAKEOVER)

    def order(self, mode: str) -> bool:
        """Note that we ask for a mode; say whether we may."""
        with self._lock:
            if self._now.ours:
                self._now = ordered(self._now, mode)
            return self._now.ours

    def rebooted(self, *, flying: bool) -> None:
        """Note that the autopilot has started anew; if it was flying, nothing is resumed."""
        if flying:
            with self._lock:
                self._now = lost(self._now)
            self._give_way(REBOOTED)
        else:
            with self._lock:
                self._now = Authority(self._now.holder)
            self._tell(REBOOTED)

    def overruled(self) -> None:
        """Note that the guardian has stopped the vehicle: nothing is resumed by itself."""
        with self._lock:
            taken, self._now = self._now.ours, lost(self._now)
        if taken:
            self._give_way(FAILSAFE_TAKEOVER)

    def resume(self) -> None:
        """Command again, because somebody asked for it."""
        with self._lock:
            self._now = resumed(self._now)

    def _give_way(self, event: str) -> None:
        self._let_go()
        self._tell(event)
