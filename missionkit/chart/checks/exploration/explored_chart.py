"""The chart that is explored: the engine's own, its leaf guards answered by an oracle."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from copy import copy
from dataclasses import replace
from functools import cached_property
from typing import Any

from typing_extensions import override

from missionkit.chart.checks.exploration.off_ground import off_ground
from missionkit.chart.checks.exploration.oracle import Oracle, OracleCompiler
from missionkit.chart.checks.guard_regions import is_endless
from missionkit.chart.checks.guarded_transitions import AnalysedChart, GuardedTransition
from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.actions import Assign
from missionkit.chart.model.nearest_state import OWN_EVENTS
from missionkit.chart.model.traversal import actions_of
from missionkit.chart.model.variables import Value, is_number
from missionkit.chart.semantics.chart_compiler import compile_with
from missionkit.chart.semantics.compiled_chart import (
    Chart,
    CompiledState,
    CompiledTransition,
    GuardContext,
    GuardFunction,
    Watch,
)
from missionkit.guards.state_progress import Done, Elapsed
from missionkit.messages import Estimate, Verdict
from missionkit.states.contract import StateKind

HOLDS, FAILS = Verdict(holds=True), Verdict(holds=False)
BEYOND_OTHERS = 1_000_000  # numbers of what leads away from broken requirements


class NotedMoves(dict[Any, Any]):
    """The memo of moves, which also notes which are looked up: the microsteps of a tick."""

    def __init__(self) -> None:
        super().__init__()
        self.noted: list[Any] = []

    @override
    def get(self, key: Any, default: Any = None) -> Any:
        """Note a microstep, and return its move if it is known."""
        self.noted.append(key)
        return super().get(key, default)


class ExploredChart:
    """A chart whose guards an oracle answers, and what its exploration needs to know."""

    def __init__(self, analysed: AnalysedChart) -> None:
        self.analysed = analysed
        self.tree = analysed.tree
        self.oracle = Oracle(analysed.reader.places)
        mission = analysed.mission
        assigned = {act.variable for act in actions_of(mission) if isinstance(act, Assign)}
        self.assigned = frozenset(assigned)
        constants = {
            name
            for name, each in mission.variables.items()
            if name not in assigned and isinstance(each.initial, str)
        }
        asker = OracleCompiler(dict(mission.guards), analysed.reader, self.oracle, constants)
        compiled = compile_with(asker, mission, self.tree.catalogue)
        self.moves = NotedMoves()
        states = {name: self._state(state) for name, state in compiled.states.items()}
        failsafes = (*self._requirements(compiled), *compiled.failsafes)
        self.chart: Chart = replace(
            compiled, states=states, failsafes=failsafes, watch=Watch(), moves=self.moves
        )
        self.ways: dict[int, GuardedTransition] = {
            compiled_way.number: way
            for name, ways in analysed.ways.items()
            for compiled_way, way in zip(states[name].transitions, ways, strict=True)
        }
        self.apart = False  # it is one region of several
        self.judges_itself = _judges_itself(analysed)
        self.off_ground = off_ground(analysed, self.ways)
        self.failsafes = {way.number: way.text for way in failsafes}
        _note_uses(asker, analysed)
        self.limits = {name: self._limits(state) for name, state in states.items()}
        self.most = _caps(analysed)

    def _requirements(self, compiled: Chart) -> Iterator[CompiledTransition]:
        """Yield where broken requirements lead; any may be broken at any time."""

        def ask(_: GuardContext) -> Verdict:
            return HOLDS if self.oracle.situation.pick(2) else FAILS

        for number, each in enumerate(compiled.watch.requirements, BEYOND_OTHERS):
            if each.to is not None:
                yield CompiledTransition(number, (each.to,), each.reason, ask=ask)

    def _state(self, state: CompiledState) -> CompiledState:
        """Return a state whose invariant is broken whenever the oracle says so."""
        kind: StateKind = state.kind
        if kind.invariant is not None:
            away = state.violated_to is not None
            check = self._invariant(state.name, state.tolerated)
            kept = replace(kind.invariant, check=check) if away else None
            kind = replace(kind, invariant=kept)
        promise = state.promise
        if promise is not None:
            promise = self._promise(promise, state)
        return replace(state, kind=kind, promise=promise)

    def _invariant(self, name: str, tolerated: float) -> Callable[[Estimate, str | None], Verdict]:
        def check(_: Estimate, __: str | None) -> Verdict:
            return FAILS if self._overdue(name, tolerated) else HOLDS

        return check

    def _promise(self, promise: GuardFunction, state: CompiledState) -> GuardFunction:
        def ask(question: GuardContext) -> Verdict:
            verdict = promise(question)
            if verdict.holds is not False or state.tolerated == 0.0:
                return verdict
            return verdict if self._overdue(state.name, state.tolerated) else HOLDS

        return ask

    def _overdue(self, name: str, tolerated: float) -> bool:
        situation = self.oracle.situation
        return situation.ages.get(name, math.inf) >= tolerated and situation.pick(2) == 1

    def _limits(self, state: CompiledState) -> tuple[float, ...]:
        """Return the ages (s) of a state at which one of its transitions becomes ready."""
        found = {
            max(state.dwell if way.patient else 0.0, way.after or 0.0) for way in state.transitions
        }
        if state.behavior is not None or not state.children:
            around = self.tree.around(state.name)
            near = {"", state.name, *around}
            if any(self.tree.states[each].state.parallel for each in around):
                near.update(name for name in self._elapsed if self._together(name, state.name))
            found.update(time for name in near for time in self._elapsed.get(name, ()))
        return tuple(sorted(found - {0.0}))

    def _together(self, one: str, other: str) -> bool:
        return not one or self.tree.together(one, other)

    @cached_property
    def _elapsed(self) -> dict[str, set[float]]:
        """The times (s) that guards of each state compare with the age of what commands."""
        found: dict[str, set[float]] = {}
        named = [("", guard) for guard in self.analysed.mission.guards.values()]
        for name, guard in (*named, *self.tree.guards()):
            for part in ex.parts_of(guard):
                if isinstance(part, ex.Use) and isinstance(part.plugin, Elapsed):
                    found.setdefault(name, set()).add(part.plugin.longer_than)
        return found

    def with_one(self, parallel: str, region: str) -> ExploredChart:
        """Return the chart with one of the regions of a parallel state alone."""
        other = copy(self)
        other.apart = True
        other.moves = NotedMoves()
        alone = replace(self.chart.states[parallel], children=(region,))
        states = {**self.chart.states, parallel: alone}
        other.chart = replace(self.chart, states=states, moves=other.moves, configurations={})
        return other

    def may_be_done(self, state: str) -> bool:
        """Say whether a state has a behaviour that finishes."""
        behavior = self.chart.states[state].behavior
        return behavior is not None and not is_endless(behavior)

    def from_outside(self, ways: Iterable[CompiledTransition]) -> Iterator[str]:
        """Yield each event that some transitions wait for and that may come from outside."""
        words = {word for way in ways for word in way.events}
        yield from sorted(word for word in words if not word.startswith(OWN_EVENTS))

    def capped(self, variables: Mapping[str, Value]) -> tuple[tuple[str, Value], ...]:
        """Return what of the variables decides anything, values that are all alike as one."""
        return tuple(
            (name, min(value, self.most[name]) if is_number(value) else value)
            for name, value in variables.items()
            if name in self.most
        )


def _judges_itself(analysed: AnalysedChart) -> bool:
    """Say whether an invariant or failsafe reads the chart: then it matters in which tick it acts.

    What reads the world alone may hold or not in the next tick, whatever happened in this one.
    """
    guards = [each.when for each in analysed.mission.failsafes]
    guards += [
        state.invariant.holds
        for _, state, _ in analysed.tree.states.values()
        if state.invariant.holds is not None
    ]
    return any(map(_of_chart, ex.opened(guards, analysed.mission.guards)))


def _of_chart(part: ex.Expression) -> bool:
    progress = isinstance(part, ex.Use) and isinstance(part.plugin, Elapsed | Done)
    return progress or isinstance(part, ex.VariableGuard | ex.In | ex.Finished)


def _note_uses(asker: OracleCompiler, analysed: AnalysedChart) -> None:
    for _, state, _ in analysed.tree.states.values():
        for way in state.transitions:
            if way.when is not None:
                asker.use(way.when, if_true=True)
        if state.invariant.holds is not None:
            asker.use(state.invariant.holds, if_true=False)
    for failsafe in analysed.mission.failsafes:
        asker.use(failsafe.when, if_true=failsafe.unknown == "ignore")
    asker.use_the_rest()


def _caps(analysed: AnalysedChart) -> dict[str, float]:
    """Return the variables that anything reads, each with a value from which on all are alike."""
    declared = analysed.mission.variables
    most = {name: math.inf if each.max is not None else -1.0 for name, each in declared.items()}
    read: set[str] = set()
    for guard in analysed.tree.compared():
        read.add(guard.name)
        if is_number(guard.value):
            most[guard.name] = max(most[guard.name], guard.value + 1.0)
    for act in actions_of(analysed.mission):
        if not isinstance(act, Assign):
            continue
        if act.operation == "copy":
            read.add(str(act.operand))
            most[str(act.operand)] = math.inf
        elif act.operation == "add" and is_number(act.operand) and act.operand < 0.0:
            most[act.variable] = math.inf
    return {name: most[name] for name in read}
