from __future__ import annotations

import pytest

from missionkit.campaigns.campaign_plan import Campaign
from missionkit.campaigns.variants import axes, name_of, variants
from missionkit.errors import UsageError


def test_every_combination_is_a_variant():
    over = axes(["a=1,2", "b=[1,2],[3,4]"])
    assert [name_of(it) for it in variants(over)] == [
        "a = 1, b = [1,2]",
        "a = 1, b = [3,4]",
        "a = 2, b = [1,2]",
        "a = 2, b = [3,4]",
    ]
    assert variants(()) == ({},)


@pytest.mark.parametrize(
    ("texts", "fixed", "wrong"),
    [
        (["a"], (), "expected NAME=VALUE"),
        (["a=1,,2"], (), "expected NAME=VALUE"),
        (["a=1,1"], (), "twice"),
        (["a=1", "a=2"], (), "already set"),
        (["a=1"], ("a",), "already set"),
    ],
)
def test_what_makes_no_sense_is_refused(texts, fixed, wrong):
    with pytest.raises(UsageError, match=wrong):
        axes(texts, fixed)


def test_variants_share_their_seeds():
    plan = Campaign(mission="m", name="m", runs=3, seed=5, vary=axes(["a=1,2"]), digest="")
    cases = list(plan.cases())
    assert [it.number for it in cases] == list(range(6))
    assert [(it.seed, it.settings["a"]) for it in cases] == [
        (seed, a) for seed in (5, 6, 7) for a in "12"
    ]
