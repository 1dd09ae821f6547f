"""Sends the actions of a mission as commands, each confirmed by telemetry.

One worker thread of its own: commands never wait for the event loop, and setpoints never wait for
commands. The newest wish counts; an older one that is still being carried out is abandoned.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import dataclass, field

from missionkit.messages import Action
from missionkit.vehicle.autopilot_dialect import CMD_ARM, CMD_SET_MODE, Dialect
from missionkit.vehicle.command.command_transaction import (
    Acks,
    Ask,
    CommandOutcome,
    Desk,
    Result,
    transact,
)
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.link.message_link import MessageLink
from missionkit.vehicle.telemetry.autopilot_state import AutopilotState

CMD_TAKE_OFF, CMD_LAND, CMD_RETURN = 22, 21, 20  # MAV_CMD
RETRY_AFTER = 1.0  # s (of the vehicle) until the same wish is carried out again
CONFIRM = 2.2  # s (of the vehicle): heartbeats come once a second, and one may be lost
OFFBOARD_MODE = "offboard"
Order = Callable[[str, float | None], bool]
Wish = tuple[str, float | None]  # an action's name or OFFBOARD_MODE, and a height (m)


@dataclass(slots=True)
class CommandReport:
    """Result of a requested action."""

    wish: Wish
    result: Result


@dataclass(slots=True)
class _Box:
    """Data shared by worker and loop."""

    wish: Wish | None = None
    running: Wish | None = None
    last: tuple[Wish, float] | None = None  # and when it may be requested again (s, wall)
    reports: list[CommandReport] = field(default_factory=list)
    ended: bool = False


class Commander:
    """Carries out wishes.

    Args:
        wire: the link.
        cache: the newest messages.
        dialect: of the autopilot.
        state: what telemetry says.
        order: called before a mode is requested, with the height of a take-off (m); says whether
            we may.
        pace: seconds of the vehicle in one of the wall.
    """

    def __init__(
        self,
        wire: MessageLink,
        cache: Cache,
        dialect: Dialect,
        state: AutopilotState,
        order: Order,
        pace: float = 1.0,
    ) -> None:
        self._wire = wire
        self._cache = cache
        self._dialect = dialect
        self._state = state
        self._order = order
        self._pace = pace
        self._acks = Acks(cache)
        self._box = _Box()
        self._news = threading.Condition()
        self._thread = threading.Thread(target=self._run, name="commands", daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def want(self, wish: Wish) -> bool:
        """Ask for something; return at once. One under way or just ended is not repeated."""
        now = self._cache.wall()
        with self._news:
            box = self._box
            if wish in (box.running, box.wish):
                return False
            if box.last is not None and box.last[0] == wish and now < box.last[1]:
                return False
            box.wish = wish
            self._news.notify()
            return True

    def drop(self) -> None:
        """Drop pending actions and abandon running ones: missionkit no longer commands."""
        with self._news:
            self._box.wish = None
            self._box.running = None

    @property
    def busy(self) -> bool:
        """Whether something is under way."""
        return self._box.running is not None or self._box.wish is not None

    def reports(self) -> list[CommandReport]:
        """Return what has ended since the last call."""
        with self._news:
            reports, self._box.reports = self._box.reports, []
        return reports

    def stop(self) -> None:
        """End the thread."""
        with self._news:
            self._box.ended = True
            self._box.wish = self._box.running = None
            self._news.notify()
        if self._thread.is_alive():
            self._thread.join(5.0)

    def carry_out(self, wish: Wish) -> Result:
        """Do what is wished for now, on the calling thread."""
        name, height = wish
        if name == Action.TAKE_OFF:
            return self._take_off(2.5 if height is None else height)
        steps: dict[str, Callable[[], Result]] = {
            Action.ARM: self._arm,
            Action.HOLD: self._hold,
            Action.LAND: self._land,
            Action.PRECISION_LAND: self._land_precisely,
            Action.RETURN: self._return,
            Action.DISARM: self._disarm,
            OFFBOARD_MODE: self._offboard,
        }
        return steps[name]()

    def _arm(self) -> Result:
        held = self._hold()  # arming in MISSION or RTL would start them
        if not held.good:
            return held
        return self._ask(Ask(CMD_ARM, (1.0, 0.0), lambda: self._state.armed is True, CONFIRM))

    def _take_off(self, height: float) -> Result:
        name = self._dialect.takeoff_param
        if name is not None and not self._wire.set_parameter(name, height):
            return Result(CommandOutcome.UNKNOWN, f"{name} could not be set")
        if not self._order("take_off" if self._dialect.early else self._dialect.hold_word, height):
            return Result(CommandOutcome.ABANDONED, "someone else has control")
        params: tuple[float | None, ...] = (
            (None,) * 7 if name is not None else (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, height)
        )
        return self._ask(
            Ask(CMD_TAKE_OFF, params, self._taken_off if self._dialect.early else None, CONFIRM)
        )

    def _taken_off(self) -> bool:
        """Say whether it climbs, or is up already; held on the ground it has yet to begin."""
        mode = self._state.mode
        return mode == "take_off" or (mode == "hold" and self._state.in_air is True)

    def _hold(self) -> Result:
        return self._mode(self._dialect.hold, self._dialect.hold_word)

    def _offboard(self) -> Result:
        return self._mode(self._dialect.offboard, self._dialect.offboard_word)

    def _land(self) -> Result:
        if self._dialect.land is not None:
            return self._mode(self._dialect.land, "land")
        if not self._order("land", None):
            return Result(CommandOutcome.ABANDONED, "someone else has control")
        return self._ask(Ask(CMD_LAND, (None,) * 7, self._in_mode("land"), CONFIRM))

    def _land_precisely(self) -> Result:
        return self._mode(self._dialect.precise, self._dialect.precise_word)

    def _return(self) -> Result:
        if not self._order("return", None):
            return Result(CommandOutcome.ABANDONED, "someone else has control")
        return self._ask(Ask(CMD_RETURN, (0.0,) * 7, self._in_mode("return"), CONFIRM))

    def _disarm(self) -> Result:
        return self._ask(Ask(CMD_ARM, (0.0, 0.0), lambda: self._state.armed is False, CONFIRM))

    def _mode(self, params: tuple[float, float, float], word: str) -> Result:
        if not self._order(word, None):
            return Result(CommandOutcome.ABANDONED, "someone else has control")
        return self._ask(Ask(CMD_SET_MODE, params, self._in_mode(word), CONFIRM))

    def _in_mode(self, *words: str) -> Callable[[], bool]:
        return lambda: self._state.mode in words

    def _ask(self, ask: Ask) -> Result:
        wish = self._box.running
        desk = Desk(self._wire, self._cache, self._acks, lambda: self._overtaken(wish), self._pace)
        return transact(desk, ask)

    def _overtaken(self, wish: Wish | None) -> bool:
        box = self._box
        return wish is not None and (box.running is not wish or box.wish is not None)

    def _run(self) -> None:
        while True:
            with self._news:
                self._news.wait_for(lambda: self._box.wish is not None or self._box.ended)
                if self._box.ended:
                    return
                wish = self._box.running = self._box.wish
                self._box.wish = None
            if wish is not None:
                self._end(wish, self._tried(wish))

    def _tried(self, wish: Wish) -> Result:
        try:
            return self.carry_out(wish)
        except RuntimeError as error:
            return Result(CommandOutcome.UNKNOWN, str(error))

    def _end(self, wish: Wish, result: Result) -> None:
        with self._news:
            box = self._box
            if box.running is wish:
                box.running = None
            box.last = (wish, self._cache.wall() + RETRY_AFTER / self._pace)
            box.reports.append(CommandReport(wish, result))
