"""The smallest change of a mission with which a transition would have been taken, verified."""

from __future__ import annotations

import bisect
import itertools
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NamedTuple

from missionkit.api.missions import LoadedMission, refuse
from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.mission import Mission
from missionkit.chart.semantics.chart_compiler import compile_mission
from missionkit.engine.prepared_mission import PreparedMission, prepare
from missionkit.errors import FileError
from missionkit.messages import Fired
from missionkit.recorder.journal_reader import Journal
from missionkit.replays.asked_transition import (
    AskedTransition,
    NamedChart,
    failsafes_of,
    ways_from,
)
from missionkit.replays.chart_replay import (
    ChartTick,
    FirstDifference,
    chart_ticks,
    first_difference,
    ways,
)
from missionkit.replays.decision_difference import same
from missionkit.replays.mission_numbers import MissionNumber, numbers_of, with_numbers
from missionkit.replays.replayed_flight import replayed
from missionkit.replays.smallest_change import (
    Changes,
    Trials,
    less,
    pair_changes,
    single_changes,
)
from missionkit.replays.transition_conjuncts import conjuncts_in
from missionkit.replays.transition_explanation import Explanation


class ChangedNumber(NamedTuple):
    """A number of a mission file, as flown and changed.

    Attributes:
        where: in words: "near-goal: radius".
        key: its name in the file.
        flown: value in flight.
        changed: value with which the transition is taken.
        file: name of the file, as the journal holds it.
        line: of the guard, transition, failsafe or state that it belongs to.
        column: likewise.
    """

    where: str
    key: str
    flown: float
    changed: float
    file: str
    line: int
    column: int


class SmallestChange(NamedTuple):
    """The smallest change with which a transition would have been taken.

    Attributes:
        text: a sentence.
        verified: a replay of the whole flight by the changed mission takes it at that tick, and
            with 1 % less of the change it is not taken.
        numbers: one, or two of which neither can be smaller.
        at: s, mission time at which it would have been taken.
        tick: number of that tick.
    """

    text: str
    verified: bool
    numbers: tuple[ChangedNumber, ...]
    at: float
    tick: int


class ReplayedChart(NamedTuple):
    """The plan of a flight, and what its chart was asked with at each tick."""

    plan: PreparedMission
    ticks: Sequence[ChartTick]


class _Case(NamedTuple):
    """A flight up to the time in question, and the transition that was not taken in it."""

    mission: LoadedMission
    plan: PreparedMission
    journal: Journal
    asked: AskedTransition
    how: Explanation
    ticks: Sequence[ChartTick]
    sources: frozenset[str]

    def judged(self, mission: Mission, *, local: bool = False) -> FirstDifference | None:
        """Return where a mission takes the transition; None: it does not.

        Args:
            mission: with other numbers.
            local: they matter only while the source is active.
        """
        chart = compile_mission(mission, self.mission.catalogue)
        entered = bisect.bisect_right(self.ticks, self.how.since, key=lambda it: it.now)
        found = first_difference(chart, self.ticks, entered if local else 0)
        return found if found is not None and self.is_it(found.fired, found.now) else None

    def takes(self, changes: Changes) -> bool:
        """Say whether the mission takes it with some changes."""
        changed = with_numbers(self.mission.model, changes)
        local = all(number.local for number, _ in changes)
        return changed is not None and self.judged(changed, local=local) is not None

    def is_it(self, fired: Sequence[Fired], now: float) -> bool:
        """Say whether transitions taken at a time (s) are what was asked for."""
        led = any(self.asked.to in it.to.split(", ") and it.source in self.sources for it in fired)
        return led and self.how.since <= now <= self.how.at


BOTH = (-1, 1)
MOST_CONFIRMED = 4  # changes that a replay of everything tries, the smallest first
NONE_FOUND = "no change of one of its numbers, or of two, lets it be taken in that time"
RESUMED = "a resumed part: the smallest change is looked for in flights from their start only"


def smallest_change(
    mission: LoadedMission,
    known: NamedChart,
    journal: Journal,
    asked: AskedTransition,
    how: Explanation,
    flown: Callable[[], ReplayedChart],
) -> SmallestChange | str | None:
    """Return the smallest change with which a transition would have been taken.

    Args:
        mission: that flew.
        known: its chart.
        journal: of the flight.
        asked: the transition.
        how: it stood in flight.
        flown: gives the replay, if one is needed.

    Returns:
        None if it was taken or its state was not entered; a sentence if there is no such change.
    """
    if how.fired is not None or how.since >= how.at:
        return None
    if not journal.head.begins:
        return RESUMED
    numbers = _numbers(mission.model, known, asked, how)
    singles = [it for it, of in numbers if any(missing <= of for missing in how.missing)]
    pairs = [
        (one, other)
        for (one, of), (other, too) in itertools.combinations(numbers, 2)
        if any(missing <= of | too for missing in how.missing)
    ]
    if not (singles or pairs):
        return NONE_FOUND
    case = _case(mission, journal, asked, how, flown())
    trials = Trials(case.takes, lambda changes: with_numbers(mission.model, changes) is not None)
    found = single_changes(singles, trials) or pair_changes(pairs, trials)
    if not found:
        return NONE_FOUND
    flyable = (it for it in found[:MOST_CONFIRMED] if not _refused(case, it))
    confirmed = next((it for it in flyable if _replays(case, it)), None)
    return _described(case, confirmed or found[0], confirmed=confirmed is not None)


