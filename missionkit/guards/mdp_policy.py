"""The best policy of a Markov decision process, followed in flight."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Annotated, Any, ClassVar, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator
from typing_extensions import override

from missionkit.errors import nearest
from missionkit.guards.estimated_chain import MOST_STATES, EstimatedChain
from missionkit.guards.transition_entries import REST, SUM_ERROR
from missionkit.markov.decision_process import SWEEPS, Choice, MdpSolution, solve
from missionkit.messages import Estimate, Verdict
from missionkit.plugin import CompositeGuard, InFile
from missionkit.plugin_protocols import Inputs, NamedInput
from missionkit.units import Fraction, Number

Leads = Mapping[str, Fraction | str] | str
"""Next states and their probabilities, of which one may be `rest`, or the only next state."""
Costs = Number | Mapping[str, Number]


class MdpAction(BaseModel):
    """An action: where it leads from each state in which it can be taken, and what it costs."""

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", allow_inf_nan=False)

    leads: Mapping[str, Leads] = Field(default={}, description="state -> next states")
    learned: tuple[str, ...] = Field(
        default=(), description="states that it leaves as the file's chain does"
    )
    cost: Costs = Field(default=1.0, description="of taking it, for all states or each")
    per_second: Number = Field(default=0.0, description="cost of each second of a learned visit")

    def cost_in(self, state: str) -> float:
        """Return what it costs to take it in a state."""
        return self.cost.get(state, 0.0) if isinstance(self.cost, Mapping) else self.cost


class MdpPolicy(CompositeGuard):
    """Holds while an action is the best one in the current state of a Markov decision process.

    V(s) = min_a [c(s, a) + γ Σ P(s' | s, a) V(s')]: the least expected cost from a state on,
    solved when the mission is loaded. The value of the verdict is the expected cost of `action`
    here, the threshold the least of the other actions. Source: M. L. Puterman, "Markov decision
    processes", 1994.

    The current state is the first of `where` whose guard holds; without `where`, the first of
    `states` that is an active state of the chart. A state in which no action can be taken ends the
    process, at its `final` cost.
    """

    kind: ClassVar[str] = "mdp_policy"
    action: str = Field(description="action that the guard asks for")
    actions: Mapping[str, MdpAction] = Field(min_length=1, description="actions by name")
    states: tuple[str, ...] = Field(
        default=(), max_length=MOST_STATES, description="names of the process's states"
    )
    chain: Annotated[EstimatedChain | None, InFile(EstimatedChain)] = Field(
        default=None, description="file of a campaign's chain, whose states come first"
    )
    where: Mapping[str, str] = Field(default={}, description="state -> guard that says so")
    final: Mapping[str, Number] = Field(default={}, description="cost of ending in a state")
    discount: float = Field(default=1.0, gt=0, le=1, description="weight of costs a step later")

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if self.action not in self.actions:
            known = nearest(self.action, self.actions)
            raise ValueError(f"unknown action {self.action!r}; {known}")
        if len({*self.names}) != len(self.names):
            raise ValueError("a state is named twice")
        for name in self._mentioned():
            if name not in self.names:
                raise ValueError(f"unknown state {name!r}; {nearest(name, self.names)}")
        if self.solution is None:
            raise ValueError(
                f"no policy found in {SWEEPS} sweeps: from every state some choice of actions "
                "must end the process for certain, at finite cost; or use a 'discount' below 1"
            )
        return self

    @property
    def names(self) -> tuple[str, ...]:
        """All states, those of the chain first."""
        learned = () if self.chain is None else self.chain.states
        return (*learned, *self.states)

    def _mentioned(self) -> Iterator[str]:
        yield from (*self.where, *self.final)
        for action in self.actions.values():
            yield from (*action.leads, *action.learned)
            yield from () if isinstance(action.cost, float | int) else action.cost
            for leads in action.leads.values():
                yield from (leads,) if isinstance(leads, str) else leads

    @cached_property
    def solution(self) -> MdpSolution | None:
        """The best policy, None if there is none."""
        choices = [list(self._choices(state)) for state in self.names]
        return solve(choices, [self.final.get(it, 0.0) for it in self.names], self.discount)

    def _choices(self, state: str) -> Iterator[Choice]:
        for number, (name, action) in enumerate(self.actions.items()):
            if state in action.learned:
                yield self._learned(number, name, action, state)
            elif state in action.leads:
                leads = self._probabilities(f"{name} in {state}", action.leads[state])
                yield Choice(number, action.cost_in(state), leads)

    def _learned(self, number: int, name: str, action: MdpAction, state: str) -> Choice:
        chain = self.chain
        if chain is None or state not in chain.states or state in chain.endings:
            raise ValueError(
                f"action {name!r} cannot be learned in {state!r}: the chain says nothing of it"
            )
        row = chain.matrix[chain.states.index(state)]
        leads = {to: entry.number for to, entry in enumerate(row) if entry.number}
        cost = action.cost_in(state) + action.per_second * chain.dwell.get(state, 0.0)
        return Choice(number, cost, leads)

    def _probabilities(self, said: str, leads: Leads) -> dict[int, float]:
        at = {name: n for n, name in enumerate(self.names)}
        if isinstance(leads, str):
            return {at[leads]: 1.0}
        words = {to for to, p in leads.items() if isinstance(p, str)}
        if len(words) > 1 or any(leads[to] != REST for to in words):
            raise ValueError(f"{said}: expected numbers, of which one may be 'rest'")
        found = {at[to]: float(p) for to, p in leads.items() if not isinstance(p, str)}
        total = math.fsum(found.values())
        if total > 1.0 + SUM_ERROR or (not words and total < 1.0 - SUM_ERROR):
            raise ValueError(f"{said}: the probabilities add up to {total:.12g}, not to 1")
        return {**found, **{at[to]: max(0.0, 1.0 - total) for to in words}}

    @override
    def text(self) -> str:
        return f"{self.action} in {', '.join(self.chosen) or 'no state'}"

    @property
    def chosen(self) -> tuple[str, ...]:
        """The states in which `action` is the best."""
        solution = self.solution
        if solution is None:
            return ()
        wanted = list(self.actions).index(self.action)
        pairs = zip(self.names, solution.policy, strict=True)
        return tuple(state for state, best in pairs if best == wanted)

    @property
    def located(self) -> tuple[str, ...]:
        """The states in which the process can be, in the order in which they are looked for."""
        return tuple(self.where) or self.names

    @override
    def named_inputs(self) -> tuple[NamedInput, ...]:
        return tuple(NamedInput("guard", it, ("where", to)) for to, it in self.where.items())

    @override
    def check(self, memory: Any, seen: Estimate, inputs: Inputs) -> Verdict:
        chosen, doubt, answer = self.chosen, "", False
        for state in self.located:
            holds = self._is_in(state, inputs)
            if holds and not doubt:
                return self._answered(state)
            if holds is not False and state in chosen:
                answer = True
            if holds is None:
                doubt = doubt or f"whether it is in {state} is not known"
            if holds:
                break
        if answer:
            return Verdict.unknown(doubt)
        return Verdict(holds=False, why=doubt or "in none of the states of the process")

    def _is_in(self, state: str, inputs: Inputs) -> bool | None:
        if self.where:
            return inputs.answers[self.where[state]].holds
        return state in inputs.active

    def _answered(self, state: str) -> Verdict:
        """Return the verdict in a known state."""
        here = self._costs_in(state)
        if self.action not in here:
            return Verdict(holds=False, why=f"in {state}, where {self.action} cannot be chosen")
        others = [cost for name, cost in here.items() if name != self.action]
        costs = ", ".join(f"{name} {cost:.4g}" for name, cost in here.items())
        holds, why = state in self.chosen, f"in {state}: {costs}"
        if not others:
            return Verdict(holds, why)
        return Verdict(holds, why, here[self.action], min(others), min(others) - here[self.action])

    def _costs_in(self, state: str) -> dict[str, float]:
        """Return the expected cost of each action that can be taken in a state."""
        if self.solution is None:
            return {}
        names = list(self.actions)
        costs = self.solution.costs[self.names.index(state)]
        return {names[action]: cost for action, cost in costs.items()}
