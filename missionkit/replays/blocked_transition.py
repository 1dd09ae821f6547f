"""What kept a transition from being taken at the ticks at which its guard held, in sentences."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import NamedTuple

from missionkit.chart.semantics.compiled_chart import CompiledTransition
from missionkit.chart.semantics.time_tolerance import EPSILON
from missionkit.messages import Fired, Verdict
from missionkit.replays.state_stays import Stay


class Waiting(NamedTuple):
    """How a transition stands at one tick.

    Attributes:
        now: s, mission time.
        verdict: of its whole guard; None: it has none, or it was not evaluated.
        held: s that the guard has held; None: it does not.
        inside: s since its source was entered.
        fired: what was taken at this tick.
    """

    now: float
    verdict: Verdict | None
    held: float | None
    inside: float
    fired: tuple[Fired, ...]


def waiting(
    stay: Stay, verdicts: Sequence[Verdict | None], way: CompiledTransition
) -> list[Waiting]:
    """Return how a transition stood at each tick of a stay in its source.

    Args:
        stay: of a flight.
        verdicts: of its guard at each tick.
        way: the transition.
    """
    found: list[Waiting] = []
    since: float | None = None
    for tick, verdict in zip(stay.ticks, verdicts, strict=True):
        holds = way.ask is None or (verdict is not None and _takes(verdict, way))
        since = (tick.now if since is None else since) if holds else None
        held = None if since is None else tick.now - since
        inside = tick.now - stay.entered
        found.append(Waiting(tick.now, verdict, held, inside, tick.decision.fired))
    return found


def _takes(verdict: Verdict, way: CompiledTransition) -> bool:
    return way.unknown_takes if verdict.holds is None else verdict.holds


def hindrances(stands: Sequence[Waiting], way: CompiledTransition, dwell: float) -> Iterator[str]:
    """Yield what stood before a transition, a sentence each, the nearest to it first.

    Args:
        stands: how it stood at each tick.
        way: the transition.
        dwell: s, least time in its source.
    """
    held = [it for it in stands if it.held is not None]
    full = [it for it in held if (it.held or 0.0) >= way.hold - EPSILON]
    least = max(way.after or 0.0, dwell if way.patient else 0.0)
    ready = [it for it in full if it.inside >= least]
    yield from _before_it(ready, way)
    if held and not full:
        longest = max(held, key=lambda it: it.held or 0.0)
        yield (
            f"`for`: its guard held for {longest.held:.2f} s of the {way.hold:g} s it must hold, "
            f"until {longest.now:.2f} s"
        )
    if full and not ready:
        word = "`after`" if least == way.after else "dwell"
        inside = max(it.inside for it in full)
        yield f"{word}: {inside:.2f} s of {least:g} s had passed since its state was entered"
    yield from _unknown(stands)


def _before_it(ready: Sequence[Waiting], way: CompiledTransition) -> Iterator[str]:
    others = [(it, fired) for it in ready for fired in it.fired]
    for it, fired in others[:1]:
        yield f"at {it.now:.2f} s {_told(fired)} came before it"
    if way.events and ready and not others:
        yield f"event {' or '.join(way.events)} did not come while its guard held"


def _unknown(stands: Sequence[Waiting]) -> Iterator[str]:
    unknown = [it for it in stands if it.verdict is not None and it.verdict.holds is None]
    if unknown:
        why = unknown[-1].verdict.why if unknown[-1].verdict is not None else ""
        count = f"{len(unknown)} of {len(stands)} ticks"
        yield f"unknown in {count}, last at {unknown[-1].now:.2f} s: {why}"


def _told(fired: Fired) -> str:
    return f"{fired.source} -> {fired.to} ({fired.reason})"
