"""Guidance leads no lower than the floor; a mission's own low places are below it."""

import numpy as np
import pytest
from rehearsed import precise_stage
from samples import calm

from missionkit.behaviors.go_to import GoTo
from missionkit.behaviors.land import Land
from missionkit.behaviors.spiral import Spiral
from missionkit.behaviors.take_off import TakeOff
from missionkit.control.velocity_limits import Limits
from missionkit.engine.flight_loop import Operator
from missionkit.engine.ground_floor import above_floor, floor_of
from missionkit.geometry import vec
from missionkit.messages import Setpoint
from missionkit.rehearsal.rehearse import rehearse

LIMITS = Limits()


TARGETS = {"trunk": -2.5, "pad": 0.0, "valley": 4.0}


class Foreign(GoTo):
    """Of another package."""


@pytest.mark.parametrize(
    ("behaviors", "floor"),
    [
        ([None, Land()], -1.0),
        ([TakeOff(height=3.0), GoTo(target="trunk")], -1.0),
        ([GoTo(target="trunk", standoff=(6.0, 0.0, -1.8))], -0.2),
        ([GoTo(target="home", height=0.8)], -0.3),
        ([GoTo(target="trunk"), GoTo(target="pad")], 0.5),
        ([GoTo(target="valley")], 4.5),
        ([Spiral(target="trunk", standoff=1.2)], -1.0),
        ([Foreign(target="trunk")], np.inf),
    ],
)
def test_the_floor_lies_under_the_lowest_place_of_the_mission(behaviors, floor):
    assert floor_of(behaviors, TARGETS) == pytest.approx(floor)


def at(down):
    return calm(position=vec(0.0, 0.0, down))


def test_the_descent_stops_above_the_floor_whatever_the_lag():
    """A vehicle that flies each command a lag later, from any height."""
    for start in np.linspace(-8.0, -0.5, 16):
        down, speed = float(start), 1.5
        for _ in range(800):
            wanted = Setpoint(vec(1.0, 2.0, 1.5), 0.1)
            sent = above_floor(wanted, at(down), -0.5, LIMITS)
            np.testing.assert_array_equal(sent.velocity[:2], wanted.velocity[:2])
            speed += (sent.velocity[2] - speed) * 0.05 / 0.3
            down += 0.05 * speed
        assert -0.6 < down < (-0.3 if start < -2.0 else 0.0)


def test_a_climb_is_left_alone_and_below_the_floor_it_climbs_slowly():
    for down in (-5.0, 3.0):
        up = Setpoint(vec(0.0, 0.0, -1.0), 0.0)
        assert above_floor(up, at(down), -0.5, LIMITS) is up
    still = Setpoint(vec(0.0, 0.0, 0.0), 0.0)
    sent = [above_floor(still, at(down), -1.0, LIMITS).velocity[2] for down in (-1.0, -0.7, 5.0)]
    assert sent == pytest.approx([0.0, -0.3, -0.5])


def test_a_camera_upside_down_does_not_lead_into_the_ground():
    """Its sightings of a marker that may hang in any way pull the target below it."""
    ready = precise_stage("camera_flipped", seed=4, upright=False)
    operator, heights = Operator(), []

    def watch(record, _):
        if record.state == "gps":
            heights.append(-ready.vehicle.truth.position[2])
        if record.now > 40.0:
            operator.land()

    done = rehearse(ready, [watch], operator=operator)
    assert min(heights[50:]) > 0.3
    assert done.grade.touched_at is None