def _numbers(
    mission: Mission, known: NamedChart, asked: AskedTransition, how: Explanation
) -> list[tuple[MissionNumber, frozenset[int]]]:
    """Return the numbers that may matter, each with the conjuncts that it belongs to."""
    when = asked.model.when
    parts = [] if when is None else conjuncts_in(when, mission.guards)
    inside = [{id(each) for each in ex.opened([part], mission.guards)} for part in parts]
    found = [
        (it, frozenset(n for n, ids in enumerate(inside) if id(it.owner) in ids))
        for it in numbers_of(mission, asked.model, asked.state, asked.owner)
    ]
    rivals = {fired.reason for fired in how.rivals}
    for other in (*failsafes_of(known), *ways_from(known, asked.source)):
        if other.compiled.text in rivals:
            every = numbers_of(mission, other.model, other.state, other.owner)
            found += [(it._replace(signs=BOTH, local=False), frozenset()) for it in every]
    return [(it, of) for it, of in found if it.place.file]


def replayed_chart(mission: LoadedMission, journal: Journal) -> ReplayedChart:
    """Replay a flight, and keep what its chart was asked with."""
    plan = prepare(mission.model, mission.catalogue)
    return ReplayedChart(plan, list(chart_ticks(plan.chart, replayed(plan, journal))))


def _case(
    mission: LoadedMission,
    journal: Journal,
    asked: AskedTransition,
    how: Explanation,
    flown: ReplayedChart,
) -> _Case:
    plan, ticks = flown
    ticks = [tick for tick in ticks if tick.now <= how.at]
    states = plan.chart.states
    inside = [name for name, state in states.items() if asked.source in state.ancestors]
    sources = frozenset((asked.source, *states[asked.source].ancestors, *inside))
    return _Case(mission, plan, journal, asked, how, ticks, sources)


def _described(case: _Case, changes: Changes, *, confirmed: bool) -> SmallestChange:
    changed = with_numbers(case.mission.model, changes)
    assert changed is not None  # noqa: S101 - it was judged
    found = case.judged(changed)
    assert found is not None  # noqa: S101 - likewise
    wrong = "" if confirmed else _refused(case, changes)
    verified = confirmed and _no_less(case, changes)
    words = " and ".join(
        f"{number.where} {value:g} instead of {number.value:g} (line {number.place.line})"
        for number, value in changes
    )
    text = f"smallest change: with {words} it is taken at {found.now:.2f} s"
    text += (
        ", with 1 % less of the change it is not" if verified else " (not confirmed by a replay)"
    )
    text += f"; the checks refuse that mission: {wrong}" if wrong else ""
    numbers = tuple(
        ChangedNumber(
            number.where,
            number.key,
            number.value,
            value,
            Path(number.place.file).name,
            number.place.line,
            number.place.column,
        )
        for number, value in changes
    )
    return SmallestChange(text, verified, numbers, found.now, found.number)


def _refused(case: _Case, changes: Changes) -> str:
    """Return what the checks before flight refuse in the changed mission; "": nothing."""
    changed = with_numbers(case.mission.model, changes)
    assert changed is not None  # noqa: S101 - it was judged
    try:
        refuse(changed, case.mission.catalogue)
    except FileError as error:
        return error.problems[0].message
    return ""


def _replays(case: _Case, changes: Changes) -> bool:
    """Say whether a replay of everything takes it at the same tick, with no other command before.

    A guard that a failsafe reads can keep the vehicle from taking off: that is no transition.
    """
    changed = with_numbers(case.mission.model, changes)
    found = None if changed is None else case.judged(changed)
    if changed is None or found is None:
        return False
    plan = case.plan._replace(chart=compile_mission(changed, case.mission.catalogue))
    for tick in replayed(plan, case.journal):
        if ways(tick.replayed.fired) != ways(tick.flown.fired):
            return tick.number == found.number and case.is_it(tick.replayed.fired, tick.now)
        if not same(tick.replayed.command, tick.flown.command):
            return False
    return False


def _no_less(case: _Case, changes: Changes) -> bool:
    return not any(case.takes(less(changes, n)) for n in range(len(changes)))
