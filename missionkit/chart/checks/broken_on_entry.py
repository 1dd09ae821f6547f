"""Invariants that are broken already by what leads into their state."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from missionkit.chart.checks.counterexample_text import example
from missionkit.chart.checks.guarded_transitions import AnalysedChart, shortened
from missionkit.chart.checks.interval_boxes import covered, kept_at_entry
from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.actions import Assign
from missionkit.chart.model.traversal import actions_of
from missionkit.errors import Level, Place, Problem
from missionkit.messages.region import Boxes


class Entrance(NamedTuple):
    """A way into a state, and where the quantities then lie."""

    says: str
    place: Place
    boxes: Boxes


def problems_of(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield each way into a state whose own invariant cannot hold when it is taken."""
    promising = {
        name: state.invariant.holds
        for name, (_, state, _) in chart.tree.states.items()
        if state.invariant.holds is not None
    }
    if not promising:
        return
    changing = _changing(chart)
    for name, entrance in _entrances(chart):
        holds = promising.get(name)
        if holds is None:
            continue
        boxes = tuple(
            {quantity: span for quantity, span in box.items() if quantity.name not in changing}
            for box in kept_at_entry(entrance.boxes)
        )
        if boxes and covered(boxes, chart.reader.truth(holds, name).surely_not):
            yield _problem(chart, name, holds, entrance, boxes)


def _problem(
    chart: AnalysedChart, name: str, holds: ex.Expression, entrance: Entrance, boxes: Boxes
) -> Problem:
    state = chart.tree.states[name].state
    promised = chart.tree.catalogue.kinds[state.kind].invariant
    tolerated = 0.0 if promised is None else promised.tolerated
    to = state.invariant.exit
    when = f"after {tolerated:g} s unless that changes" if tolerated else "at once"
    leaves = "which is recorded at once" if to is None else f"so it leaves for {to!r} {when}"
    read = {quantity for box in boxes for quantity in box}
    shown = example(boxes) if read else ""
    return Problem(
        entrance.place,
        f"{entrance.says} enters {name!r} where its invariant "
        f"'{shortened(ex.text(holds))}' is broken"
        f"{f', at {shown}' if shown else ''}, {leaves}",
        Level.WARNING if to is None or tolerated else Level.ERROR,
        "broken-on-entry",
        f"let the invariant of {name!r} hold where it is entered",
    )


def _entrances(chart: AnalysedChart) -> Iterator[tuple[str, Entrance]]:
    for source, ways in chart.ways.items():
        for way in ways:
            place = way.place if way.model.when is None else way.model.place("when")
            says = f"state {source!r}: {way.reason}"
            for to in way.model.targets:
                for name in sorted(chart.tree.entered_from(source, to)):
                    if way.written and way.may:
                        yield name, Entrance(says, place, way.truth.may)
    for failsafe in chart.failsafes:
        model = failsafe.model
        for name in sorted(chart.tree.entered(model.to)):
            says = f"failsafe {model.name!r}"
            yield name, Entrance(says, model.place("when"), failsafe.may)


def _changing(chart: AnalysedChart) -> set[str]:
    """Return the names of quantities that taking a transition may change."""
    assigned = {act.variable for act in actions_of(chart.mission) if isinstance(act, Assign)}
    return {*assigned, *(f"in {name}" for name in chart.tree.states)}
