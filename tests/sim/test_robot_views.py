"""Pictures to train on: the truth is where the robots are drawn, and the shipped detectors see."""

from __future__ import annotations

import numpy as np
import pytest

from missionkit.messages import Frame
from missionkit.perception.ground_plane import ViewNoise, on_ground
from missionkit.perception.haar.detector import Haar
from missionkit.perception.template.detector import Template
from missionkit.plugin_protocols import Prior
from missionkit.sim.detector_samples import TRAINING, of_worlds, sample_of, variations_of
from missionkit.sim.robot_look import ROBOT
from missionkit.sim.robot_views import floors, robot_views
from missionkit.sim.world import World

PLAIN = TRAINING._replace(worlds=floors(("concrete",)), towers=0.0, height=(1.5, 3.0))


@pytest.fixture(scope="module")
def views():
    return list(robot_views(PLAIN, 16, seed=90))


@pytest.mark.parametrize(("detector", "share"), [(Haar(), 0.9), (Template(), 0.3)])
def test_the_shipped_detectors_find_robots_and_where_they_stand(views, detector, share):
    robots = found = false = 0
    for view in views:
        truth = sample_of(view)
        boxes = detector.boxes(Frame(0.0, view.image), view.camera, Prior(view.body, None))
        places = [np.array(robot[:2]) for robot in view.robots]
        for box in boxes:
            spot = on_ground(
                box, view.camera, view.body, 0.0, ViewNoise(), ROBOT.diameter, ROBOT.height
            )
            near = min((float(np.hypot(*(spot.position - it))) for it in places), default=9.0)
            found += near < 0.05
            false += near > 0.2
            if near < 0.05:
                assert 0.8 < spot.size < 1.25
        robots += len(truth.places)
    assert robots > 12
    assert found >= share * robots
    assert false <= 2


def test_pictures_are_a_function_of_the_seed(views):
    again = next(robot_views(PLAIN._replace(robots=3), 16, seed=91))
    same = next(robot_views(PLAIN._replace(robots=3), 16, seed=91))
    assert again.robots == same.robots
    np.testing.assert_array_equal(again.image, same.image)
    assert not np.array_equal(again.image, views[0].image)


def test_what_is_hidden_or_cut_counts_neither_way():
    towers = PLAIN._replace(towers=1.0, height=(3.0, 3.3))
    for view in robot_views(towers, 3, seed=5):
        sample = sample_of(view)
        assert not len(sample.places)
        assert len(sample.others) >= 8 * len(view.robots)


def test_worlds_bring_their_floors_and_plates():
    world = World.model_validate({"world": "a", "ground": {"texture": "lines"}, "robots": {}})
    domain = of_worlds([world])
    assert domain.worlds == (world,)
    assert domain.plates == (95.0, 150.0)
    assert of_worlds([]) == TRAINING
    assert {it.world for it in variations_of(domain)["other floors"].worlds} == {"lines", "grass"}
