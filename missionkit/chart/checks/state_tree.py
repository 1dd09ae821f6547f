"""The mission as the checks see it: its tree of states, who follows whom, what is flying."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property

from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.placed_states import Placed, around, firsts
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.semantics.configuration import SAFETY
from missionkit.errors import Place


class StateTree:
    """A mission with its contracts carried out, and questions about its shape."""

    def __init__(self, mission: Mission, catalogue: Catalogue) -> None:
        self.mission = mission
        self.catalogue = catalogue
        self.states: Mapping[str, Placed] = mission.by_name()
        self._around: dict[str, tuple[str, ...]] = {}
        self._entered: dict[str, frozenset[str]] = {}

    def around(self, name: str) -> tuple[str, ...]:
        """Return the states around a state, the innermost first."""
        if name not in self._around:
            self._around[name] = around(self.states, self.states[name].parent)
        return self._around[name]

    def together(self, one: str, other: str) -> bool:
        """Say whether two states can be active at the same time."""
        here, there = (one, *self.around(one)), (other, *self.around(other))
        if one in there or other in here:
            return True
        common = next((name for name in here if name in there), None)
        return common is not None and self.states[common].state.parallel

    def finals(self, name: str) -> bool:
        """Say whether a state can be done by the final states inside it."""
        state = self.states[name].state
        inner = [each for each in state.states if self.states[each].state.history is None]
        if state.parallel:
            return all(self.finals(each) for each in inner)
        return any(self.states[each].state.final for each in inner)

    def flying(self, name: str) -> bool:
        """Say whether a state, or one around it, is of a kind that flies."""
        return any(
            self.catalogue.kinds[self.states[each].state.kind].flying
            for each in (name, *self.around(name))
        )

    def safe(self, name: str) -> int:
        """Return 2 for landing, 1 for returning, 0 for the rest."""
        return SAFETY.get(self.states[name].state.kind, 0)

    @cached_property
    def leaves(self) -> tuple[str, ...]:
        """The states without states inside, histories left out."""
        return tuple(
            name
            for name, (_, state, _) in self.states.items()
            if not state.states and state.history is None
        )

    @cached_property
    def _firsts(self) -> Mapping[str, str]:
        return firsts(self.states)

    def of_kind(self, kind: str) -> str | None:
        """Return the first state of a kind."""
        return self._firsts.get(kind)

    def escape(self, name: str) -> str | None:
        """Return where a broken invariant of a state leads."""
        return self.states[name].state.invariant.exit

    def entered(self, name: str) -> frozenset[str]:
        """Return every state that is entered with one: inside it, around it, in other regions."""
        if name not in self._entered:
            self._entered[name] = frozenset(self._entering(name))
        return self._entered[name]

    def entered_from(self, source: str, to: str) -> frozenset[str]:
        """Return every state that a transition enters; those around both ends stay active."""
        beyond = self.around(to)
        for outer in self.around(source):
            if outer in beyond and not self.states[outer].state.parallel:
                return frozenset(name for name in self.entered(to) if outer in self.around(name))
        return self.entered(to)

    def _entering(self, name: str) -> set[str]:
        found: set[str] = set()
        waiting = [name]
        while waiting:
            each = waiting.pop()
            if each in found:
                continue
            found.add(each)
            waiting += self._inside(each)
            for outer in self.around(each):
                if outer in found:
                    break
                found.add(outer)
                if self.states[outer].state.parallel:
                    waiting += self.states[outer].state.states
        return found

    def _inside(self, name: str) -> list[str]:
        state = self.states[name].state
        if state.parallel:
            return list(state.states)
        start = state.initial or state.default
        return [] if start is None else list(start.to)

    def place(self, name: str) -> Place:
        """Return where a state is written; a state added by contracts is nowhere."""
        return self.states[name].state.place()

    def guards(self) -> Iterator[tuple[str, ex.Expression]]:
        """Yield each guard that is evaluated, and its state, empty for failsafes."""
        for failsafe in self.mission.failsafes:
            yield "", failsafe.when
        for name, state, _ in self.states.values():
            for way in state.transitions:
                if way.when is not None:
                    yield name, way.when
            if state.invariant.holds is not None:
                yield name, state.invariant.holds

    def compared(self) -> Iterator[ex.VariableGuard]:
        """Yield every comparison with a variable, those of requirements included."""
        waiting = [*self.mission.guards.values(), *(guard for _, guard in self.guards())]
        waiting += [each for it in self.mission.requirements for each in it.guards()]
        for guard in waiting:
            for part in ex.parts_of(guard):
                if isinstance(part, ex.VariableGuard):
                    yield part
