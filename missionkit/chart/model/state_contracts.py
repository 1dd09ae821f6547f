"""Carrying out the contracts of the state kinds on a mission.

A default failsafe becomes an ordinary transition, at the end of its state's list, to the nearest
state of its kind (`nearest_state`), unless the state has a transition to that kind already that
waits for more than `done`, or there is no such state near.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from missionkit.behaviors.hold import Hold
from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.nearest_state import Nearest
from missionkit.chart.model.placed_states import Placed, firsts
from missionkit.chart.model.state_definitions import State, Transition
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.errors import NO_PLACE, Problem
from missionkit.states.contract import KindFailsafe
from missionkit.states.shared_failsafes import HOVER

HOVER_FOR = 20.0  # s before a vehicle whose goal is out of reach goes home
HOME_KINDS = ("return", "land")


def fulfilled(mission: Mission, catalogue: Catalogue) -> Mission:
    """Return the mission with the default failsafes and the exits of invariants written out."""
    catalogue = catalogue.flying(mission.vehicle.use)
    nearest = nearest_in(mission, catalogue)
    hovers = _hovers(mission, catalogue, nearest)
    work = _ContractWork(catalogue, nearest, {scope: name for scope, (name, _) in hovers.items()})
    states = {name: work.carried_out(name, state) for name, state in mission.states.items()}
    for scope, (name, hover) in hovers.items():
        states = _added(states, scope, name, hover)
    return mission.model_copy(update={"states": states})


def nearest_in(mission: Mission, catalogue: Catalogue) -> Nearest:
    """Return which states of a mission are near to each other."""
    kinds = catalogue.flying(mission.vehicle.use).kinds
    flying = frozenset(name for name, kind in kinds.items() if kind.flying)
    return Nearest(mission, flying)


def due(state: State, nearest: Nearest, catalogue: Catalogue) -> Iterator[KindFailsafe]:
    """Yield the default failsafes of a state's kind that its own transitions do not replace.

    A transition that waits for `done` alone or for an event from outside replaces none, nor does
    one to a state that was made for something else.

    Args:
        state: of a kind in the catalogue, with the transitions of its author.
        nearest: where a failsafe of each kind would lead from here.
        catalogue: has the default failsafes of each kind.
    """
    have = {
        nearest.every[to].state.kind
        for transition in state.transitions
        if not _plan_only(transition) and not nearest.from_outside(transition)
        for to in transition.targets
        if not nearest.reserved(to)
    }
    for failsafe in catalogue.kinds[state.kind].failsafes:
        if failsafe.to_kind not in have and (_targets(state) or not failsafe.of_target):
            yield failsafe


class _ContractWork(NamedTuple):
    """Working data of the contract checks."""

    catalogue: Catalogue
    nearest: Nearest
    hovers: Mapping[str | None, str]  # that are added, by the state whose file they are for

    def carried_out(self, name: str, state: State) -> State:
        """Return a state, and those inside it, with what their kinds add."""
        inner = {each: self.carried_out(each, inside) for each, inside in state.states.items()}
        changes: dict[str, Any] = {
            "states": inner,
            "transitions": state.transitions + self._defaults(name, state),
        }
        promised = self.catalogue.kinds[state.kind].invariant
        if promised is not None and state.invariant.exit is None:
            away = self._leads_to(name, promised.to_kind)
            changes["invariant"] = state.invariant.model_copy(update={"exit": away})
        return state.model_copy(update=changes)

    def _defaults(self, name: str, state: State) -> tuple[Transition, ...]:
        found = []
        for failsafe in due(state, self.nearest, self.catalogue):
            to = self._leads_to(name, failsafe.to_kind)
            if to is not None:
                found.append(_transition(failsafe, to, _targets(state), self.catalogue))
        return tuple(found)

    def _leads_to(self, name: str, kind: str) -> str | None:
        found = self.nearest.of(name, kind)
        if found is not None:
            return found.name
        scope = self.nearest.included(name)
        return self.hovers.get(scope, self.hovers.get(None)) if kind == HOVER else None


def _targets(state: State) -> tuple[str, ...]:
    return () if state.behavior is None else state.behavior.plugin.targets()


def _plan_only(transition: Transition) -> bool:
    """Say whether a transition waits for nothing but the behaviour's end: no failsafe."""
    when = transition.when
    waits = isinstance(when, ex.Use) and when.kind == "done"
    return waits and transition.after is None and transition.event is None


def _transition(
    failsafe: KindFailsafe, to: str, targets: tuple[str, ...], catalogue: Catalogue
) -> Transition:
    parameters: dict[str, Any] = dict(failsafe.parameters)
    if failsafe.of_target:
        parameters["target"] = targets[0]
    guard = catalogue.group("guards")[failsafe.use](**parameters)
    return Transition.model_construct(
        {"to", "when", "name", "emergency"},
        to=(to,),
        when=ex.Use(failsafe.use, guard, NO_PLACE),
        name=failsafe.name,
        emergency=failsafe.emergency,
    )


def _hovers(
    mission: Mission, catalogue: Catalogue, nearest: Nearest
) -> dict[str | None, tuple[str, State]]:
    """Return the hovers to be added: one for each file with a state that needs one and has none."""
    found: dict[str | None, tuple[str, State]] = {}
    for name, state, _ in mission.walk():
        scope = nearest.included(name)
        if scope is not None and nearest.every[scope].state.parallel:
            scope = None  # a state more would be a region more
        needs = any(failsafe.to_kind == HOVER for failsafe in catalogue.kinds[state.kind].failsafes)
        if needs and scope not in found and nearest.of(name, HOVER) is None:
            away = _way_home(name, nearest)
            own = HOVER if scope is None else f"{scope}/{HOVER}"
            found[scope] = own if own not in nearest.every else f"{own}-failsafe", _hover(away)
    return found


def _way_home(name: str, nearest: Nearest) -> str:
    """Return where a hover that is added leads in the end: home, or down."""
    near = (nearest.of(name, kind) for kind in HOME_KINDS)
    far = (to for kind in HOME_KINDS for to in nearest.anywhere(kind))
    return next((found.name for found in near if found is not None), None) or next(far, "")


def _hover(away: str) -> State:
    return State.model_construct(
        {"kind", "behavior", "transitions"},
        kind=HOVER,
        summary="Added by the default failsafes.",
        behavior=ex.Use("hold", Hold(), NO_PLACE),
        transitions=(Transition.model_construct({"to", "after"}, to=(away,), after=HOVER_FOR),),
    )


def _added(
    states: Mapping[str, State], scope: str | None, name: str, hover: State
) -> dict[str, State]:
    """Return the states with one more inside `scope`."""
    if scope is None:
        return {**states, name: hover}
    return {
        each: state.model_copy(
            update={
                "states": {**state.states, name: hover}
                if each == scope
                else _added(state.states, scope, name, hover)
            }
        )
        for each, state in states.items()
    }


def unmet(mission: Mission, catalogue: Catalogue) -> list[Problem]:
    """Return what the contracts of the state kinds demand and the mission does not give.

    Every mission needs a state of kind land; from every state the kinds that its contract names
    must be reachable by the mission's transitions, failsafes and default failsafes.
    """
    catalogue = catalogue.flying(mission.vehicle.use)
    if "land" not in firsts(mission.by_name()):
        return [
            Problem(
                mission.place("states"), "no state of kind 'land': the mission needs one to end in"
            )
        ]
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
