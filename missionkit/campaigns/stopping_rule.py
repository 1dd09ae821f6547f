"""When enough has been flown: an interval that is narrow, or a requirement that is decided.

Looked at after every run, in order of the runs and never of their endings: the same campaign stops
at the same run however many workers fly it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal, NamedTuple

from missionkit.campaigns.campaign_plan import Rule
from missionkit.campaigns.run_row import Row
from missionkit.campaigns.statistics import wilson

LEAST_RUNS = 30  # runs before an interval's width counts

Verdict = Literal["met", "not met", "open"]


class StopDecision(NamedTuple):
    """Result of the test of a requirement."""

    verdict: Verdict
    after: int  # runs


def sprt(successes: Sequence[bool], rule: Rule) -> StopDecision:
    """Decide by Wald's sequential test whether the success rate is above `rule.require`.

    Sums ln(likelihood at `hoped` / likelihood at `require`) and stops outside of
    (ln(risk / (1 - risk)), ln((1 - risk) / risk)): "met" is wrong with probability `risk` at most
    if the rate is `require` or less, "not met" likewise if it is `hoped` or more.

    Source: A. Wald, "Sequential tests of statistical hypotheses", 1945.
    """
    at_most, at_least = rule.require or 0.0, rule.hoped
    up = math.log(at_least / at_most) if at_most > 0.0 else math.inf
    down = math.log((1 - at_least) / (1 - at_most))
    bound, total = math.log((1 - rule.risk) / rule.risk), 0.0
    for n, success in enumerate(successes, 1):
        total += up if success else down
        if total >= bound:
            return StopDecision("met", n)
        if total <= -bound:
            return StopDecision("not met", n)
    return StopDecision("open", len(successes))


def narrow_at(successes: Sequence[bool], width: float) -> int | None:
    """Return after how many runs Wilson's interval is no wider than `width`, `None` if never."""
    good = 0
    for n, success in enumerate(successes, 1):
        good += success
        if n >= LEAST_RUNS and wilson(good, n).width <= width:
            return n
    return None


def enough(rows: Sequence[Row], rule: Rule, variants: int) -> int | None:
    """Return after how many rows the campaign may stop; `None`: not yet.

    Args:
        rows: in order of their runs, none left out.
        rule: says when.
        variants: all of them have to be decided.
    """
    if rule.idle:
        return None
    stops = [_stop(_successes(rows, v), rule) for v in range(variants)]
    decided = [stop for stop in stops if stop is not None]
    return max(decided) * variants if len(decided) == variants else None


def decision(rows: Sequence[Row], rule: Rule, variant: int) -> StopDecision | None:
    """Return what became of the requirement for a variant; `None` without one.

    Args:
        rows: of all variants flown so far, in order.
        rule: with the requirement and its error probabilities.
        variant: number of the one judged.
    """
    return None if rule.require is None else sprt(_successes(rows, variant), rule)


def _successes(rows: Sequence[Row], variant: int) -> list[bool]:
    return [row.succeeded for row in rows if row.variant == variant]


def _stop(successes: Sequence[bool], rule: Rule) -> int | None:
    """Return the run of a variant at which every requirement is decided."""
    stops: list[int | None] = []
    if rule.width is not None:
        stops.append(narrow_at(successes, rule.width))
    if rule.require is not None:
        verdict, after = sprt(successes, rule)
        stops.append(None if verdict == "open" else after)
    known = [stop for stop in stops if stop is not None]
    return max(known) if len(known) == len(stops) else None
