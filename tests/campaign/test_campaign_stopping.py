from __future__ import annotations

import math

import numpy as np
import pytest
from campaigns import row

from missionkit.campaigns.campaign_loop import counted
from missionkit.campaigns.campaign_plan import Campaign, Rule
from missionkit.campaigns.statistics import wilson
from missionkit.campaigns.stopping_rule import (
    LEAST_RUNS,
    decision,
    enough,
    narrow_at,
    sprt,
)

ABOVE = Rule(require=0.98)


def test_success_without_end_is_enough_after_as_many_runs_as_wald_says():
    needed = math.ceil(math.log(19.0) / math.log(0.99 / 0.98))
    assert sprt([True] * 400, ABOVE) == ("met", needed)
    assert sprt([True] * (needed - 1), ABOVE) == ("open", needed - 1)


def test_failures_refute():
    needed = math.ceil(math.log(19.0) / math.log(0.02 / 0.01))
    assert sprt([False] * 400, ABOVE) == ("not met", needed)


@pytest.mark.parametrize(("rate", "wrong"), [(0.90, "met"), (0.95, "not met")])
def test_wrong_decisions_are_no_more_frequent_than_required(rate, wrong):
    rule, rng = Rule(require=0.90), np.random.default_rng(3)
    said = [sprt((rng.random(3000) < rate).tolist(), rule).verdict for _ in range(1000)]
    assert said.count("open") == 0
    assert 0.0 < said.count(wrong) / 1000 <= rule.risk + 0.01


def test_a_clear_case_is_decided_much_earlier_than_a_fixed_sample_would():
    rule, rng = Rule(require=0.90), np.random.default_rng(4)
    runs = [sprt((rng.random(3000) < 0.99).tolist(), rule).after for _ in range(200)]
    assert np.mean(runs) < 80.0  # 240 give such an interval at 0.95


def test_an_interval_is_narrow_when_it_is():
    flown = ([True] * 9 + [False]) * 100
    n = narrow_at(flown, 0.1)
    assert n is not None
    assert wilson(sum(flown[:n]), n).width <= 0.1 < wilson(sum(flown[: n - 1]), n - 1).width
    assert narrow_at([True] * 1000, 0.9) == LEAST_RUNS
    assert narrow_at(flown[:50], 0.01) is None


def rows(count, variants=1, outcome="success"):
    return [row(n, outcome, variant=n % variants) for n in range(count)]


def test_a_campaign_stops_when_every_variant_is_decided():
    rule = Rule(require=0.5, risk=0.1)
    first = decision(rows(40), rule, 0)
    assert first is not None
    assert enough(rows(40), rule, 1) == first.after
    assert enough(rows(40, variants=2), rule, 2) == 2 * first.after
    lagging = [row(n, variant=0) for n in range(40)]
    assert enough(lagging, rule, 2) is None


def test_the_last_variant_to_be_decided_decides():
    rule = Rule(require=0.9)
    flown = [row(n, "success" if n % 2 == 0 else "crash", variant=n % 2) for n in range(200)]
    late, early = (decision(flown, rule, v) for v in (0, 1))
    assert (late.verdict, early.verdict) == ("met", "not met")
    assert enough(flown, rule, 2) == 2 * late.after > 2 * early.after


def test_runs_that_were_in_flight_when_it_was_decided_do_not_count():
    plan = Campaign(mission="m", name="m", runs=50, digest="", rule=Rule(require=0.5))
    needed = decision(rows(50), plan.rule, 0).after
    some = rows(needed + 3)
    assert [it.number for it in counted(reversed(some), plan)] == list(range(needed))
    gap = [it for it in some if it.number != 2]
    assert len(counted(gap, plan)) == needed + 2


def test_both_wishes_have_to_be_fulfilled():
    many = rows(400)
    narrow, shown = Rule(width=0.05), Rule(require=0.5)
    both = Rule(width=0.05, require=0.5)
    each = enough(many, narrow, 1), enough(many, shown, 1)
    assert None not in each
    assert enough(many, both, 1) == max(each)
    assert enough(many, Rule(), 1) is None


def test_runs_that_broke_count_against_the_mission():
    assert enough(rows(400, outcome="hung"), ABOVE, 1) == 5
