"""Carrying out the contracts of the state kinds on a mission.

A default failsafe becomes an ordinary transition, at the end of its state's list, unless the
state has a transition there already that waits for more than `done`, or the mission has no such
state.
"""

from __future__ import annotations

from typing import Any

from missionkit.behaviors.hold import Hold
from missionkit.chart import expressions as ex
from missionkit.chart.catalogue import Catalogue
from missionkit.chart.model import Mission, State, Transition
from missionkit.errors import Place, Problem
from missionkit.states.common import HOVER
from missionkit.states.contract import Failsafe

NOWHERE = Place("", 0, 0)
HOVER_FOR = 20.0  # s before a vehicle whose goal is out of reach goes home


def fulfilled(mission: Mission, catalogue: Catalogue) -> Mission:
    """Return the mission with the default failsafes written out."""
    if _needs_hover(mission, catalogue):
        mission = _with_hover(mission)
    states = {
        name: state.model_copy(
            update={"transitions": state.transitions + _defaults(mission, state, catalogue)}
        )
        for name, state in mission.states.items()
    }
    return mission.model_copy(update={"states": states})


def _defaults(mission: Mission, state: State, catalogue: Catalogue) -> tuple[Transition, ...]:
    have = {
        mission.states[transition.to].kind
        for transition in state.transitions
        if not _plan_only(transition)
    }
    targets = state.behavior.plugin.targets()
    return tuple(
        _transition(failsafe, _first(mission, failsafe.to_kind), targets, catalogue)
        for failsafe in catalogue.kinds[state.kind].failsafes
        if failsafe.to_kind not in have
        and _first(mission, failsafe.to_kind)
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
        to=to,
        when=ex.Use(failsafe.use, guard, NOWHERE),
        name=failsafe.name,
    )


def _needs_hover(mission: Mission, catalogue: Catalogue) -> bool:
    if _first(mission, HOVER):
        return False
    kinds = [catalogue.kinds[state.kind] for state in mission.states.values()]
    return any(failsafe.to_kind == HOVER for kind in kinds for failsafe in kind.failsafes)


def _with_hover(mission: Mission) -> Mission:
    away = _first(mission, "return") or _first(mission, "land")
    hover = State.model_construct(
        {"kind", "behavior", "transitions"},
        kind=HOVER,
        summary="Added by the default failsafes.",
        behavior=ex.Use("hold", Hold(), NOWHERE),
        transitions=(Transition.model_construct({"to", "after"}, to=away, after=HOVER_FOR),),
    )
    name = HOVER if HOVER not in mission.states else f"{HOVER}-failsafe"
    return mission.model_copy(update={"states": {**mission.states, name: hover}})


def _first(mission: Mission, kind: str) -> str:
    """Return the first state of a kind, empty if there is none."""
    return next((name for name, state in mission.states.items() if state.kind == kind), "")


def unmet(mission: Mission, catalogue: Catalogue) -> list[Problem]:
    """Return what the contracts of the state kinds demand and the mission does not give.

    Every mission needs a state of kind land; from every state the kinds that its contract names
    must be reachable by the mission's transitions, failsafes and default failsafes.
    """
    if not _first(mission, "land"):
        return [Problem(mission.place("states"), "no state of kind 'land': where would it end?")]
    whole = fulfilled(mission, catalogue)
    return [
        Problem(
            state.place("kind"),
            f"state {name!r} is of kind {state.kind!r}, which must be able to reach a state of "
            f"kind {kind!r}, but cannot",
        )
        for name, state in mission.states.items()
        for kind in catalogue.kinds[state.kind].must_reach
        if kind not in _reached(whole, name, catalogue)
    ]


def _reached(mission: Mission, start: str, catalogue: Catalogue) -> set[str]:
    """Return the kinds of state that can be reached from `start`."""
    found, waiting = {start}, [start]
    while waiting:
        state = mission.states[waiting.pop()]
        ways = [transition.to for transition in state.transitions]
        if catalogue.kinds[state.kind].flying:
            ways += [failsafe.to for failsafe in mission.failsafes]
        fresh = set(ways) - found
        found |= fresh
        waiting += fresh
    return {mission.states[name].kind for name in found}
