"""All that a campaign says, as numbers: what `summary.json` and the report are made of."""

from __future__ import annotations

import shlex
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from missionkit.campaigns.campaign_plan import Campaign
from missionkit.campaigns.markov_chain import (
    Chain,
    ChainPath,
    estimate,
    likeliest,
)
from missionkit.campaigns.paired_comparison import Paired, compared
from missionkit.campaigns.run_row import NO_FLIGHT, Row
from missionkit.campaigns.statistics import (
    ConfidenceInterval,
    bootstrap,
    differences,
    quantile,
    wilson,
)
from missionkit.campaigns.stopping_rule import StopDecision, decision
from missionkit.campaigns.variants import name_of, variants

QUANTILES = (0.05, 0.5, 0.95)
WORST, ALIKE = 10, 3  # runs shown, and of them with the same reason
BADNESS = {"crash": 0, "lost": 1, "hung": 1, "error": 1, "ended_safely": 2, "success": 3}


class Measure(NamedTuple):
    """A number of the runs of one variant."""

    name: str
    values: tuple[float, ...]  # where it was measured
    quantiles: tuple[ConfidenceInterval, ...]  # 5 %, 50 %, 95 %


class Variant(NamedTuple):
    """Results of one variant."""

    name: str
    settings: Mapping[str, str]
    rows: tuple[Row, ...]
    outcomes: Mapping[str, int]
    reasons: tuple[tuple[str, int], ...]  # without success, the most frequent first
    success: ConfidenceInterval
    decision: StopDecision | None
    measures: tuple[Measure, ...]
    chain: Chain
    failure: ChainPath | None  # the most probable one


class Comparison(NamedTuple):
    """A variant against the first one, seed by seed."""

    name: str
    success: Paired
    changes: tuple[tuple[str, ConfidenceInterval], ...]  # median of the differences of each number


class Analysis(NamedTuple):
    """The campaign."""

    campaign: Campaign
    rows: tuple[Row, ...]  # that count
    variants: tuple[Variant, ...]
    comparisons: tuple[Comparison, ...]
    worst: tuple[Row, ...]


def analysed(campaign: Campaign, rows: Sequence[Row]) -> Analysis:
    """Return what the rows say; the same rows always give the same numbers."""
    rng = np.random.default_rng(campaign.seed)
    settings = variants(campaign.vary)
    groups = [tuple(row for row in rows if row.variant == v) for v in range(len(settings))]
    summaries = tuple(
        _variant(campaign, v, settings[v], group, rng) for v, group in enumerate(groups)
    )
    comparisons = tuple(_comparison(summaries[0], other, rng) for other in summaries[1:])
    return Analysis(campaign, tuple(rows), summaries, comparisons, worst(rows))


def _variant(
    campaign: Campaign,
    number: int,
    settings: Mapping[str, str],
    rows: tuple[Row, ...],
    rng: np.random.Generator,
) -> Variant:
    chain = estimate(rows)
    failures = [ending for ending in chain.endings if ending.outcome != "success"]
    return Variant(
        name_of(settings),
        settings,
        rows,
        dict(sorted(Counter(row.outcome for row in rows).items(), key=_by_badness)),
        tuple(Counter(row.reason for row in rows if not row.succeeded).most_common()),
        wilson(sum(row.succeeded for row in rows), len(rows)),
        decision(rows, campaign.rule, number),
        tuple(_measure(name, rows, rng) for name in measured(rows)),
        chain,
        likeliest(chain, failures),
    )


def _by_badness(item: tuple[str, int]) -> int:
    return -BADNESS[item[0]]


def measured(rows: Sequence[Row]) -> list[str]:
    """Return the names of the numbers that some run has."""
    some = {name for row in rows for name, value in row.metrics.items() if value is not None}
    order = dict.fromkeys(name for row in rows for name in row.metrics)
    return [name for name in order if name in some]


def _measure(name: str, rows: Sequence[Row], rng: np.random.Generator) -> Measure:
    values = tuple(v for row in rows if (v := row.metrics.get(name)) is not None)
    return Measure(name, values, tuple(quantile(values, q, rng) for q in QUANTILES))


def _comparison(first: Variant, other: Variant, rng: np.random.Generator) -> Comparison:
    ours = {row.seed: row for row in first.rows}
    pairs = [(ours[row.seed], row) for row in other.rows if row.seed in ours]
    success = compared([a.succeeded for a, _ in pairs], [b.succeeded for _, b in pairs])
    changes = []
    for name in measured([row for pair in pairs for row in pair]):
        column = [(a.metrics.get(name), b.metrics.get(name)) for a, b in pairs]
        gaps = differences([a for a, _ in column], [b for _, b in column])
        changes.append((name, bootstrap(gaps, lambda drawn: np.median(drawn, axis=-1), rng)))
    return Comparison(other.name, success, tuple(changes))


def worst(rows: Iterable[Row], count: int = WORST, alike: int = ALIKE) -> tuple[Row, ...]:
    """Return the runs to look at first: crashes, broken runs, failures, then the narrowest.

    Of a variant's runs that ended for the same reason only the worst are taken: `alike` of them.

    Args:
        rows: in any order.
        count: rows returned at most.
        alike: rows at most with the same variant and reason.
    """
    taken, shown = Counter[tuple[int, str]](), list[Row]()
    for row in sorted(rows, key=_rank):
        kind = row.variant, row.reason
        if taken[kind] < alike and len(shown) < count:
            taken[kind] += 1
            shown.append(row)
    return tuple(shown)


def _rank(row: Row) -> tuple[float, ...]:
    clearance, error = row.metrics.get("clearance"), row.metrics.get("position_error")
    near = np.inf if clearance is None else clearance
    far = 0.0 if error is None else error
    return BADNESS[row.outcome], near, -far, -(row.metrics.get("duration") or 0.0), row.number


def command(campaign: Campaign, row: Row) -> str:
    """Return the command that flies a run again, alone and with its record."""
    words = ["missionkit", "run", campaign.mission, "--seed", str(row.seed)]
    for name, value in {**campaign.settings, **row.settings}.items():
        words += ["--set", f"{name}={value}"]
    for fault in campaign.faults:
        words += ["--fault", fault]
    for plugin in campaign.plugins:
        words += ["--plugin", plugin]
    return shlex.join(words)


def conditions_of(variant: Variant) -> dict[str, dict[str, int]]:
    """Return for each condition of success how many flights met it, of those that say."""
    summaries: dict[str, dict[str, int]] = {}
    for row in variant.rows:
        for name, met in row.conditions.items():
            count = summaries.setdefault(name, {"met": 0, "flights": 0})
            count["flights"] += 1
            count["met"] += met is True
    return summaries


def broken(rows: Iterable[Row]) -> int:
    """Return how many runs gave no flight; they count as not succeeded."""
    return sum(row.outcome in NO_FLIGHT for row in rows)
