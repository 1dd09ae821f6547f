"""`summary.json` of a campaign, for programs."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

from missionkit.campaigns.analysis import (
    QUANTILES,
    Analysis,
    Comparison,
    Measure,
    Variant,
    command,
    conditions_of,
)
from missionkit.campaigns.markov_chain import Chain, absorbed, time_left
from missionkit.campaigns.requirement_statistics import (
    RequirementStatistics,
    requirement_statistics,
)
from missionkit.campaigns.statistics import ConfidenceInterval
from missionkit.recorder.run_folder import write_whole

SUMMARY_FILE = "summary.json"


def summed_up(results: Analysis) -> dict[str, Any]:
    """Return an analysis as plain values; what is not known is None."""
    campaign = results.campaign
    return {
        "missionkit": campaign.missionkit,
        "mission": campaign.name,
        "digest": campaign.digest,
        "seed": campaign.seed,
        "settings": campaign.settings,
        "faults": list(campaign.faults),
        "runs": len(results.rows),
        "variants": [_variant(variant) for variant in results.variants],
        "comparisons": [_comparison(each) for each in results.comparisons],
        "worst": [
            {
                "run": row.number,
                "outcome": row.outcome,
                "reason": row.reason,
                "command": command(campaign, row),
            }
            for row in results.worst
        ],
    }


def write_summary(folder: Path, results: Analysis) -> Path:
    """Write `summary.json`, whole or not at all, and return its path."""
    write_whole(folder / SUMMARY_FILE, json.dumps(summed_up(results), indent=2) + "\n")
    return folder / SUMMARY_FILE


def _variant(variant: Variant) -> dict[str, Any]:
    decided = variant.decision
    return {
        "name": variant.name,
        "settings": dict(variant.settings),
        "runs": len(variant.rows),
        "outcomes": dict(variant.outcomes),
        "reasons": dict(variant.reasons),
        "success": _interval(variant.success),
        "requirement": None if decided is None else decided._asdict(),
        "conditions": conditions_of(variant),
        "requirements": {it.name: _requirement(it) for it in requirement_statistics(variant.rows)},
        "metrics": {measure.name: _measure(measure) for measure in variant.measures},
        "chain": chain_told(variant.chain),
        "likeliest_failure": None
        if variant.failure is None
        else {
            "states": list(variant.failure.states),
            "outcome": variant.failure.ending.outcome,
            "probability": variant.failure.probability,
        },
    }


def _requirement(it: RequirementStatistics) -> dict[str, Any]:
    return {
        "flights": it.flights,
        "fulfilled": it.fulfilled,
        "broken": it.broken,
        "share": _interval(it.share),
        "worst_robustness": it.worst,
        "robustness_q05": it.low,
        "worst_seed": it.seed,
    }


def chain_told(chain: Chain) -> dict[str, Any]:
    """Return for each state the probability of each ending and the expected time to the end."""
    if not chain.states:
        return {}
    ends, left = absorbed(chain.inner, chain.outer), time_left(chain.inner, chain.dwell)
    names = [f"{ending.outcome} in {ending.state}" for ending in chain.endings]
    return {
        state: {
            "ends": dict(zip(names, ends[n].tolist(), strict=True)),
            "time_to_end": float(left[n]),
            "dwell": float(chain.dwell[n]),
        }
        for n, state in enumerate(chain.states)
    }


def _measure(measure: Measure) -> dict[str, Any]:
    shown = zip(QUANTILES, measure.quantiles, strict=True)
    return {"n": len(measure.values), **{f"q{100 * q:02.0f}": _interval(it) for q, it in shown}}


def _comparison(each: Comparison) -> dict[str, Any]:
    success = each.success
    return {
        "variant": each.name,
        "pairs": success.n,
        "only_first_succeeded": success.only_first,
        "only_this_succeeded": success.only_second,
        "gain": _interval(success.gain),
        "p_value": success.p_value,
        "median_changes": {name: _interval(change) for name, change in each.changes},
    }


def _interval(interval: ConfidenceInterval) -> list[float | None]:
    return [value if math.isfinite(value) else None for value in interval]
