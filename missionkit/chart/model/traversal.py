"""Every action and every guard of a mission, wherever it stands."""

from __future__ import annotations

from collections.abc import Iterator

from missionkit.chart.model.actions import Act
from missionkit.chart.model.guard_expressions import Expression
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.state_definitions import Start


def actions_of(mission: Mission) -> Iterator[Act]:
    """Yield every action."""
    starts: list[Start | None] = [mission.initial]
    for failsafe in mission.failsafes:
        yield from failsafe.do
    for _, state, _ in mission.walk():
        yield from (*state.entry, *state.exit)
        for way in state.transitions:
            yield from way.do
        starts += [state.initial, state.default]
    for start in starts:
        yield from () if start is None else start.do


def guards_of(mission: Mission) -> Iterator[Expression]:
    """Yield every guard expression; those inside others are not yielded again."""
    yield from mission.guards.values()
    yield from (failsafe.when for failsafe in mission.failsafes)
    for _, state, _ in mission.walk():
        yield from (way.when for way in state.transitions if way.when is not None)
        if state.invariant.holds is not None:
            yield state.invariant.holds
    for requirement in mission.requirements:
        yield from requirement.guards()
