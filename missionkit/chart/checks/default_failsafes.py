"""Where the contracts of the kinds lead by themselves, if that may not be what was meant."""

from __future__ import annotations

from collections.abc import Iterator

from missionkit.chart.model.mission import Mission
from missionkit.chart.model.nearest_state import OTHER_TARGET, FoundState, Nearest
from missionkit.chart.model.state_contracts import due, nearest_in
from missionkit.chart.model.state_definitions import State
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.errors import Level, Problem
from missionkit.states.shared_failsafes import HOVER


def problems_of(mission: Mission, catalogue: Catalogue) -> Iterator[Problem]:
    """Yield each default failsafe or invariant that leads to a doubtful state, or nowhere.

    Args:
        mission: as its file says it, without what contracts add.
        catalogue: the kinds of state.
    """
    nearest = nearest_in(mission, catalogue)
    for name, state, _ in mission.walk():
        for what, kind in _led(state, nearest, catalogue):
            found = nearest.of(name, kind)
            wrong = _nowhere(name, kind, nearest) if found is None else _doubt(found, nearest)
            if wrong:
                yield Problem(
                    state.place("kind"),
                    f"state {name!r}: {what} {wrong}",
                    Level.WARNING,
                    "default-way",
                    f"add a transition from {name!r} to the state of kind {kind!r} that you mean",
                )


def _led(state: State, nearest: Nearest, catalogue: Catalogue) -> Iterator[tuple[str, str]]:
    """Yield what leads out of a state by contract, and to which kind."""
    for failsafe in due(state, nearest, catalogue):
        yield f"the default failsafe {failsafe.name!r}", failsafe.to_kind
    promised = catalogue.kinds[state.kind].invariant
    if promised is not None and state.invariant.exit is None:
        yield "its kind's invariant", promised.to_kind


def _nowhere(name: str, kind: str, nearest: Nearest) -> str:
    others = [other for other in nearest.anywhere(kind) if other != name]
    if kind == HOVER or not others:
        return ""
    why = (
        "is in another file"
        if nearest.included(name) is not None
        else "is reached only by an external event"
    )
    return f"leads nowhere: {others[0]!r}, of kind {kind!r}, {why}"


def _doubt(found: FoundState, nearest: Nearest) -> str:
    if found.targets == OTHER_TARGET:
        works = nearest.every[found.name].state.behavior
        targets = () if works is None else works.plugin.targets()
        return f"leads to {found.name!r}, which works on another target, {', '.join(targets)}"
    if not found.alone:
        return f"leads to {found.name!r}, the first in the file of several equally near"
    return ""
