"""History of a flight, updated at every tick: visits, failsafes, the intended landing place."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import NamedTuple

from missionkit.chart.semantics.compiled_chart import Chart
from missionkit.messages import Fired, Record

ENDING = frozenset(("hover", "return", "land"))  # kinds of state that a flight is given up in
BUILT_IN_REASONS = (
    "failsafe plug-in failed",
    "failsafe ground touched",
    "the chart has ended in the air",
)
WRITTEN = "failsafe "
BROKEN = "invariant broken"
REQUIRED = "requirement "


Spans = Mapping[str, tuple[float, float]]


NO_SPANS: Spans = MappingProxyType({})


class TakenFailsafe(NamedTuple):
    """A failsafe that was taken."""

    at: float  # s
    label: str  # "failsafe battery", "unreachable, when goal unreachable"
    default: bool  # no file says it: a contract's, or the engine's own


class FlightHistory(NamedTuple):
    """History of the flight so far."""

    spans: Spans = NO_SPANS  # state -> first entered, last active, s
    finished: Mapping[str, float] = MappingProxyType({})  # state -> when its behaviour finished, s
    failsafes: tuple[TakenFailsafe, ...] = ()
    ended_by: TakenFailsafe | None = None  # the one since which the plan was not taken up again
    landing: tuple[float, float] | None = None  # m, north and east, where it means to land
    lost: str = ""  # why the estimate had diverged as it began to land


def passed(passage: FlightHistory, record: Record, chart: Chart) -> FlightHistory:
    """Return what a flight went through after one more tick.

    A state counts as visited when it was active or a transition led to it, final states and those
    around others included. A failsafe ends a flight unless an ordinary transition leads back to a
    state of the plan: one that neither hovers, returns nor lands.

    Args:
        passage: what the flight went through so far.
        record: of the tick.
        chart: that is flown.
    """
    passage = passage._replace(
        spans=_seen(passage.spans, (*record.active, record.state), record.now)
    )
    if record.done:
        passage = _finished(passage, record.state, record.now)
    for fired in record.fired:
        passage = after(passage, fired, record.now, chart)
        if "land" in _kinds(fired, chart):
            passage = passage._replace(landing=_place(record), lost=_lost(record))
    return passage


def after(passage: FlightHistory, fired: Fired, now: float, chart: Chart) -> FlightHistory:
    """Return what a flight went through after one more transition, which was taken at `now` (s).

    Args:
        passage: what the flight went through so far.
        fired: the transition.
        now: s.
        chart: that is flown.
    """
    if any(name == "done" and verdict.holds for name, verdict in fired.verdicts):
        passage = _finished(passage, fired.source, now)
    kinds = _kinds(fired, chart)
    taken = failsafe_of(fired, chart, now)
    ended_by, failsafes = passage.ended_by, passage.failsafes
    if taken is None:
        ended_by = None if kinds - ENDING else ended_by
    else:
        failsafes = (*failsafes, taken)
        ended_by = taken if kinds & ENDING else ended_by
    spans = _seen(passage.spans, _entered(fired, chart), now)
    return passage._replace(spans=spans, failsafes=failsafes, ended_by=ended_by)


def _entered(fired: Fired, chart: Chart) -> list[str]:
    return [to for to in fired.to.split(", ") if to in chart.states]


def _kinds(fired: Fired, chart: Chart) -> frozenset[str]:
    return frozenset(chart.states[to].kind.name for to in _entered(fired, chart))


def _finished(passage: FlightHistory, state: str, now: float) -> FlightHistory:
    """Return it with a state whose behaviour has finished, if that is news.

    The transition alone says so where a flight is read back from its record.
    """
    if state in passage.finished:
        return passage
    return passage._replace(finished={**passage.finished, state: now})


def _seen(spans: Spans, states: Iterable[str], now: float) -> Spans:
    news = {state: (spans.get(state, (now, now))[0], now) for state in states}
    return {**spans, **news}


def failsafe_of(fired: Fired, chart: Chart, now: float) -> TakenFailsafe | None:
    """Return the failsafe that a transition is, if it is one.

    Args:
        fired: a transition that was taken.
        chart: that is flown.
        now: s.
    """
    reason = fired.reason
    if reason in BUILT_IN_REASONS or reason.startswith(BROKEN):
        return TakenFailsafe(now, reason, default=True)
    if reason.startswith(REQUIRED) and any(it.reason == reason for it in chart.watch.requirements):
        return TakenFailsafe(now, reason, default=False)
    if reason.startswith(WRITTEN) and any(way.text == reason for way in chart.failsafes):
        return TakenFailsafe(now, reason, default=False)
    source = chart.states.get(fired.source)
    for way in () if source is None else source.transitions:
        if way.default and way.text == reason:
            return TakenFailsafe(now, reason, default=True)
    return None


def _lost(record: Record) -> str:
    health = record.estimate.health
    return (health.cause or "the filter has diverged") if health.diverged else ""


def _place(record: Record) -> tuple[float, float]:
    """Return where the vehicle takes itself to be as it begins to land."""
    north, east, _ = record.estimate.position.tolist()
    return north, east
