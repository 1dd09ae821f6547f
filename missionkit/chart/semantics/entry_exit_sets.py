"""Which states a step exits and enters, by the algorithm of the SCXML recommendation.

Source: "State Chart XML (SCXML): State Machine Notation for Control Abstraction", W3C
Recommendation, 1 September 2015, appendix D; functions carry its names where they are its.
Names of states stand for states throughout; a configuration is a tuple in document order.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

from missionkit.chart.semantics.compiled_chart import (
    HISTORY,
    LEAVES,
    ROOT_STATE,
    Chart,
    CompiledState,
    CompiledTransition,
    Output,
    Shape,
)

MOST_MOVES = 4096  # moves remembered
Configuration = tuple[str, ...]
History = Mapping[str, Configuration]


class EnteredState(NamedTuple):
    """One state that is entered, and what that brings with it."""

    name: str
    blocks: tuple[tuple[Output, ...], ...]  # on entry, of default entry, of default history
    events: tuple[str, ...]  # done.state...


class Move(NamedTuple):
    """Effect of a set of transitions on a configuration."""

    exited: Configuration  # in exit order
    entries: tuple[EnteredState, ...]  # in entry order
    active: Configuration
    history: History  # what is remembered of this exit
    restored: frozenset[str]  # entered because a history led back
    ended: bool  # a final state of the whole chart was entered
    kept: Configuration  # neither exited nor entered
    says: bool  # there is something to do on the way
    gone: frozenset[int]  # numbers of the transitions whose timers end


def move(
    chart: Chart, active: Configuration, chosen: Sequence[CompiledTransition], history: History
) -> Move:
    """Return what taking `chosen` together does; worked out once where no history matters.

    Args:
        chart: compiled; results are kept in its `moves`.
        active: configuration before the step.
        chosen: transitions without conflicts.
        history: configuration each history state remembers.
    """
    if len(chosen) == 1 and chosen[0].number > 0:
        key: tuple[Any, ...] = (active, chosen[0].number)
    else:
        key = (active, tuple([(way.number, way.to, way.source) for way in chosen]))
    known: Move | None = chart.moves.get(key)
    if known is not None:
        return known
    walk = _Walk(chart, history)
    moved = walk.move(active, chosen)
    if not walk.used_history:
        if len(chart.moves) >= MOST_MOVES:
            chart.moves.clear()
        chart.moves[key] = moved
    return moved


def beginning(chart: Chart) -> Move:
    """Return the entry of the initial configuration."""
    return move(
        chart, (), (CompiledTransition(-1, chart.states[ROOT_STATE].initial.to, "start"),), {}
    )


def without_conflicts(
    chart: Chart, active: Configuration, enabled: Sequence[CompiledTransition], history: History
) -> list[CompiledTransition]:
    """Return the transitions that can be taken together: removeConflictingTransitions.

    Of two that exit a common state, the one from the inner source wins, else the earlier one.

    Args:
        chart: compiled.
        active: configuration before the step.
        enabled: in document order.
        history: configuration each history state remembers.
    """
    walk = _Walk(chart, history)
    kept: list[CompiledTransition] = []
    for one in enabled:
        mine, beaten, preempted = walk.exit_set(active, (one,)), [], False
        for other in kept:
            if mine.isdisjoint(walk.exit_set(active, (other,))):
                continue
            if other.source in chart.states[one.source].ancestors:
                beaten.append(other)
            else:
                preempted = True
                break
        if not preempted:
            kept = [other for other in kept if other not in beaten] + [one]
    return kept


def finished(chart: Chart, name: str, active: Iterable[str]) -> bool:
    """Say whether a state is in a final state: isInFinalState.

    Args:
        chart: compiled.
        name: of the state; one without children is not finished.
        active: names of the active states.
    """
    state = chart.states[name]
    if state.shape is Shape.COMPOUND:
        return any(
            chart.states[child].shape is Shape.FINAL and child in active for child in state.children
        )
    regions = [child for child in state.children if chart.states[child].shape not in HISTORY]
    parallel = state.shape is Shape.PARALLEL
    return parallel and all(finished(chart, child, active) for child in regions)


class _Walk:
    """One computation over the tree of states."""

    def __init__(self, chart: Chart, history: History) -> None:
        self.chart = chart
        self.states = chart.states
        self.history = history
        self.used_history = False
        self.entering: dict[str, None] = {}
        self.by_default: set[str] = set()
        self.default_history: dict[str, tuple[Output, ...]] = {}
        self.restored: set[str] = set()

    def move(self, active: Configuration, chosen: Sequence[CompiledTransition]) -> Move:
        exiting = self.exit_set(active, chosen)
        exited = tuple([name for name in reversed(active) if name in exiting])
        remembered = self._remembered(active, exited)
        if remembered:
            self.history = {**self.history, **remembered}
        for transition in chosen:
            self._enter_targets(transition)
        entered = sorted(self.entering, key=lambda name: self.states[name].order)
        kept = [name for name in active if name not in exiting]
        following = sorted({*kept, *entered}, key=lambda name: self.states[name].order)
        entries = self._entries(kept, entered)
        ended = any(entry.events == (f"done.state.{ROOT_STATE}",) for entry in entries)
        leaving = [self.states[name] for name in exited]
        speaking = any(state.exit for state in leaving) or any(way.outputs for way in chosen)
        return Move(
            exited=exited,
            entries=entries,
            active=tuple(following),
            history=remembered,
            restored=frozenset(self.restored),
            ended=ended,
            kept=tuple([name for name in kept if name not in self.entering]),
            says=speaking or any(entry.blocks or entry.events for entry in entries),
            gone=frozenset([way.number for state in leaving for way in state.transitions]),
        )

    def exit_set(self, active: Configuration, chosen: Iterable[CompiledTransition]) -> set[str]:
        """Return the active states inside the domain of any of the transitions."""
        exiting: set[str] = set()
        for transition in chosen:
            domain = self._domain(transition)
            if domain is not None:
                exiting.update(name for name in active if self._inside(name, domain))
        return exiting

    def _domain(self, transition: CompiledTransition) -> str | None:
        """Return the innermost state that the transition does not leave: getTransitionDomain."""
        targets = self._effective(transition.to)
        if not targets:
            return None
        source = transition.source
        if (
            transition.internal
            and self.states[source].shape is Shape.COMPOUND
            and all(self._inside(target, source) for target in targets)
        ):
            return source
        for name in self.states[source].ancestors:
            compound = name == ROOT_STATE or self.states[name].shape is Shape.COMPOUND
            if compound and all(self._inside(target, name) for target in targets):
                return name
        return ROOT_STATE

    def _inside(self, name: str, around: str) -> bool:
        return around in self.states[name].ancestors

    def _effective(self, targets: Iterable[str]) -> list[str]:
        """Return the targets with histories replaced: getEffectiveTargetStates."""
        found: list[str] = []
        for name in targets:
            state = self.states[name]
            if state.shape not in HISTORY:
                found.append(name)
                continue
            self.used_history = True
            recorded = self.history.get(name)
            found += self._effective(state.initial.to) if recorded is None else recorded
        return found

    def _remembered(self, active: Configuration, exited: Configuration) -> dict[str, Configuration]:
        remembered: dict[str, Configuration] = {}
        for name in exited:
            for child in self.states[name].children:
                shape = self.states[child].shape
                if shape is Shape.SHALLOW:
                    kept = [each for each in active if self.states[each].parent == name]
                elif shape is Shape.DEEP:
                    kept = [
                        each
                        for each in active
                        if self.states[each].shape in LEAVES and self._inside(each, name)
                    ]
                else:
                    continue
                remembered[child] = tuple(kept)
        return remembered

    def _enter_targets(self, transition: CompiledTransition) -> None:
        """Add what a transition enters: computeEntrySet."""
        domain = self._domain(transition)
        for target in transition.to:
            self._add_descendants(target)
        for target in self._effective(transition.to):
            self._add_ancestors(target, domain)

    def _add_descendants(self, name: str, *, back: bool = False) -> None:
        state = self.states[name]
        if state.shape in HISTORY:
            self._add_history(state)
            return
        self.entering[name] = None
        if back:
            self.restored.add(name)
        if state.shape is Shape.COMPOUND:
            self.by_default.add(name)
            self._add_all(state.initial.to, name, back=False)
        elif state.shape is Shape.PARALLEL:
            self._add_regions(state)

    def _add_history(self, state: CompiledState) -> None:
        self.used_history = True
        recorded = self.history.get(state.name)
        if recorded is None:
            self.default_history[state.parent] = state.initial.outputs
            self._add_all(state.initial.to, state.parent, back=False)
        else:
            self.restored.add(state.parent)
            self._add_all(recorded, state.parent, back=True)

    def _add_all(self, names: Iterable[str], around: str, *, back: bool) -> None:
        names = list(names)
        for name in names:
            self._add_descendants(name, back=back)
        for name in names:
            self._add_ancestors(name, around, back=back)

    def _add_ancestors(self, name: str, domain: str | None, *, back: bool = False) -> None:
        for around in self.states[name].ancestors:
            if around in (domain, ROOT_STATE):
                return
            self.entering[around] = None
            if back:
                self.restored.add(around)
            if self.states[around].shape is Shape.PARALLEL:
                self._add_regions(self.states[around])

    def _add_regions(self, state: CompiledState) -> None:
        for child in state.children:
            if self.states[child].shape in HISTORY:
                continue
            if not any(name == child or self._inside(name, child) for name in self.entering):
                self._add_descendants(child)

    def _entries(self, kept: Sequence[str], entered: Sequence[str]) -> tuple[EnteredState, ...]:
        entries: list[EnteredState] = []
        active = set(kept)
        for name in entered:
            active.add(name)
            state = self.states[name]
            start = state.initial.outputs if name in self.by_default else ()
            every = (state.entry, start, self.default_history.get(name, ()))
            blocks = tuple(filter(None, every))
            entries.append(EnteredState(name, blocks, self._done(state, active)))
        return tuple(entries)

    def _done(self, state: CompiledState, active: set[str]) -> tuple[str, ...]:
        if state.shape is not Shape.FINAL:
            return ()
        if state.parent == ROOT_STATE:
            return (f"done.state.{ROOT_STATE}",)
        around = self.states[self.states[state.parent].parent]
        events = [f"done.state.{state.parent}"]
        if around.shape is Shape.PARALLEL and finished(self.chart, around.name, active):
            events.append(f"done.state.{around.name}")
        return tuple(events)
