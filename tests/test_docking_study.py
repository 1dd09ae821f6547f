"""The study of the docking: what it makes of its flights, and two flights end to end."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

from studies import docking, docking_flight
from studies.docking_flight import RULES, Docking, Order, flown, pose_of
from studies.docking_results import chosen, gain, pairs, share

FACTOR = {"fixed": 1.0, "markov_printed": 0.92, "markov_safe": 0.96, "ours": 0.9}


def flight(order: Order, *, docked: bool = True) -> Docking:
    """Make up a flight: its time depends on seed and rule."""
    rng = np.random.default_rng(order.seed)
    time = FACTOR[order.rule] * rng.normal(140.0, 1.0) if docked else math.nan
    path = tuple((1.0 - 0.01 * n, 1.9 - 0.01 * n, 1.0) for n in range(90))
    return Docking(
        order,
        **{"docked": docked, "crashed": not docked, "succeeded": docked},
        **{"time": time, "impulse": 0.08 * time, "position_error": 0.005, "attitude_error": 1e-3},
        **{"turned": 0.8, "aligned": 0.3, "centres": 0.2, "separation": 0.03, "sideways": 0.01},
        states=("idle", "docked"),
        path=path,
    )


@pytest.fixture(scope="module")
def runs():
    return [flight(order) for order in docking.orders(5, 8, 3)]


def test_every_rule_flies_the_same_seeds_and_every_condition_by_two():
    found = docking.orders(5, 8, 3)
    assert len(set(found)) == len(found)
    for rule in RULES:
        assert [it.seed for it in found if it[:2] == (rule, "paper")] == list(range(5, 13))
    for variant in docking.ROWS:
        seeds = [[it.seed for it in found if it[:2] == (r, variant)] for r in ("fixed", "ours")]
        assert seeds[0] == seeds[1] == [5, 6, 7]


def test_differences_are_those_of_the_same_seed(runs):
    found = gain(chosen(runs, "fixed"), chosen(runs, "ours"), "time")
    assert found.value == pytest.approx(-10.0)
    assert found.low == pytest.approx(found.high)  # pairs differ by the same factor


def test_a_flight_that_did_not_dock_makes_no_pair():
    fixed = [flight(Order("fixed", "paper", seed)) for seed in range(4)]
    ours = [flight(Order("ours", "paper", seed), docked=seed != 2) for seed in range(4)]
    assert len(pairs(fixed, ours, "time")) == 3
    assert share(ours).startswith("3 of 4 (")


def test_the_page_says_what_the_flights_gave(runs, tmp_path):
    docking.write(runs, tmp_path, "a command")
    page = (tmp_path / "docking.md").read_text()
    assert docking.verdict(runs) in page
    assert "time -10.0 % [-10.0, -10.0]" in page
    assert not re.search(r"\$[a-z]", page)
    for name in ("docking_paths.png", "docking_distances.png"):
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")


def test_flights_that_were_kept_are_not_flown_again(monkeypatch, tmp_path):
    wanted, file = docking.orders(1, 2, 0), tmp_path / "flights.jsonl"
    asked = []

    def fly(orders, workers):
        asked.append((len(orders), workers))
        return (flight(order, docked=order.seed == 1) for order in orders)

    monkeypatch.setattr(docking, "fly_all", fly)
    first = docking.fly_missing(wanted[:5], file, 1)
    again = docking.fly_missing(wanted, file, 1)
    assert asked == [(5, 1), (3, 1)]
    assert [run.order for run in again] == wanted
    assert [run.as_json() for run in again[:5]] == [run.as_json() for run in first]


def test_starts_are_before_the_target_over_the_anchors():
    places = np.array([pose_of(seed)[0] for seed in range(100)])
    assert (places >= [-1.0, 0.6, -0.5]).all()
    assert (places <= [1.0, 1.2, 0.5]).all()


def test_a_flight_through_the_target_and_one_that_hits_it():
    through, into = (flown(Order("markov_printed", name, 3)) for name in ("paper", "solid"))
    assert through.docked
    assert not through.succeeded  # its clearance was below 0
    assert through.aligned < 0.15
    assert through.separation < 0.0
    assert into.crashed
    assert not into.docked
    assert math.isnan(into.time)
    assert docking_flight.Docking.of_json(through.as_json()) == through
