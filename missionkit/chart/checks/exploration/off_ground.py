"""When the vehicle may be in the air, in the runs of a chart that disarms it."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass

from missionkit.chart.checks.guarded_transitions import AnalysedChart, GuardedTransition
from missionkit.chart.model.actions import Order
from missionkit.chart.model.traversal import actions_of
from missionkit.chart.semantics.configuration import SAFETY
from missionkit.guards.state_progress import DONE_QUANTITY
from missionkit.messages import Action
from missionkit.messages.region import ONLY_TRUE

STAYS_DOWN = frozenset(("hold", "land"))  # behaviours that never take off


@dataclass(frozen=True, slots=True)
class OffGround:
    """What takes the vehicle into the air and what shows that it is down; nothing if not asked."""

    lifting: frozenset[str] = frozenset()  # states whose behaviour may take off
    landing: frozenset[int] = frozenset()  # transitions that wait for a landing to be done
    watched: bool = False

    def after(
        self, active: Collection[str], taken: Iterable[int], *, started: bool, before: bool
    ) -> bool:
        """Say whether the vehicle may be in the air when a tick acts.

        Args:
            active: the states before the tick.
            taken: numbers of the transitions of the tick.
            started: the initial states were entered in an earlier tick.
            before: the vehicle may have been in the air before.
        """
        if not self.watched or not self.landing.isdisjoint(taken):
            return False
        return before or (started and not self.lifting.isdisjoint(active))


def off_ground(analysed: AnalysedChart, ways: Mapping[int, GuardedTransition]) -> OffGround:
    """Return what decides whether the vehicle may be in the air.

    Args:
        analysed: the chart.
        ways: its transitions by number.
    """
    acts = actions_of(analysed.mission)
    if not any(isinstance(act, Order) and act.action == Action.DISARM for act in acts):
        return OffGround()
    lifting = {
        name
        for name, (_, state, _) in analysed.tree.states.items()
        if state.behavior is not None and state.behavior.kind not in STAYS_DOWN
    }
    landing = {number for number, way in ways.items() if _shows_landing(analysed, way)}
    return OffGround(frozenset(lifting), frozenset(landing), watched=True)


def _shows_landing(analysed: AnalysedChart, way: GuardedTransition) -> bool:
    """Say whether a transition is taken only when the landing of its source is done."""
    boxes = way.truth.may
    done = all(box.get(DONE_QUANTITY) == ONLY_TRUE for box in boxes)
    return bool(boxes) and done and analysed.tree.safe(way.source) == SAFETY["land"]
