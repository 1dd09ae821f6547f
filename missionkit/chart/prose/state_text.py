"""One state of a mission in plain sentences."""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from missionkit.chart.model.guard_expressions import use_text
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.placed_states import Placed
from missionkit.chart.model.state_definitions import GROUP_KIND, State, Transition
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.prose.incoming_references import Clauses
from missionkit.chart.prose.phrases import OWN_DONE, actions, guard, listed, reason
from missionkit.messages import CameraModel
from missionkit.plugin import Behavior
from missionkit.plugin_containment import is_foreign

DEMANDS = {  # what the formulas of the kinds' invariants say
    "gps_target ≠ ∅": "the position of its target is known",
    "visual_target ≠ ∅ ∧ t - t_seen ≤ 0.5 s": "its marker was seen within the last 0.5 s",
    "‖e_p‖ ≤ ε_pos ∧ |e_ψ| ≤ ε_yaw": "it is within 0.1 m and 5 degrees of its goal",
}


class Sentences(NamedTuple):
    """One paragraph: how deep it stands, whether it is an item of a list or begins a topic."""

    text: str
    depth: int = 1
    item: bool = False
    topic: bool = False


def topic(text: str, depth: int = 0) -> Sentences:
    """Return a heading."""
    return Sentences(text, depth, topic=True)


def sentence(text: str, depth: int = 1) -> Sentences:
    """Return an ordinary paragraph."""
    return Sentences(text, depth)


def item(text: str, depth: int = 1) -> Sentences:
    """Return an item of a list."""
    return Sentences(text, depth, item=True)


@dataclass(frozen=True)
class ExplainedChart:
    """A mission as its file says it, and with what the contracts of its kinds add."""

    written: Mission
    full: Mission
    catalogue: Catalogue
    entrances: Clauses

    @cached_property
    def own(self) -> dict[str, Placed]:
        """The states of the file."""
        return self.written.by_name()

    @cached_property
    def added(self) -> set[str]:
        """The states that no file says."""
        return set(self.full.by_name()) - set(self.own)

    def flies(self, placed: Placed) -> bool:
        """Say whether failsafes act in a state."""
        return self.catalogue.kinds[placed.state.kind].flying


def state_sentences(chart: ExplainedChart, placed: Placed, depth: int) -> Iterator[Sentences]:
    """Yield what a state is, what it does, what must hold in it, and how it is left.

    Args:
        chart: of the whole mission, with the names of states and failsafes added by defaults.
        placed: the state and its parent.
        depth: of the heading; everything below it is one deeper.
    """
    name, state, _ = placed
    yield topic(f"{name}, {_nature(chart, placed)}", depth)
    sentences = [
        *([_full_stop(state.summary)] if state.summary and name not in chart.added else []),
        *_deeds(state, chart.written.camera.model()),
        *_demands(chart, state),
        *_entered(chart, placed),
        *_remaining(chart, placed),
    ]
    if sentences:
        yield sentence(" ".join(sentences), depth + 1)
    yield from _ways(chart, placed, depth + 1)


def _nature(chart: ExplainedChart, placed: Placed) -> str:
    name, state, parent = placed
    if name in chart.added:
        return f"of kind {state.kind}, added: default failsafes lead to it"
    if state.history is not None:
        return f"a {state.history} history of {parent}"
    if state.final:
        return "a final state" if parent is None else f"a final state of {parent}"
    if state.states:
        return "a parallel state" if state.parallel else "a state with states inside"
    if state.kind == GROUP_KIND:
        return "a state that commands nothing"
    summary = chart.catalogue.kinds[state.kind].summary.rstrip(".")
    return f"of kind {state.kind}: {summary[:1].lower()}{summary[1:]}"


def _deeds(state: State, camera: CameraModel) -> Iterator[str]:
    """Say what a state does and what is inside."""
    if state.behavior is not None:
        manual = (inspect.getdoc(type(state.behavior.plugin)) or "").partition("\n")[0]
        manual = manual.rstrip(".")
        meaning = f": {manual[:1].lower()}{manual[1:]}" if manual else ""
        given = state.behavior.place != state.place("kind")
        by_kind = "" if given else ", as for every state of this kind"
        yield f"Its behaviour is {use_text(state.behavior)}{by_kind}{meaning}."
        plugin = state.behavior.plugin
        if isinstance(plugin, Behavior) and not is_foreign(plugin):
            says = plugin.explained(camera)
            yield from [f"That is {says}."] if says else []
    if state.states:
        yield _inside(state)
    if state.final:
        yield "The enclosing state is done once it is entered."
    if state.entry:
        yield f"On entry the chart {actions(state.entry)}."
    if state.exit:
        yield f"On exit the chart {actions(state.exit)}."


