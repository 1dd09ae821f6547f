"""State machine of control authority: missionkit, a pilot, or the autopilot itself.

    ground -> commanding <-> doubting        missionkit commands
    pilot, failsafe, rebooted, stranger      it has given way, until a person gives control back

A person does that with the key r or SIGUSR1 (`resume_control` of the vehicle), and the mission
hears `control_resumed`.

A mode counts as ours if missionkit requested it, or where the autopilot ends the request by
itself: HOLD at the height of a take-off, or on the ground after a landing. Anywhere else it is a
pilot's. A first heartbeat that says otherwise is only doubted: no mode is requested until the next
one confirms it or takes it back. A landing or return that was accepted, and that two heartbeats in
the air do not show afterwards, was overridden by a pilot. A landing of another's that is over
before a second heartbeat showed it is confirmed by the disarmed one.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import Any, NamedTuple

from transitions import Machine

from missionkit.behaviors.take_off import EARLY_END_HEIGHT, EARLY_END_SHARE
from missionkit.vehicle.autopilot_dialect import Dialect, word
from missionkit.vehicle.link.heartbeat_check import HeartbeatState, heartbeat_state
from missionkit.vehicle.link.message_cache import Message
from missionkit.vehicle.link.message_rates import REBOOTED
from missionkit.vehicle.telemetry.autopilot_state import UNKNOWN_WHEREABOUTS, Whereabouts

PILOT_TAKEOVER = "pilot_takeover"
FAILSAFE_TAKEOVER = "failsafe_takeover"  # it had not received us: the autopilot acted by itself
VEHICLE_CHANGED = "vehicle_changed"  # another kind of vehicle answers
CRITICAL = 5  # MAV_STATE: both autopilots say so while a failsafe of theirs is active
REFUGES = frozenset(("hold", "brake", "land", "return", "smart_return"))  # what failsafes choose
FOUND = frozenset(("hold", "offboard", "take_off", "land", "guided"))
"""Modes that a missionkit may have left behind; in any other one a pilot flies."""

LEADS_TO = {"land": frozenset((21, 176)), "return": frozenset((20, 176))}
"""MAV_CMD that ask for a mode which stays until it ends by itself, or a pilot chooses another."""

OVERRIDDEN = 2  # heartbeats that do not show such a mode

AT_HOME = 3.0  # m from home, where a return ends

MISSION_STATES = ("ground", "commanding", "doubting")
GIVEN_UP = ("pilot", "failsafe", "rebooted", "stranger")
AUTHORITY_TRANSITIONS: list[list[Any]] = [  # trigger, from, to
    ["ask", ["ground", "commanding"], "="],
    ["hear_ours", MISSION_STATES, "commanding"],
    ["hear_disarmed", MISSION_STATES, "ground"],
    ["hear_doubtful", MISSION_STATES, "doubting"],
    ["hear_pilot", [*MISSION_STATES, "failsafe", "rebooted"], "pilot"],
    ["hear_failsafe", MISSION_STATES, "failsafe"],
    ["hear_stranger", [*MISSION_STATES, "failsafe", "rebooted"], "stranger"],
    ["reboot_in_flight", [*MISSION_STATES, "failsafe"], "rebooted"],
    ["reboot_on_ground", MISSION_STATES, "ground"],
    ["give_back", GIVEN_UP, "commanding"],
]


class TakeoverEvidence(NamedTuple):
    """Evidence of a takeover in heartbeats."""

    mode: str = ""  # in which it flies, or flew until it was disarmed; "": none is to be judged
    critical: bool = False  # a failsafe of the autopilot chose that mode
    unheard: bool = False  # the autopilot may not have received us before it


NO_DOUBT = TakeoverEvidence()


def ends(order: str, height: float | None, mode: str, where: Whereabouts) -> bool:
    """Return whether the autopilot may have ended an order by itself, in `mode`, just there.

    Args:
        order: the requested mode.
        height: m, of a take-off.
        mode: that it is in now.
        where: the vehicle is.
    """
    if (order, mode) == ("take_off", "hold"):
        wanted = 0.0 if height is None else height - min(EARLY_END_HEIGHT, EARLY_END_SHARE * height)
        return where.height is not None and where.height >= wanted and not where.on_ground
    if order in {"land", "precision_land"} and mode == "hold":
        return where.on_ground is True
    if (order, mode) == ("precision_land", "land"):
        return True  # it lost the pad, or is at its end
    if order == "return" and mode in {"land", "hold"}:
        home = where.from_home is not None and where.from_home <= AT_HOME
        return where.on_ground is True or home
    return False


class ControlAuthority:
    """Detects that missionkit has lost control, until a person gives it back.

    Args:
        dialect: of the autopilot.
        let_go: called at once when control is given up, on the thread that brings the heartbeat.
        tell: takes an event for the mission.
        unheard: says, at a heartbeat, whether the autopilot may not have received us for a while.
        where: says where the vehicle is.
        note: takes a sentence for the record.
    """

    state: str
    trigger: Any  # of transitions, by name
    may_trigger: Any

    def __init__(
        self,
        dialect: Dialect,
        let_go: Callable[[], None],
        tell: Callable[[str], None],
        unheard: Callable[[], bool],
        where: Callable[[], Whereabouts] = lambda: UNKNOWN_WHEREABOUTS,
        note: Callable[[str], None] = lambda _: None,
    ) -> None:
        self._dialect = dialect
        self._let_go = let_go
        self._tell = tell
        self._unheard = unheard
        self._where = where
        self._note = note
        self._lock = threading.RLock()
        self._mode = ""  # reported last
        self._armed = False
        self._aim = ""  # mode we requested last; "": none yet
        self._height: float | None = None  # m, of the take-off we requested last
        self._doubt = NO_DOUBT  # of the unexpected heartbeats since the last trusted one
        self._accepted = False  # our last request, if long enough ago to show
        self._against = 0  # heartbeats since that show another mode in the air
        Machine(
            self,
            states=[*MISSION_STATES, *GIVEN_UP],
            transitions=AUTHORITY_TRANSITIONS,
            initial="ground",
            auto_transitions=False,
        )

    @property
    def ours(self) -> bool:
        """Whether we may command."""
        return self.state in MISSION_STATES

    @property
    def aim(self) -> str:
        """The mode we requested last."""
        return self._aim

    def fire(self, trigger: str) -> bool:
        """Take a transition of AUTHORITY_TRANSITIONS; say whether there is one from here."""
        return bool(self.may_trigger(trigger) and self.trigger(trigger))

    def order(self, mode: str, height: float | None = None) -> bool:
        """Note that we ask for a mode, a take-off to a height (m); say whether we may."""
        with self._lock:
            if not self.fire("ask"):
                return False
            self._aim, self._accepted, self._against = mode, False, 0
            self._height = self._height if height is None else height
            return True

    def expects(self, now: HeartbeatState) -> bool:
        """Say whether the content of a heartbeat is expected."""
        with self._lock:
            if now.armed != self._armed:
                return bool(self._aim) if now.armed else self._where().on_ground is True
            if not now.armed or not self.ours:
                return True
            return self._of_our_making(word(self._dialect, now.mode), self._where())

    def doubt(self, message: Message) -> None:
        """Note an unexpected heartbeat: command nothing until the next one."""
        now, unheard = heartbeat_state(message.fields), self._unheard()
        with self._lock:
            before = self._doubt._replace(unheard=unheard or self._doubt.unheard)
            mode = word(self._dialect, now.mode)
            critical = _critical(message) or (mode == before.mode and before.critical)
            self._doubt = before._replace(mode=mode, critical=critical) if now.armed else before
            self.fire("hear_doubtful")

    def accepted(self, command: int) -> None:
        """Note that heartbeats show from now on what a command (MAV_CMD) did."""
        with self._lock:
            self._accepted |= command in LEADS_TO.get(self._aim, ())

    @property
    def unsettled(self) -> bool:
        """Whether the last heartbeat has to be confirmed by another one."""
        return 0 < self._against < OVERRIDDEN

    def hear(self, message: Message) -> None:
        """Take in a trusted heartbeat."""
        if message.name != "HEARTBEAT":
            return
        now = heartbeat_state(message.fields)
        mode = word(self._dialect, now.mode)
        unheard = self._unheard()
        with self._lock:
            where = self._where() if now.armed else self._where()._replace(on_ground=True)
            flown = mode if now.armed else self._landed_by_another(mode, where)
            seen = TakeoverEvidence(flown, _critical(message), unheard=unheard)
            event, why = self._heard(seen, where)
            aim, self._mode, self._armed = self._aim, mode, now.armed
            if not now.armed or (not aim and self.ours):
                self._aim = mode if now.armed else ""
            self._doubt = NO_DOUBT
        if event:
            aim_text = f"it had requested {aim}" if aim else "it had requested none"
            self._give_way(
                event, f"mode {flown}, which missionkit did not choose ({aim_text}): {why}"
            )

    def rebooted(self, *, flying: bool) -> None:
        """Note that the autopilot has restarted; if it was flying, nothing is resumed."""
        with self._lock:
            if flying:
                self.fire("reboot_in_flight")
            else:
                self.fire("reboot_on_ground")
                self._aim, self._armed = "", False
        if flying:
            self._give_way(REBOOTED, "the autopilot has restarted in flight")
        else:
            self._tell(REBOOTED)

    def replaced(self, by: str) -> None:
        """Note that another kind of vehicle answers now."""
        with self._lock:
            taken = self.fire("hear_stranger")
        if taken:
            self._give_way(VEHICLE_CHANGED, f"the vehicle now says that it is a {by}")

    def overruled(self) -> None:
        """Note that the guardian has stopped the vehicle: nothing is resumed by itself."""
        with self._lock:
            taken = self.ours and self.fire("hear_failsafe")
        if taken:
            self._give_way(
                FAILSAFE_TAKEOVER, "missionkit went silent, and its guardian made the vehicle hold"
            )

    def resume(self) -> bool:
        """Command again, from whatever mode it is in; say whether control had been given up."""
        with self._lock:
            self._aim, self._doubt = self._mode if self._armed else "", NO_DOUBT
            return self.fire("give_back")

    def _heard(self, seen: TakeoverEvidence, where: Whereabouts) -> tuple[str, str]:
        """Make the transition of a heartbeat; return the event of a takeover, and why."""
        mode, doubt = seen.mode, self._doubt
        if not mode:
            self.fire("hear_disarmed")
            return "", ""
        if not self._overridden(mode, where) and self._of_our_making(mode, where):
            self.fire("hear_ours")
            return "", ""
        alarmed = mode in REFUGES and (seen.critical or (mode == doubt.mode and doubt.critical))
        if self.ours and (alarmed or seen.unheard or doubt.unheard):
            self.fire("hear_failsafe")
            cause = "its state is critical" if alarmed else "it had stopped receiving missionkit"
            return FAILSAFE_TAKEOVER, f"the autopilot's own failsafe, {cause}"
        if self.ours or (mode != self._mode and mode not in REFUGES):
            taken = self.fire("hear_pilot")
            return (PILOT_TAKEOVER, "a pilot commands") if taken else ("", "")
        return "", ""

    def _landed_by_another(self, mode: str, where: Whereabouts) -> str:
        """Return the mode in which another landed it, "" if none did, by a disarmed heartbeat.

        Either that mode had been doubted, or `mode` is one that lands by itself.
        """
        doubted = self._doubt.mode
        confirmed = doubted and (mode == doubted or ends(doubted, None, mode, where))
        flown = doubted if confirmed else mode if mode in LEADS_TO else ""
        return flown if self._armed and flown and not self._of_our_making(flown, where) else ""

    def _of_our_making(self, mode: str, where: Whereabouts) -> bool:
        if not self._aim:  # armed by another, or found flying
            return mode in FOUND
        if mode == self._aim:
            return True
        if mode == self._mode:
            broken_off = self._aim == "take_off" and mode == "hold" and where.on_ground is False
            return not broken_off or ends("take_off", self._height, mode, where)
        return any(ends(it, self._height, mode, where) for it in (self._aim, self._mode))

    def _overridden(self, mode: str, where: Whereabouts) -> bool:
        """Count a heartbeat; return whether another mode was chosen after ours was accepted."""
        if not self._accepted or mode == self._aim or ends(self._aim, self._height, mode, where):
            self._against = 0
        elif where.on_ground is False:
            self._against += 1
        return self._against >= OVERRIDDEN

    def _give_way(self, event: str, why: str) -> None:
        self._let_go()
        self._tell(event)
        self._note(f"control given up: {why}; a person must give it back")


def _critical(message: Message) -> bool:
    return int(message["system_status"]) == CRITICAL
