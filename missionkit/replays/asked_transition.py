"""The transitions of a mission that lead from one state to another, failsafes too."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.placed_states import around
from missionkit.chart.model.state_contracts import fulfilled
from missionkit.chart.model.state_definitions import Failsafe, State, Transition
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.semantics.chart_compiler import compile_with
from missionkit.chart.semantics.compiled_chart import Chart, CompiledTransition
from missionkit.chart.semantics.guard_compiler import GuardCompiler
from missionkit.errors import UsageError, nearest


class AskedTransition(NamedTuple):
    """A transition that may lead from a state to another.

    Attributes:
        source: the state it was asked of; its own source may be around that.
        to: where it leads.
        owner: its own source, or the name of the failsafe.
        model: as the mission has it.
        state: its own source, None of a failsafe.
        compiled: as the chart has it.
        dwell: s, least time in its own source.
    """

    source: str
    to: str
    owner: str
    model: Transition | Failsafe
    state: State | None
    compiled: CompiledTransition
    dwell: float

    @property
    def title(self) -> str:
        """Where it leads, and when."""
        return f"{self.source} -> {self.to} ({self.compiled.text})"


class NamedChart(NamedTuple):
    """A chart, and what its record calls the guards of its mission."""

    mission: Mission  # with the default failsafes
    chart: Chart
    compiler: GuardCompiler

    def guard_name(self, guard: ex.Expression) -> str:
        """Return what the record calls a guard."""
        return self.compiler.name(guard)


def named_chart(mission: Mission, catalogue: Catalogue) -> NamedChart:
    """Compile a mission as for a flight."""
    whole = fulfilled(mission, catalogue)
    camera = None if whole.camera.use == "none" else whole.camera.model()
    compiler = GuardCompiler(dict(whole.guards), camera)
    chart = compile_with(compiler, whole, catalogue.flying(whole.vehicle.use))
    return NamedChart(whole, chart, compiler)


def transition_asked(text: str, states: Sequence[str]) -> tuple[str, str]:
    """Return the states of FROM->TO.

    Raises:
        UsageError: it is not of that form, or the mission has no such states.
    """
    source, arrow, to = (part.strip() for part in text.partition("->"))
    if not (source and arrow and to):
        raise UsageError(f"{text!r}: expected FROM->TO, as in {states[0]}->{states[-1]}")
    for name in (source, to):
        if name not in states:
            raise UsageError(f"{text!r}: unknown state {name!r}; {nearest(name, states)}")
    return source, to


def transitions_between(known: NamedChart, source: str, to: str) -> list[AskedTransition]:
    """Return what may lead from one state to another, failsafes first.

    Args:
        known: the chart.
        source: a state; what leads away from a state around it counts too.
        to: a state.

    Raises:
        UsageError: nothing does.
    """
    failsafes = [it._replace(source=source) for it in failsafes_of(known) if it.to == to]
    found = [*failsafes, *(it for it in ways_from(known, source, to) if to in it.compiled.to)]
    if not found:
        others = dict.fromkeys(
            name for it in ways_from(known, source) for name in it.compiled.to if name != source
        )
        raise UsageError(
            f"no transition or failsafe leads from {source!r} to {to!r}; from {source!r} they lead "
            f"to: {', '.join(others) or 'nowhere'}"
        )
    return found


def failsafes_of(known: NamedChart) -> Iterator[AskedTransition]:
    """Yield the failsafes that a mission has written; their source is any state that flies."""
    for model, compiled in zip(known.mission.failsafes, known.chart.failsafes, strict=False):
        yield AskedTransition("", model.to, model.name, model, None, compiled, 0.0)


def ways_from(known: NamedChart, source: str, to: str = "") -> Iterator[AskedTransition]:
    """Yield the transitions of a state and of those around it, the innermost first.

    Args:
        known: the chart.
        source: a state.
        to: what is asked for.
    """
    placed = known.mission.by_name()
    for name in (source, *around(placed, placed[source].parent)):
        state, compiled = placed[name].state, known.chart.states[name]
        for model, way in zip(state.transitions, compiled.transitions, strict=True):
            yield AskedTransition(source, to, name, model, state, way, compiled.dwell)
