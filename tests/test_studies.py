"""The studies: their statistics against scipy, and two flights of each kind end to end."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import binomtest

from studies import precision_task, tables
from studies.clearance import on_the_way
from studies.flight import Order, Outcome, fly_all, setting
from studies.losses import Loss, losses_of
from studies.markdown import table
from studies.report import Results, why
from studies.statistics import rms, spread, wilson
from studies.watch import Change


@pytest.fixture(scope="module")
def results():
    nominal = precision_task.nominal(range(2), "corners")
    hidden = precision_task.hidden([0], "corners")
    cells = precision_task.swept([0], ["camera_off"])
    cells = {key: cells[key] for key in list(cells)[:1]}
    return precision_task.flown(nominal, hidden, cells, workers=1)


@pytest.mark.parametrize(
    ("successes", "n"), [(0, 1), (1, 1), (0, 20), (3, 20), (98, 100), (100, 100)]
)
@pytest.mark.parametrize("confidence", [0.9, 0.95, 0.99])
def test_wilson_is_that_of_scipy(successes, n, confidence):
    reference = binomtest(successes, n).proportion_ci(confidence, method="wilson")
    assert wilson(successes, n, confidence) == pytest.approx(tuple(reference), abs=1e-12)


@pytest.mark.parametrize(("successes", "n"), [(0, 0), (3, 2), (-1, 5)])
def test_wilson_refuses_what_cannot_be(successes, n):
    with pytest.raises(ValueError, match=f"{successes} successes of {n}"):
        wilson(successes, n)


def test_spread_and_rms():
    values = np.arange(101.0)
    assert spread(values) == (0.0, 50.0, 95.0, 100.0)
    assert rms([3.0, 4.0]) == pytest.approx(12.5**0.5)


def test_table_columns_are_aligned():
    assert table(("a", "long"), [("1234", "x")]).splitlines() == [
        "| a    | long |",
        "|------|------|",
        "| 1234 | x    |",
    ]


def test_nominal_flights_are_measured(results):
    for run in results.nominal:
        assert run.path == "gps → visual → task → return → land"
        assert run.outcome is Outcome.FINISHED
        assert run.grade.visit.position_error < 0.1
        assert 5.0 < run.stays("visual")[0] < 20.0
        last = [s.relative for s in run.samples if s.state == "task"]
        assert rms(last) < 0.1  # the vector to the marker, against the truth


def test_a_hidden_marker_is_lost_after_2_s_and_found_again(results):
    (loss,) = losses_of(results.hidden)
    assert 2.0 <= loss.lost <= 2.2
    assert 1.0 <= loss.found <= 15.0


def test_a_loss_is_timed_from_the_last_sighting_and_from_the_end_of_the_cover(results):
    changes = (
        Change(30.0, "gps", "visual", "", 0.1),
        Change(35.05, "visual", "search", "", 2.05),
        Change(40.5, "search", "visual", "", 0.1),
    )
    order = Order(0, "corners", ("marker_hidden@visual:3+6",))
    run = results.hidden[0]._replace(order=order, changes=changes)
    assert list(losses_of([run])) == [Loss(2.05, 40.5 - 39.0)]


def test_losses_count_only_covered_time(results):
    assert not list(losses_of(results.nominal))


def test_a_lasting_fault_prevents_success_and_the_reason_is_given(results):
    (run,) = results.swept
    assert run.order.faults == ("camera_off@gps:8",)
    assert (run.outcome, why(run)) == (Outcome.SAFE, "never reached the task")


def test_success_without_the_injection_is_distinguished(results):
    run = results.nominal[0]
    lost = tuple(change for change in run.changes if change.to != "return")
    assert run._replace(changes=lost).outcome is Outcome.UNFINISHED


def test_the_page_holds_every_table_and_the_pictures_are_drawn(results, tmp_path):
    precision_task.write(results, tmp_path, "the command")
    text = (tmp_path / "precision_task.md").read_text(encoding="utf-8")
    assert "34.2 to 100.0 %" in text
    assert "| `camera_off` | 0 / 0 / 1 / 0" in text
    assert "mass 1.6 (kg)" in text
    assert "$" not in text
    for name in ("precision_task.png", "precision_task_faults.png"):
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")


def test_a_miss_is_listed_with_its_seed_and_transitions(results):
    run = results.nominal[1]
    missed = run._replace(succeeded=False)
    text = precision_task.page(Results([missed], [], {}), "")
    assert "- `--seed 1 `: entered the task" in text
    assert "gps → visual (when marker-sure" in text


def test_workers_and_this_process_fly_the_same_flight(results):
    assert list(fly_all([Order(1, "corners")], workers=2)) == [results.nominal[1]]


def test_delays_are_spread_over_the_approach():
    orders = precision_task.hidden(range(8), "corners")
    assert [order.faults[0] for order in orders[5:7]] == [
        "marker_hidden@visual:6+6",
        "marker_hidden@visual:1+6",
    ]


def test_clearance_on_the_way_leaves_out_the_trunk():
    _, world = setting()
    marker = world.marker(23)
    beside_the_trunk = np.array([[83.5, 12.3, -2.5], [45.0, 12.0, -3.0]])
    expected = 4.0 - 1.0 - world.quadrotor.radius  # to the cylinder at (45, 8), radius 1
    assert on_the_way(world, marker, beside_the_trunk) == pytest.approx(expected)


def test_faults_carry_the_value_they_are_flown_with():
    faults = {name for name, _ in precision_task.swept([0])}
    assert {"camera_off", "gnss_jump=10", "battery_sag=0.7"} <= faults


def test_estimates_are_pooled_by_state(results):
    lines = tables.estimates(results.nominal).splitlines()
    assert [line.split()[1] for line in lines[2:]] == [
        "idle",
        "gps",
        "visual",
        "task",
        "return",
        "land",
    ]


def test_the_mission_under_study_is_the_precision_task():
    mission, world = setting()
    assert (mission.name, world.world) == ("precision-task", "orchard")
