"""Takes what pilots at the page want, carries it out, and says how far it has come.

An action is taken by an event to the chart or a request of the operator, both at the next tick. It
is refused if it is not offered now, came before, or is older than a second.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from missionkit.chart.semantics.compiled_chart import Chart
from missionkit.engine.flight_loop import Operator
from missionkit.messages import CONTINUE, PAUSE, OperatorAction, OperatorReport, Record
from missionkit.page.live.offered_actions import Offer

OLDEST = 1.0  # s, from the press to its arrival here
UNHEARD = 1.0  # s of the mission after which an event that changed nothing is said to have
SHOWN = 5
REMEMBERED = 10_000  # ids, none of which is taken again
AUTOPILOT_MODES = {"land": ("land",), "return": ("return", "rtl")}


@dataclass
class TakenAction:
    """One action on its way."""

    id: str
    action: str
    event: str | None
    who: str
    stage: str
    tick: int | None = None
    at: float = 0.0  # s, mission time when it was taken
    says: str = ""

    def as_value(self) -> dict[str, Any]:
        """Return it for JSON."""
        shown = ("id", "action", "event", "who", "stage", "tick", "says")
        return {key: getattr(self, key) for key in shown}


@dataclass
class ActionDesk:
    """The actions of one flight.

    Args:
        chart: that is flown.
        operator: carries them out.
        clock: s, of the wall.
        give_back: gives control back after a takeover; None: nobody can take over.
    """

    chart: Chart
    operator: Operator
    clock: Callable[[], float]
    give_back: Callable[[], None] | None = None
    offers: tuple[Offer, ...] = ()
    recent: list[TakenAction] = field(default_factory=list)
    _known: dict[str, None] = field(default_factory=dict)
    _said: list[OperatorAction] = field(default_factory=list)
    _alive_at: float | None = None

    def report(self) -> OperatorReport:
        """Return what the next tick knows of the pilot."""
        said, self._said = tuple(self._said), []
        silent = None if self._alive_at is None else max(0.0, self.clock() - self._alive_at)
        return OperatorReport(silent, said)

    def heard(self, message: Mapping[str, Any], tick: int, now: float) -> None:
        """Take a message of the page's server.

        Args:
            message: what a pilot wants, or a sign of life.
            tick: number of the tick that has just ended.
            now: s, its mission time.
        """
        if message["kind"] == "alive":
            self._alive_at = self.clock()
        elif message["kind"] == "pilot":
            who, where = str(message["who"]), str(message["address"])
            self._said.append(OperatorAction(str(message["what"]), "", who, where))
        elif message["kind"] == "action":
            self._act(message, tick, now)

    def _act(self, message: Mapping[str, Any], tick: int, now: float) -> None:
        wanted = Offer(str(message["action"]), message.get("event"))
        taken = TakenAction(
            str(message["id"]),
            wanted.action,
            wanted.event,
            str(message["who"]),
            "taken",
            tick + 1,
            now,
        )
        age = float(message["age"]) + self.clock() - float(message["received"])
        refused = self._refused(taken, wanted, age)
        self._known[taken.id] = None
        if len(self._known) > REMEMBERED:
            del self._known[next(iter(self._known))]
        if refused:
            taken.stage, taken.tick, taken.says = "refused", None, refused
        else:
            self._said.append(
                OperatorAction(
                    wanted.action, wanted.event or "", taken.who, str(message["address"])
                )
            )
            self._carry_out(wanted)
        self.recent = [*self.recent, taken][-SHOWN:]

    def _refused(self, taken: TakenAction, wanted: Offer, age: float) -> str:
        """Say why an action is not taken; "" if it is."""
        if taken.id in self._known:
            return "this was sent before: press again"
        if age > OLDEST:
            return f"it arrived {age:.1f} s after the press, later than {OLDEST:g} s: press again"
        if not any(it.action == wanted.action and it.event == wanted.event for it in self.offers):
            what = f"{wanted.action} {wanted.event or ''}".rstrip()
            return f"{what} is not possible now"
        return ""

    def _carry_out(self, wanted: Offer) -> None:
        deeds: dict[str, Callable[[], None]] = {
            "hold": lambda: self.operator.send(PAUSE),
            "continue": lambda: self.operator.send(CONTINUE),
            "return": self.operator.home,
            "land": self.operator.land,
            "event": lambda: self.operator.send(str(wanted.event)),
            "give_back": self.give_back or (lambda: None),
        }
        deeds[wanted.action]()

    def follow(
        self, record: Record, fired: Iterable[Mapping[str, Any]], *, in_control: bool
    ) -> None:
        """See how far the actions have come.

        Args:
            record: of the tick.
            fired: its transitions, as the page shows them.
            in_control: whether missionkit commands.
        """
        reasons = [str(it["reason"]) for it in fired]
        for it in self.recent:
            if it.stage not in {"taken", "acknowledged"} or record.now <= it.at:
                continue
            if self._observed(it, record, reasons, in_control=in_control):
                it.stage, it.says = "observed", ""
            elif self._acknowledged(it, record):
                it.stage = "acknowledged"
            elif it.action == "event" and record.now - it.at > UNHEARD and not it.says:
                it.says = "the chart heard it, and no transition was taken"

    def _observed(
        self, it: TakenAction, record: Record, reasons: list[str], *, in_control: bool
    ) -> bool:
        kinds = {self.chart.states[name].kind.name for name in record.active}
        seen: dict[str, Callable[[], bool]] = {
            "hold": lambda: record.paused,
            "continue": lambda: not record.paused,
            "return": lambda: "return" in kinds,
            "land": lambda: "land" in kinds,
            "event": lambda: any(f"on {it.event}" in reason for reason in reasons),
            "give_back": lambda: in_control,
        }
        return seen[it.action]()

    def _acknowledged(self, it: TakenAction, record: Record) -> bool:
        status = record.estimate.status
        modes = AUTOPILOT_MODES.get(it.action, ())
        return it.stage == "taken" and status is not None and status.mode in modes
