"""P3's Algorithm 1 as a guard, against the algorithm written out."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pydantic import ValidationError
from samples import calm

from missionkit.geometry import from_euler
from missionkit.goal_pose import facing
from missionkit.guards.markov_switch import MarkovSwitch
from missionkit.messages import Health, Target
from missionkit.recorder import value_codec

PAD = {"target": "pad", "activation": 1.0, "sensor_sd": 0.02}


def situation(r, *, d=0.5, turned=0.6, sd=0.01, known=True, attitude=None):
    """The pad r (m) to the north, facing the vehicle, which is turned by 2 asin(`turned`)."""
    pad = Target("pad", np.array([r, 0.0, -5.0]), sd, facing(math.pi), 0.1, 9.9)
    yaw = 2.0 * math.asin(turned)
    return calm(
        targets={"pad": pad},
        attitude=from_euler(0.0, 0.0, yaw) if attitude is None else attitude,
        health=Health(True, False, 10.0, None, sd, 0, mahalanobis=d if known else None),
    )


def flown(guard, situations):
    memory, answers = guard.begin(), []
    for seen in situations:
        memory = guard.advance(memory, seen)
        answers.append(guard.check(memory, seen).holds)
    return memory, answers


def algorithm_1(steps, *, r_t=1.0, r_d=0.1, r1=0.1, r2=0.3, sigma_r=0.02):
    """The mode after each step (r, d, |q_e|, sigma), by Algorithm 1, corrected (P3.1, P3.2)."""
    mode, modes = "approach", []
    for r, d, q, sigma in steps:
        if mode != "align" and r1 < r <= r_t:
            if mode == "approach":
                if min(1.0, (r / r_t) / ((1 + d) * max(q, 1e-9))) <= 0.4 or r <= r2:
                    r2, mode = r, "reorient"
            else:
                a23 = 1 - min(1.0, (r / r2) / (1 + d))
                a32 = min(max(sigma / sigma_r * (r2 - r) / (r2 - r_d), 0.0), 1.0)
                if a23 + a32 > 0 and a23 / (a23 + a32) <= 0.6:
                    r1, mode = r, "align"
        elif r <= r1:
            mode = "align"
        modes.append(mode)
    return modes


@pytest.mark.parametrize("seed", range(20))
def test_it_switches_where_the_algorithm_does(seed):
    rng = np.random.default_rng(seed)
    ranges = np.linspace(1.3, 0.05, 120)
    q = rng.uniform(0.05, 0.95)
    steps = [(r, rng.uniform(0.0, 1.5), q, rng.uniform(0.0, 0.04)) for r in ranges]
    seen = [situation(r, d=d, turned=q, sd=sigma) for r, d, q, sigma in steps]
    modes = algorithm_1(steps)
    _, reorient = flown(MarkovSwitch(**PAD, to="reorient"), seen)
    _, align = flown(MarkovSwitch(**PAD, to="align"), seen)
    assert reorient == [mode != "approach" for mode in modes]
    assert align == [mode == "align" for mode in modes]
    assert modes[-1] == "align"


def test_the_closed_form_of_the_first_switch():
    """r2 = 0.4 r_t (1 + d) |q_e|."""
    guard = MarkovSwitch(**PAD, to="reorient")
    limit = 0.4 * (1 + 0.5) * 0.8
    _, (before,) = flown(guard, [situation(limit + 1e-6, turned=0.8)])
    _, (after,) = flown(guard, [situation(limit - 1e-6, turned=0.8)])
    assert (before, after) == (False, True)


def test_an_aligned_vehicle_causes_no_division_by_zero():
    guard = MarkovSwitch(**PAD, to="reorient")
    seen = situation(0.8, turned=0.0)
    memory, _ = flown(guard, [seen])
    assert guard.check(memory, seen).value == 1.0


def test_modes_are_latched_and_the_verdict_shows_the_factors():
    guard = MarkovSwitch(**PAD, to="reorient")
    memory, answers = flown(guard, [situation(r) for r in (0.9, 0.3, 0.9, 1.1)])
    assert answers == [False, True, True, True]
    verdict = guard.check(memory, situation(0.9))
    assert verdict.why == "reorient: r 0.9 m, d 0.5, |q_e| 0.6, sd 0.01 m"
    assert (verdict.value, verdict.threshold) == (1.0, 0.4)
    assert value_codec.read(value_codec.written(memory)) == memory
    align = MarkovSwitch(**PAD, to="align")
    memory, _ = flown(align, [situation(r) for r in (0.9, 0.3, 0.28)])
    assert "A23 0.378, A32 0.05, r2 0.3 m" in align.check(memory, situation(0.28)).why


def test_it_begins_again_beyond_the_activation_distance():
    guard = MarkovSwitch(**PAD, to="reorient")
    _, answers = flown(guard, [situation(r) for r in (0.3, 1.19, 1.21, 0.9)])
    assert answers == [True, True, False, False]


def test_with_an_unknown_input_the_mode_is_kept():
    guard = MarkovSwitch(**PAD, to="reorient")
    _, answers = flown(guard, [situation(0.2, known=False), situation(0.3), calm()])
    assert answers == [None, True, True]


def test_where_both_probabilities_are_zero_the_mode_is_kept():
    guard = MarkovSwitch(**PAD, to="align")
    seen = situation(0.3, d=0.0, sd=0.0)
    memory, answers = flown(guard, [seen, seen, seen])
    assert answers == [False, False, False]
    assert memory.mode == "reorient"
    assert guard.check(memory, seen).value is None


def test_the_keep_out_distance_bounds_r1():
    guard = MarkovSwitch(**PAD, to="align", keep_out=0.2)
    calm_steps = [situation(r, d=1.0, sd=0.0) for r in (0.9, 0.29, 0.25, 0.21, 0.19)]
    memory, answers = flown(guard, calm_steps)
    assert answers == [False, False, False, False, True]
    assert memory.r1 == 0.2


def test_misalignment_is_from_facing_the_marker_or_from_its_own_attitude():
    facing_it = situation(0.5, turned=0.0)
    as_it_is = situation(0.5, attitude=facing(math.pi))
    for guard, seen in (
        (MarkovSwitch(**PAD, to="reorient"), facing_it),
        (MarkovSwitch(**PAD, to="reorient", attitude="same"), as_it_is),
    ):
        memory, _ = flown(guard, [seen])
        assert guard.check(memory, seen).value == 1.0


@pytest.mark.parametrize("wrong", [{"r1": 0.5}, {"r2": 1.5}, {"docked": 0.3}, {"keep_out": 0.4}])
def test_distances_in_the_wrong_order_are_refused(wrong):
    with pytest.raises(ValidationError, match=r"expected r1 and keep_out|must be below r2"):
        MarkovSwitch(**PAD, to="align", **wrong)
