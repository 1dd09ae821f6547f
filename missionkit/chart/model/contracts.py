"""Carrying out the contracts of the state kinds on a mission.

A default failsafe becomes an ordinary transition, at the end of its state's list, unless the
state has a transition there already that waits for more than `done`, or the mission has no such
state.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from missionkit.behaviors.hold import Hold
from missionkit.chart.catalogue import Catalogue
from missionkit.chart.model import expressions as ex
from missionkit.chart.model.mission import Mission, Placed, State, Transition, firsts
from missionkit.errors import Place, Problem
from missionkit.states.common import HOVER
from missionkit.states.contract import Failsafe

NOWHERE = Place("", 0, 0)
HOVER_FOR = 20.0  # s before a vehicle whose goal is out of reach goes home
States = Mapping[str, Placed]
Firsts = Mapping[str, str]  # kind -> the first state of it


def fulfilled(mission: Mission, catalogue: Catalogue) -> Mission:
    """Return the mission with the default failsafes written out."""
    if _needs_hover(mission, catalogue):
        mission = _with_hover(mission)
    every = mission.by_name()
    by_kind = firsts(every)
    states = {
        name: _with_defaults(state, every, by_kind, catalogue)
        for name, state in mission.states.items()
    }
    return mission.model_copy(update={"states": states})


def _with_defaults(state: State, every: States, by_kind: Firsts, catalogue: Catalogue) -> State:
    inner = {
        name: _with_defaults(inside, every, by_kind, catalogue)
        for name, inside in state.states.items()
    }
    transitions = state.transitions + _defaults(state, every, by_kind, catalogue)
    return state.model_copy(update={"states": inner, "transitions": transitions})


def _defaults(
    state: State, every: States, by_kind: Firsts, catalogue: Catalogue
) -> tuple[Transition, ...]:
    have = {
        every[to].state.kind
        for transition in state.transitions
        if not _plan_only(transition)
        for to in transition.targets
    }
    targets = () if state.behavior is None else state.behavior.plugin.targets()
    return tuple(
        _transition(failsafe, by_kind[failsafe.to_kind], targets, catalogue)
        for failsafe in catalogue.kinds[state.kind].failsafes
        if failsafe.to_kind not in have
        and failsafe.to_kind in by_kind
        and (targets or not failsafe.of_target)
    )


def _plan_only(transition: Transition) -> bool:
    """Say whether a transition waits for nothing but the behaviour's end: no failsafe."""
    when = transition.when
    waits = isinstance(when, ex.Use) and when.kind == "done"
    return waits and transition.after is None and transition.event is None


def _transition(
    failsafe: Failsafe, to: str, targets: tuple[str, ...], catalogue: Catalogue
) -> Transition:
    parameters: dict[str, Any] = dict(failsafe.parameters)
    if failsafe.of_target:
        parameters["target"] = targets[0]
    guard = catalogue.guards[failsafe.use](**parameters)
    return Transition.model_construct(
        {"to", "when", "name"},
        to=(to,),
        when=ex.Use(failsafe.use, guard, NOWHERE),
        name=failsafe.name,
    )


def _needs_hover(mission: Mission, catalogue: Catalogue) -> bool:
    every = mission.by_name()
    if HOVER in firsts(every):
        return False
    kinds = [catalogue.kinds[placed.state.kind] for placed in every.values()]
    return any(failsafe.to_kind == HOVER for kind in kinds for failsafe in kind.failsafes)


def _with_hover(mission: Mission) -> Mission:
    every = mission.by_name()
    by_kind = firsts(every)
    away = by_kind.get("return") or by_kind.get("land", "")
    hover = State.model_construct(
        {"kind", "behavior", "transitions"},
        kind=HOVER,
        summary="Added by the default failsafes.",
        behavior=ex.Use("hold", Hold(), NOWHERE),
        transitions=(Transition.model_construct({"to", "after"}, to=(away,), after=HOVER_FOR),),
    )
    name = HOVER if HOVER not in every else f"{HOVER}-failsafe"
    return mission.model_copy(update={"states": {**mission.states, name: hover}})


def unmet(mission: Mission, catalogue: Catalogue) -> list[Problem]:
    """Return what the contracts of the state kinds demand and the mission does not give.

    Every mission needs a state of kind land; from every state the kinds that its contract names
    must be reachable by the mission's transitions, failsafes and default failsafes.
    """
    if "land" not in firsts(mission.by_name()):
        return [Problem(mission.place("states"), "no state of kind 'land': where would it end?")]
    ways = _Ways(fulfilled(mission, catalogue), catalogue)
    return [
        Problem(
            state.place("kind"),
            f"state {name!r} is of kind {state.kind!r}, which must be able to reach a state of "
            f"kind {kind!r}, but cannot",
        )
        for name, state, _ in mission.walk()
        for kind in catalogue.kinds[state.kind].must_reach
        if name not in ways.leading_to(kind)
    ]


class _Ways:
    """Which states may follow which: those around and inside an active state count as active."""

    def __init__(self, mission: Mission, catalogue: Catalogue) -> None:
        self.every = mission.by_name()
        self.before: dict[str, set[str]] = {name: set() for name in self.every}
        failsafes = {failsafe.to for failsafe in mission.failsafes}
        for placed in self.every.values():
            flying = catalogue.kinds[placed.state.kind].flying
            for name in _following(placed) | (failsafes if flying else set()):
                self.before[name].add(placed.name)
        self.found: dict[str, set[str]] = {}

    def leading_to(self, kind: str) -> set[str]:
        """Return the states from which a state of a kind can be reached."""
        if kind not in self.found:
            waiting = [name for name, placed in self.every.items() if placed.state.kind == kind]
            found = set(waiting)
            while waiting:
                fresh = self.before[waiting.pop()] - found
                found |= fresh
                waiting += fresh
            self.found[kind] = found
        return self.found[kind]


def _following(placed: Placed) -> set[str]:
    state = placed.state
    ways = {to for transition in state.transitions for to in transition.targets}
    ways |= set(state.states)
    if placed.parent is not None:
        ways.add(placed.parent)
    if state.default is not None:
        ways |= set(state.default.to)
    if state.invariant.exit is not None:
        ways.add(state.invariant.exit)
    return ways
