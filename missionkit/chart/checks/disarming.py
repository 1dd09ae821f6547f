"""Actions that disarm where the vehicle may be in the air."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from missionkit.chart.checks.exploration.concrete_flight import Run
from missionkit.chart.checks.exploration.concrete_run import Concrete
from missionkit.chart.checks.exploration.example_run import NOT_EXCLUDED, steps_text
from missionkit.chart.checks.exploration.exploration_result import Disarming, Exploration
from missionkit.chart.checks.exploration.explored_chart import ExploredChart
from missionkit.chart.model.actions import Act, Order
from missionkit.errors import Level, Place, Problem
from missionkit.messages import Action

Owner = tuple[str, str | int]  # entry, exit and a state; take and the number of a transition


class Disarms(NamedTuple):
    """An action that disarms, and where it stands."""

    place: Place
    where: str


def problems_of(chart: ExploredChart, explored: Exploration) -> Iterator[Problem]:
    """Yield each action that disarms in a tick in which the vehicle may be in the air."""
    known = dict(_disarms(chart)) if explored.disarming else {}
    reported: set[Place] = set()
    concrete = Concrete(chart, explored)
    for found in explored.disarming:
        for owner in _owners(found):
            if owner in known and known[owner].place not in reported:
                reported.add(known[owner].place)
                run = concrete.run(
                    {found.node.number: [found.step]},
                    lambda tried: Action.DISARM in tried.decision.orders,
                )
                yield _problem(chart, known[owner], run)


def _problem(chart: ExploredChart, disarms: Disarms, flown: Run | None) -> Problem:
    run = NOT_EXCLUDED if flown is None else f"; run: {steps_text(chart, flown.steps)}"
    return Problem(
        disarms.place,
        f"{disarms.where} disarms where the vehicle may be in the air; it is refused there{run}",
        Level.WARNING if flown is None else Level.ERROR,
        "disarms-in-flight",
        "disarm only on the way out of a state of kind land, {when: done}, or after it",
    )


def _owners(found: Disarming) -> Iterator[Owner]:
    for number in found.step.taken:
        yield "take", number
    for move in found.moves:
        yield from (("exit", name) for name in move.exited)
        yield from (("entry", entry.name) for entry in move.entries)


def _disarms(chart: ExploredChart) -> Iterator[tuple[Owner, Disarms]]:
    """Yield every action that disarms, by what carries it out."""
    for name, (_, state, _) in chart.tree.states.items():
        begins = () if state.initial is None else state.initial.do
        for word, acts in (("entry", (*state.entry, *begins)), ("exit", state.exit)):
            yield from _at((word, name), acts, f"state {name!r}: 'vehicle: disarm' at {word}")
    for number, way in chart.ways.items():
        where = f"state {way.source!r}: 'vehicle: disarm' of {way.label}"
        yield from _at(("take", number), way.model.do, where)
    models = {f"failsafe {each.name}": each for each in chart.analysed.mission.failsafes}
    for number, text in chart.failsafes.items():
        if text in models:
            where = f"failsafe {models[text].name!r}: 'vehicle: disarm'"
            yield from _at(("take", number), models[text].do, where)


def _at(owner: Owner, acts: Sequence[Act], where: str) -> Iterator[tuple[Owner, Disarms]]:
    for act in acts:
        if isinstance(act, Order) and act.action == Action.DISARM:
            yield owner, Disarms(act.place, where)
