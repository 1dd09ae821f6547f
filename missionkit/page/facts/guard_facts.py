"""The guards of the active states, the nearest to changing first."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from missionkit.chart.semantics.compiled_chart import Chart
from missionkit.chart.semantics.requirement_watch import PREFIX
from missionkit.messages import Record, Verdict
from missionkit.page.facts.chart_ids import transitions
from missionkit.page.facts.plain_values import number

ENTRY = "enter "  # begins the answer of a requirement's part, which is no guard


class HeldGuards:
    """Follows since when each guard has held without a break, tick by tick."""

    def __init__(self) -> None:
        self.since: Mapping[str, float] = {}  # s

    def follow(self, record: Record) -> None:
        """Take one more tick."""
        before = self.since
        self.since = {
            name: before.get(name, record.now)
            for name, verdict in record.verdicts
            if verdict.holds is True
        }


def needed(chart: Chart) -> Mapping[tuple[str | None, str], float]:
    """Return how long (s) guards must hold, by the state that they lead out of and their name."""
    return {
        (it.source, name): it.hold for it in transitions(chart) if it.hold for name in it.guards
    }


def guard_rows(
    record: Record, since: Mapping[str, float], need: Mapping[tuple[str | None, str], float]
) -> list[dict[str, object]]:
    """Return a row for each guard that was evaluated.

    Args:
        record: of a tick.
        since: s, when guards began to hold.
        need: s they must hold.
    """
    sources = (None, *record.active)
    rows = [
        _row(name, verdict, _held(name, since, record.now), _need(name, sources, need))
        for name, verdict in record.verdicts
        if not name.startswith((PREFIX, ENTRY))
    ]
    return sorted(rows, key=_nearness)


def _held(name: str, since: Mapping[str, float], now: float) -> float | None:
    return None if name not in since else round(now - since[name], 6)


def _need(
    name: str, sources: Iterable[str | None], need: Mapping[tuple[str | None, str], float]
) -> float | None:
    waits = [need[source, name] for source in sources if (source, name) in need]
    return max(waits, default=None)


def _row(name: str, it: Verdict, held: float | None, needs: float | None) -> dict[str, object]:
    threshold, margin = number(it.threshold), number(it.margin)
    normal = None if margin is None else margin / (abs(threshold or 0.0) or 1.0)
    return {
        "name": name,
        "holds": None if it.holds is None else bool(it.holds),
        "value": number(it.value),
        "threshold": threshold,
        "margin": margin,
        "normal": number(normal),
        "why": it.why,
        "held_for": held,
        "needs": needs,
    }


def _nearness(row: Mapping[str, object]) -> float:
    normal = row["normal"]
    return abs(normal) if isinstance(normal, float) else float("inf")