def _inside(state: State) -> str:
    inner = listed(state.states)
    if state.parallel:
        return f"Inside it are {inner}, all active together."
    first = listed(state.initial.to) if state.initial is not None else ""
    do = (
        f", when the chart {actions(state.initial.do)}"
        if state.initial and state.initial.do
        else ""
    )
    return f"Inside it are {inner}, one of them active at a time; it begins in {first}{do}."


def _demands(chart: ExplainedChart, state: State) -> Iterator[str]:
    """Describe what must hold in a state, by its kind and its own invariant."""
    due = chart.catalogue.kinds[state.kind].invariant
    if due is not None:
        to = state.invariant.exit
        leaves = "that is recorded" if to is None else f"it leaves for {to}"
        says = DEMANDS.get(due.says, due.says)
        yield f"Its kind requires that {says}; broken for {due.tolerated:g} s, {leaves}."
    own = state.invariant
    if own.holds is not None:
        away = f"; if not, it leaves for {own.exit}" if own.exit else "; if not, that is recorded"
        yield f"It requires that {guard(own.holds)}{away}."


def _entered(chart: ExplainedChart, placed: Placed) -> Iterator[str]:
    ways = chart.entrances.get(placed.name, [])
    if ways and placed.state.history is None:
        yield f"It is entered {listed(ways)}."


def _remaining(chart: ExplainedChart, placed: Placed) -> Iterator[str]:
    """Say how long a state may last, and what it is left by if nothing of its own leads out."""
    _, state, parent = placed
    if state.history is not None:
        which = {
            "shallow": f"the state directly inside {parent} that was",
            "deep": f"the innermost states of {parent} that were",
        }[state.history]
        first = listed(state.default.to) if state.default is not None else ""
        yield (f"It leads to {which} active last; before {parent} was ever left, to {first}.")
        return
    if state.dwell is not None:
        yield f"It is kept for {state.dwell:g} s at least, instead of the mission's dwell."
    if state.stays:
        yield "It may last forever, on purpose."
    if not state.transitions and not state.final:
        yield _without_ways(chart, placed)


def _without_ways(chart: ExplainedChart, placed: Placed) -> str:
    _, state, parent = placed
    if state.kind == "land":
        return "The mission ends here, on the ground."
    if state.states:
        return "It has no transitions of its own."
    around = [] if parent is None else [f"transitions out of {parent}"]
    flies = chart.flies(placed) and bool(chart.written.failsafes)
    return (
        f"It is left only by {listed([*around, *(['failsafes'] if flies else []), 'the pilot'])}."
    )


def _ways(chart: ExplainedChart, placed: Placed, depth: int) -> Iterator[Sentences]:
    """Yield the transitions of a state, in the order in which they are tried."""
    name, state, _ = placed
    if not state.transitions:
        return
    inner = (
        ", whatever is active inside it, unless a way out of that is ready" if state.states else ""
    )
    first = " by the first of these that is ready" if len(state.transitions) > 1 else ""
    inside = inner if state.states else ""
    yield sentence(f"It is left{first}{inside}:", depth)
    own = len(chart.own[name].state.transitions) if name in chart.own else 0
    for at, way in enumerate(state.transitions):
        by_contract = at >= own and name not in chart.added
        yield item(_way(way, _done(state), state.kind if by_contract else ""), depth)


def _done(state: State) -> str:
    """Say what `done` means in a state."""
    if not state.states:
        return OWN_DONE
    return "all its regions are done" if state.parallel else "a final state inside it is active"


def _way(way: Transition, done: str, added_by: str) -> str:
    to = f"to {listed(way.targets)} " if way.targets else "not at all, only an action: "
    do = f"; the chart {actions(way.do)} on the way" if way.do else ""
    notes = [
        *(["without leaving the enclosing state"] if way.internal else []),
        *(["does not wait for the dwell"] if way.emergency else []),
        *([f"added: default failsafe {way.name} of kind {added_by}"] if added_by else []),
    ]
    noted = f" ({'; '.join(notes)})" if notes else ""
    return f"{to}{reason(way, done)}{do}{noted}."


def _full_stop(summary: str) -> str:
    return summary if summary.endswith((".", "!", "?")) else f"{summary}."
