"""The kinematic study of herding: its model of landings and touches, and a small page."""

from __future__ import annotations

import math

import numpy as np
import pytest

from missionkit.ground_robot import GroundRobot
from missionkit.planning.herding import robot_forecast as fc
from missionkit.sim import ground_robots as gr
from studies import herding, herding_figure, herding_flights
from studies import herding_kernels as hk
from studies.herding_run import Run, start

ROBOT = GroundRobot()


def scene_of(east, action, *, lead=0.5, obstacle=None):
    """Return a run in which robot 0 drives north, the vehicle 1 m ahead and `east` of it."""
    scene = start(0)
    scene.truth[:, :2] = 100.0 + 5.0 * np.arange(len(scene.truth))[:, None]
    scene.fate[1:10] = fc.LOST
    scene.truth[0] = gr.placed(np.zeros((1, 2)), np.zeros(1), np.full(1, 19.0), ROBOT, obstacles=0)
    scene.vehicle[:2] = 1.0, east
    if obstacle is not None:
        scene.truth[-1, :2], scene.truth[-1, gr.HEADING] = obstacle, math.pi / 2.0
    facts = hk.Facts(lead=lead)
    order = hk.Order(action, 0)
    rng = np.random.default_rng(0)
    now = 0.0
    while now < 12.0 and not scene.counts.any():
        now = hk.fly(scene, order, facts, ROBOT, (now, now + 0.05), rng)
    return scene, now


def test_a_landing_in_front_is_a_bump_and_turns_it_round():
    scene, now = scene_of(0.5, hk.FRONT)
    assert scene.counts.tolist() == [1.0, 0.0, 0.0, 0.0, 0.0]
    assert scene.caused[0] == ROBOT.spin_time
    assert 1.5 < now < 5.0


def test_a_landing_that_leads_too_little_is_a_touch_on_top():
    scene, _ = scene_of(0.5, hk.FRONT, lead=0.3)
    assert scene.counts[[hk.BUMPS, hk.MISTAKES]].tolist() == [0.0, 1.0]
    assert scene.caused[0] == 0.25 * ROBOT.spin_time


def test_a_touch():
    scene, _ = scene_of(0.5, hk.TOP)
    assert scene.counts[hk.TOUCHES] == 1.0


def test_it_keeps_out_of_an_obstacle_robots_way():
    """The tower drives across the place of the landing."""
    scene, now = scene_of(0.5, hk.FRONT, obstacle=(1.5, -2.0))
    assert scene.counts[hk.HITS] == 0.0
    assert now > 6.0
    scene, now = scene_of(0.5, hk.FRONT, obstacle=(1.0, 0.55))
    assert scene.counts[hk.HITS] == 1.0  # it began inside


def test_the_page(tmp_path):
    runs = [Run(8, 1, 1, 30, 0, 1, 2, hit=False), Run(6, 3, 1, 28, 0, 0, 2, hit=True)]
    headline = {row.name: runs for row in herding.HEADLINE}
    more = {row.name: runs[:1] for row in (*herding.SENSITIVITY, herding.ABLATION)}
    text = herding.page(headline, more, 7, "the command")
    assert "$" not in text
    assert "50.0 % [9.5, 90.5]" in text
    assert "1 of 2" in text
    played, _ = text.split("## The mission")
    assert played.count("\n| ") == 2 + len(herding.HEADLINE) + len(herding.SENSITIVITY)
    herding_figure.draw(tmp_path / "a.png", {herding.FRONT.name: runs})
    assert (tmp_path / "a.png").stat().st_size > 10_000


@pytest.mark.parametrize("row", [herding.FRONT, herding.NEAR_BOTH])
def test_a_run_is_the_same_twice(row):
    one, two = (herding.run(3, row.policy, row.facts) for _ in range(2))
    assert one == two
    assert one.home + one.removed + one.remained == 10
    assert one.home >= 5


def test_the_flights_in_words():
    one = herding_flights.Flight(500, 8, 0, 2, 25, 1, False, 0.3, 0.11, 593.0, 180.0, "")
    two = one._replace(seed=501, home=5, crashed=True, clearance=-0.02, duration=300.0)
    text = herding_flights.verdict((one, two))
    assert "At least seven home: 1 of 2 (50 % [9, 91])" in text
    assert "no crash: 1 of 2" in text
    assert "Nearest to a tower in any flight: -0.02 m" in text
    assert "2.5 times real time" in text
    assert herding_flights.cells(one)[:5] == ("500", "8", "0", "2", "25, 1")
    assert herding_flights.cells(two)[-1] == "crash at 300 s"
