"""The ways out of the states, each with the situations in which it is ready."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cached_property
from typing import NamedTuple

from missionkit.chart.checks.guard_regions import GuardRegion, RegionReader
from missionkit.chart.checks.interval_boxes import intersection, remains
from missionkit.chart.checks.state_tree import StateTree
from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.state_definitions import Failsafe, Transition
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.errors import Place
from missionkit.guards.state_progress import TIME_IN_STATE
from missionkit.messages.region import Boxes, Interval, Quantity


class GuardedTransition(NamedTuple):
    """A transition, and when it is ready: at most, and at least."""

    source: str
    model: Transition
    place: Place
    dwell: float  # s that it waits for anyway
    clock: Quantity  # time in its source
    truth: GuardRegion  # of its guard alone
    may: Boxes  # with the time it needs in its source
    surely: Boxes
    soonest: float  # s after entry, at the earliest

    @property
    def written(self) -> bool:
        """Whether it is in the file, not added by a contract."""
        return bool(self.place.file)

    @property
    def eventless(self) -> bool:
        """Whether it waits for no event."""
        return self.model.event is None

    @property
    def timed(self) -> bool:
        """Whether time alone makes it ready, and it leaves its source."""
        model = self.model
        return self.eventless and model.when is None and bool(model.to) and not model.internal

    @property
    def label(self) -> str:
        """Name in messages: "'battery below (floor 0.2)' to 'home'"."""
        to = f" to {_quoted(self.model.targets)}" if self.model.to else ""
        return f"{self.reason}{to}"

    @property
    def reason(self) -> str:
        """Condition in messages: "'done' for 2 s"."""
        model = self.model
        parts = []
        if model.when is not None:
            held = f" for {model.for_:g} s" if model.for_ else ""
            parts.append(f"'{shortened(ex.text(model.when))}'{held}")
        if model.after is not None:
            parts.append(f"'after {model.after:g}'")
        if model.event is not None:
            parts.append(f"event {_quoted(model.event)}")
        return " and ".join(parts)


def _quoted(names: tuple[str, ...]) -> str:
    return " and ".join(f"'{name}'" for name in names)


def shortened(words: str) -> str:
    """Return a text short enough for a message."""
    return words if len(words) <= 80 else f"{words[:77]}..."


def circle_text(circle: Sequence[GuardedTransition]) -> str:
    """Return the labels of transitions that lead round in a circle: "both ... and ..."."""
    reported = " and ".join(way.label for way in circle[:3])
    more = f" and {len(circle) - 3} more" if len(circle) > 3 else ""
    return f"{'both ' if len(circle) == 2 else ''}{reported}{more}"


class Guarded(NamedTuple):
    """A failsafe, and when it is taken."""

    model: Failsafe
    may: Boxes
    surely: Boxes
    rank: int  # how safe it leads


class AnalysedChart:
    """A mission with all its ways, for the checks."""

    def __init__(self, mission: Mission, catalogue: Catalogue) -> None:
        self.mission = mission
        self.tree = StateTree(mission, catalogue)
        self.reader = RegionReader(self.tree)
        self.ways: dict[str, tuple[GuardedTransition, ...]] = {
            name: tuple(self._ways(name)) for name in self.tree.states
        }

    def _ways(self, name: str) -> Iterator[GuardedTransition]:
        state = self.tree.states[name].state
        dwell = self.mission.dwell if state.dwell is None else state.dwell
        alone = state.behavior is not None and not state.states
        clock = TIME_IN_STATE if alone else Quantity(f"time in {name}", unit="s", at_entry="zero")
        for model in state.transitions:
            patient = not (model.emergency or model.event)
            truth = self.reader.truth(model.when, name)
            waits = max(dwell if patient else 0.0, model.after or 0.0)
            in_time: Boxes = ({clock: Interval.at_least(waits)},) if waits else ({},)
            may = intersection(truth.may, in_time, sure=False)
            surely = intersection(truth.surely, in_time, sure=True)
            soonest = max(waits, _lasting(truth.may) + model.for_)
            yield GuardedTransition(
                name,
                model,
                model.place(),
                dwell if patient else 0.0,
                clock,
                truth,
                may,
                surely,
                soonest,
            )

    def out_of(self, name: str) -> Iterator[GuardedTransition]:
        """Yield the ways out of a state and of those around it, the inner ones first."""
        for each in (name, *self.tree.around(name)):
            yield from self.ways[each]

    @cached_property
    def failsafes(self) -> tuple[Guarded, ...]:
        """The mission's failsafes in the order of the file."""
        return tuple(map(self._guarded, self.mission.failsafes))

    def _guarded(self, model: Failsafe) -> Guarded:
        truth = self.reader.truth(model.when)
        may, surely = truth.may, truth.surely
        if model.unknown == "take":  # whenever it is not false
            beyond = remains(({},), truth.surely_not)
            may = ({},) if beyond is None else beyond
            surely = remains(({},), truth.may_not) or surely
        return Guarded(model, may, surely, self.tree.safe(model.to))


def _lasting(boxes: Boxes) -> float:
    """Return the least time (s) after entry that what begins at zero then needs."""
    least = math.inf
    for box in boxes:
        times = [
            span.low
            for quantity, span in box.items()
            if span is not None and quantity.at_entry == "zero" and quantity.unit == "s"
        ]
        least = min(least, max(times, default=0.0))
    return 0.0 if least == math.inf else max(least, 0.0)
