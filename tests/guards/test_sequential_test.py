"""Wald's test: its boundaries, its error rates, and how long it takes."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pydantic import ValidationError
from samples import calm

from missionkit.guards.sequential_test import Sprt
from missionkit.messages import Look
from missionkit.recorder import value_codec

HIT, MISS = Look(0.0, frozenset({"pole"})), Look(0.0, frozenset())


def fed(guard, looks):
    memory, answers = guard.begin(), []
    for look in looks:
        memory = guard.advance(memory, calm(looks=(look,)))
        answers.append(guard.check(memory, calm()).holds)
    return memory, answers


def decisions(guard, share, runs, seed):
    """First decision of many tests and the frames each took, for detections with a given share."""
    rng = np.random.default_rng(seed)
    found, frames = [], []
    for _ in range(runs):
        state = guard.begin()
        while state.present is None:
            state = guard.taken(state, found=bool(rng.random() < share))
        found.append(state.present)
        frames.append(state.frames)
    return np.mean(found), np.mean(frames)


@pytest.mark.parametrize(("alpha", "beta"), [(0.05, 0.05), (0.01, 0.1)])
def test_error_rates_are_within_walds_bounds(alpha, beta):
    guard = Sprt(target="pole", p0=0.1, p1=0.4, alpha=alpha, beta=beta)
    runs = 4000
    false_alarm, _ = decisions(guard, 0.1, runs, 1)
    hit, _ = decisions(guard, 0.4, runs, 2)
    for rate, bound in ((false_alarm, alpha / (1 - beta)), (1 - hit, beta / (1 - alpha))):
        assert rate <= bound + 3 * math.sqrt(bound * (1 - bound) / runs)
        assert rate >= 0.2 * bound


def test_it_takes_about_as_many_frames_as_wald_says():
    guard = Sprt(target="pole", p0=0.1, p1=0.4, alpha=0.05, beta=0.05)
    up, down = math.log(0.4 / 0.1), math.log(0.6 / 0.9)
    for share, present in ((0.1, 0.05), (0.4, 0.95)):
        drift = share * up + (1 - share) * down
        wanted = (present * guard.upper + (1 - present) * guard.lower) / drift
        _, frames = decisions(guard, share, 3000, 3)
        assert wanted <= frames <= 1.5 * wanted


def test_unknown_until_it_has_decided_and_then_it_starts_again():
    guard = Sprt(target="pole", p0=0.2, p1=0.8, alpha=0.1, beta=0.1)
    # each frame is worth ln 4, the boundaries are ± ln 9: two in a row decide
    _, answers = fed(guard, [HIT, MISS, HIT, HIT, MISS, HIT, MISS, MISS, MISS])
    assert answers == [None, None, None, True, True, True, True, False, False]


def test_value_threshold_and_margin_say_what_would_change_the_answer():
    guard = Sprt(target="pole", p0=0.2, p1=0.8, alpha=0.1, beta=0.1)
    memory, _ = fed(guard, [HIT])
    verdict = guard.check(memory, calm())
    assert verdict.holds is None
    assert verdict.value == pytest.approx(math.log(4))
    assert verdict.threshold == pytest.approx(math.log(9))
    assert verdict.why == "not decided yet: log likelihood ratio of 1 frames"
    memory, _ = fed(guard, [HIT, HIT, MISS])
    verdict = guard.check(memory, calm())
    assert verdict.holds is True
    assert verdict.threshold == pytest.approx(-math.log(9))
    assert verdict.margin == pytest.approx(math.log(9) - math.log(4))
    assert value_codec.read(value_codec.written(memory)) == memory


def test_a_dead_camera_proves_absence():
    guard = Sprt(target="pole")
    silent = Look(0.0, frozenset(), silent=True)
    assert fed(guard, [HIT] * 10 + [silent] * 20)[1][-1] is False


def test_the_region_is_a_latch():
    guard = Sprt(target="pole", p0=0.2, p1=0.8, alpha=0.1, beta=0.1)
    region = guard.region()
    (may,), (surely,) = region.may[0].values(), region.surely[0].values()
    rng, memory = np.random.default_rng(5), guard.begin()
    for _ in range(300):
        memory = guard.advance(memory, calm(looks=(HIT if rng.random() < 0.5 else MISS,)))
        verdict = guard.check(memory, calm())
        if verdict.holds:
            assert verdict.value > may.low
        if verdict.value >= surely.low:
            assert verdict.holds
    assert next(iter(region.may[0])).sees == "pole"


def test_the_two_shares_must_be_apart():
    with pytest.raises(ValidationError, match="must be below p1"):
        Sprt(target="pole", p0=0.6, p1=0.6)
