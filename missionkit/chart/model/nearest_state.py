"""Which state a contract's own transition leads to: the nearest that was made for it.

From the inside out: first the states beside the one that is left and inside those, then what is
around them, never out of an included file. Of several as far out, one that works on the same
target goes before one without a target, and that before one that works on another; then fewer
transitions between the two; then the order of the file.
"""

from __future__ import annotations

import math
from collections import defaultdict, deque
from collections.abc import Iterator
from typing import NamedTuple

from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.actions import Raise
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.placed_states import Placed, around
from missionkit.chart.model.state_definitions import Transition
from missionkit.chart.model.traversal import actions_of
from missionkit.states.shared_failsafes import HOVER, UNREACHABLE

OWN_EVENTS = ("done.state.", "error.")  # what the chart says to itself
SAME_TARGET, NO_TARGET, OTHER_TARGET = 0, 1, 2  # target of one state beside that of another
HOLD_KIND = "hold"


class FoundState(NamedTuple):
    """A state that a contract's transition may lead to."""

    name: str
    targets: int  # SAME_TARGET, NO_TARGET, OTHER_TARGET
    alone: bool  # no other state of its kind is as near


class Nearest:
    """The states of a mission as its file says it, and how near they are to each other.

    Args:
        mission: without what contracts add.
        flying: the kinds of state that fly.
    """

    def __init__(self, mission: Mission, flying: frozenset[str]) -> None:
        self.every = mission.by_name()
        self._order = {name: n for n, name in enumerate(self.every)}
        self._flying = flying
        self._guards = mission.guards
        self._raised = {act.event for act in actions_of(mission) if isinstance(act, Raise)}
        self._into: defaultdict[str, list[tuple[str, Transition | None]]] = defaultdict(list)
        self._beside: defaultdict[str, set[str]] = defaultdict(set)
        for failsafe in mission.failsafes:
            self._into[failsafe.to].append(("", None))
        for requirement in mission.requirements:
            if requirement.broken is not None:
                self._into[requirement.broken.to].append(("", None))
        for to in mission.initial.to:
            self._into[to].append(("", None))
        for placed in self.every.values():
            self._note(placed)

    def of(self, name: str, kind: str) -> FoundState | None:
        """Return where a contract of a state leads to find a kind of state; None: nowhere."""
        for scope in self._scopes(name):
            fit = [
                each
                for each in self._within(scope, kind)
                if each != name and not self.reserved(each)
            ]
            if fit:
                return self._best(name, fit)
        return None

    def anywhere(self, kind: str) -> tuple[str, ...]:
        """Return every state of a kind, wherever it is and whatever it was made for."""
        return tuple(self._within(None, kind))

    def reserved(self, name: str) -> bool:
        """Say whether the author made a state for something else than the contracts.

        That is a hover that is entered, but for nothing that is out of reach; a state that is
        entered in flight on an event from outside alone, such as an operator's; and one that
        holds until such an event comes.
        """
        placed = self.every[name]
        state, into = placed.state, self._into[name]
        if state.kind == HOVER and into and not any(self._unreachable(way) for _, way in into):
            return True
        if into and all(self.from_outside(way) and self._flies(source) for source, way in into):
            return True
        holds = state.behavior is not None and state.behavior.kind == HOLD_KIND
        out = [way for way in state.transitions if way.to is not None]
        return holds and bool(out) and all(map(self.from_outside, out))

    def from_outside(self, way: Transition | None) -> bool:
        """Say whether a transition waits for an event that the chart does not raise itself."""
        if way is None or way.event is None:
            return False
        return not any(word in self._raised or word.startswith(OWN_EVENTS) for word in way.event)

    def included(self, name: str) -> str | None:
        """Return the state that includes the file of a state; None: the mission's own file."""
        outer = name.rpartition("/")[0]
        return outer if outer in self.every else None

    def _note(self, placed: Placed) -> None:
        name, state, _ = placed
        for way in state.transitions:
            for to in way.targets:
                self._into[to].append((name, way))
                self._beside[name].add(to)
                self._beside[to].add(name)
        for start in (state.initial, state.default):
            for to in () if start is None else start.to:
                self._into[to].append((name, None))
        if state.invariant.exit is not None:
            self._into[state.invariant.exit].append((name, None))

    def _scopes(self, name: str) -> Iterator[str | None]:
        """Yield the states around a state, the innermost first, as far as its file goes."""
        last = self.included(name)
        for outer in around(self.every, self.every[name].parent):
            yield outer
            if outer == last:
                return
        yield None

    def _within(self, scope: str | None, kind: str) -> Iterator[str]:
        for name, state, parent in self.every.values():
            inside = scope is None or scope in around(self.every, parent)
            if inside and state.kind == kind:
                yield name

    def _best(self, name: str, fit: list[str]) -> FoundState:
        hops = self._hops(name)

        def rank(other: str) -> tuple[bool, int, float]:
            foreign = self.included(other) != self.included(name)
            return foreign, self._targets(name, other), hops.get(other, math.inf)

        best = min(fit, key=lambda other: (rank(other), self._order[other]))
        alike = sum(rank(other) == rank(best) for other in fit)
        return FoundState(best, self._targets(name, best), alike == 1)

    def _hops(self, name: str) -> dict[str, int]:
        """Return how many transitions lie between a state and others, in either direction."""
        found, waiting = {name: 0}, deque([name])
        while waiting:
            each = waiting.popleft()
            for other in sorted(self._beside[each] - found.keys(), key=self._order.__getitem__):
                found[other] = found[each] + 1
                waiting.append(other)
        return found

    def _targets(self, one: str, other: str) -> int:
        here, there = (self._works_on(name) for name in (one, other))
        if here & there:
            return SAME_TARGET
        return OTHER_TARGET if here and there else NO_TARGET

    def _works_on(self, name: str) -> frozenset[str]:
        behavior = self.every[name].state.behavior
        return frozenset() if behavior is None else frozenset(behavior.plugin.targets())

    def _flies(self, name: str) -> bool:
        return name != "" and self.every[name].state.kind in self._flying

    def _unreachable(self, way: Transition | None) -> bool:
        guards = [] if way is None or way.when is None else [way.when]
        parts = ex.opened(guards, self._guards)
        return any(isinstance(it, ex.Use) and it.kind == UNREACHABLE.use for it in parts)
