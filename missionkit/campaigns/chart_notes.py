"""Campaign results as notes on the chart: counts, shares, times, and what was never flown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import NamedTuple

from missionkit.campaigns.chart_coverage import ChartCoverage, failsafes
from missionkit.campaigns.flown_chart import Charted
from missionkit.campaigns.markov_chain import Chain, absorbed, time_left
from missionkit.campaigns.number_format import percent, plural
from missionkit.campaigns.visit_log import parts
from missionkit.chart.drawing.chart_overlay import (
    End,
    Overlay,
    OverlayNote,
    Tone,
    UndeclaredArrow,
)

TONES: dict[str, Tone] = {"success": "good", "ended_safely": "fair", "crash": "bad"}
NEVER_TAKEN = "never taken"
LEGEND = (
    "On an arrow: how often it was taken, and the share of visits to its state. Dashed: not a "
    "transition of the chart, such as failsafes. Round boxes: how flights end. Pale: never flown.",
    "In a state: the share of flights that visited it, the length of a visit, the time from there "
    "to the end, the share of those flights that succeeded; the chain's figure where it differs.",
)


def notes(charted: Charted, counts: ChartCoverage, chain: Chain, name: str) -> Overlay:
    """Return what is drawn over a chart.

    Args:
        charted: the chart.
        counts: of its flights.
        chain: of the same flights.
        name: of the variant.
    """
    taken, known = failsafes(counts), expected(chain)
    return Overlay(
        states={it: _state(it, counts, known.get(it)) for it in charted.names},
        ways={way: _way(counts, called) for way, called in charted.ways.items()},
        failsafes={
            it.name: OverlayNote(
                (plural(taken[it.name], "time") if taken[it.name] else NEVER_TAKEN,)
            )
            for it in charted.mission.failsafes
        },
        ends=tuple(_ends(counts)),
        moves=(*_undeclared(charted, counts), *_endings(counts)),
        lines=(f"{plural(counts.flights, 'simulated flight')}, {name}.", *LEGEND),
    )


class Expected(NamedTuple):
    """Prediction of the Markov chain for a state."""

    success: float
    crash: float
    left: float  # s to the end


def expected(chain: Chain) -> dict[str, Expected]:
    """Return for each state that commands what the chain says of it."""
    if not chain.states:
        return {}
    ends, left = absorbed(chain.inner, chain.outer), time_left(chain.inner, chain.dwell)
    good, hurt = (
        ends[:, [it.outcome == outcome for it in chain.endings]].sum(axis=1).tolist()
        for outcome in ("success", "crash")
    )
    return dict(zip(chain.states, map(Expected, good, hurt, left.tolist()), strict=True))


def _state(name: str, counts: ChartCoverage, chain: Expected | None) -> OverlayNote:
    """Return a state's note; one that does not command is not a state of the chain."""
    runs, visits = counts.passed[name], counts.entries[name]
    if not visits:
        return OverlayNote(("never reached",), pale=True)
    ended = counts.outcomes[name]
    dwell = f"{counts.seconds[name] / visits:.1f} s a visit"
    counted_chances = _chances(ended["success"] / runs, ended["crash"] / runs)
    lines = [f"in {percent(runs / counts.flights)} of flights", dwell, counted_chances]
    if chain is not None:
        lines[1] += f", {chain.left:.0f} s to the end"
        by_chain = _chances(chain.success, chain.crash)
        lines += [] if by_chain == counted_chances else [f"chain: {by_chain}"]
    return OverlayNote(tuple(lines))


def _chances(success: float, crash: float) -> str:
    return f"{percent(success)} succeed" + (f", {percent(crash)} crash" if crash > 0 else "")


def _way(counts: ChartCoverage, called: str) -> OverlayNote:
    count = counts.ways[called]
    return (
        _taken(count, parts(called)[0], counts) if count else OverlayNote((NEVER_TAKEN,), pale=True)
    )


def _taken(count: int, source: str, counts: ChartCoverage) -> OverlayNote:
    share = min(1.0, count / max(counts.entries[source], 1))
    weight = min(1.0, count / max(counts.flights, 1))
    return OverlayNote((f"{plural(count, 'time')}, {percent(share)}",), weight)


def _undeclared(charted: Charted, counts: ChartCoverage) -> Iterator[UndeclaredArrow]:
    """Yield what was taken besides the chart's arrows."""
    known, drawn = set(charted.ways.values()), set(charted.mission.by_name())
    for called in sorted(counts.ways.keys() - known):
        source, to, reason = parts(called)
        if {source, to} <= drawn:
            yield UndeclaredArrow(source, to, reason, _way(counts, called))


def _ends(counts: ChartCoverage) -> Iterator[End]:
    totals = Counter[str]()
    for (_, outcome), count in counts.ends.items():
        totals[outcome] += count
    for outcome, tone in TONES.items():
        if totals[outcome]:
            share = percent(totals[outcome] / counts.flights)
            yield End(_spelled(outcome), (f"{plural(totals[outcome], 'flight')}, {share}",), tone)


def _endings(counts: ChartCoverage) -> Iterator[UndeclaredArrow]:
    for (state, outcome), count in sorted(counts.ends.items()):
        yield UndeclaredArrow(state, _spelled(outcome), "", _taken(count, state, counts), ends=True)


def _spelled(outcome: str) -> str:
    return outcome.replace("_", " ")
