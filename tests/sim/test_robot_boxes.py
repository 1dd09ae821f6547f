"""Boxes of a camera that does not render: where robots stand, noisy, sometimes missing or false."""

from __future__ import annotations

import numpy as np
import pytest

from missionkit.geometry import Transform, from_euler, vec
from missionkit.perception.camera_section import Camera, Mount
from missionkit.perception.ground_plane import ViewNoise, on_ground
from missionkit.sim.fault_injection import parse_fault
from missionkit.sim.robot_boxes import BoxSpotter
from missionkit.sim.robot_look import ROBOT, RobotLook
from missionkit.sim.simulated_vehicle import SimulatedVehicle
from missionkit.sim.world import World

DOWN = Camera(
    use="corners", width=320, height=240, focal=277.0, latency=0.0, mount=Mount(tilt_deg=90.0)
)
LENS = DOWN.model()
BODY = Transform(from_euler(0.05, -0.1, 0.4), vec(3.0, -2.0, -2.5))
ROBOTS = (RobotLook(3.3, -1.8, 0.0, 150), RobotLook(2.6, -2.2, 1.0, 95))


def grounded(box):
    found = on_ground(box, LENS, BODY, 0.0, ViewNoise(), ROBOT.diameter)
    assert found is not None
    return found


def frames(count=1500, robots=ROBOTS, **world):
    spotter = BoxSpotter(World(world="w", **world), LENS, np.random.default_rng(3))
    return [spotter.find(BODY, robots) for _ in range(count)]


def test_boxes_show_where_robots_stand_with_noise_misses_and_false_ones():
    seen = frames()
    found = [grounded(box) for boxes in seen for box in boxes]
    places = np.array([it.position for it in found])
    near = [np.hypot(*(places - (it.north, it.east)).T) < 0.08 for it in ROBOTS]
    for robot, mine in zip(ROBOTS, near, strict=True):
        assert mine.mean() * len(found) / len(seen) == pytest.approx(0.96, abs=0.02)
        off = places[mine] - (robot.north, robot.east)
        assert off.mean(axis=0) == pytest.approx([0.0, 0.0], abs=0.002)
        assert off.std(axis=0) == pytest.approx([1.5 * 2.5 / 277] * 2, rel=0.15)
    sizes = np.array([it.size for it in found])[near[0] | near[1]]
    assert sizes.mean() == pytest.approx(1.0, abs=0.02)
    assert sizes.std() == pytest.approx(0.1, abs=0.01)
    false = len(found) - int((near[0] | near[1]).sum())
    assert false / len(seen) == pytest.approx(0.05, abs=0.02)
    assert {box.kind for boxes in seen for box in boxes} == {"robot"}


def test_a_tower_makes_its_box_larger_and_a_wall_hides_a_robot():
    tall = RobotLook(3.3, -1.8, 0.0, 205, 1.5)
    sizes = [
        grounded(box).size for boxes in frames(50, (tall,)) for box in boxes if box.score > 0.6
    ]
    assert 1.5 < np.mean(sizes) < 2.5
    roof = {"use": "box", "min": (3.1, -2.0), "max": (3.6, -1.5), "height": 1.0, "bottom": 0.9}
    hidden = [box for boxes in frames(50, ROBOTS[:1], obstacles=(roof,)) for box in boxes]
    assert len(hidden) < 10  # only false ones


def observed(seed: int, *faults: str, robots=True):
    world = World.model_validate(
        {"world": "w", "start": [0.0, 0.8], **({"robots": {}} if robots else {})}
    )
    vehicle = SimulatedVehicle(world, DOWN, seed, tuple(map(parse_fault, faults)))
    vehicle._plant.state[2] = -2.0  # falls, the faster the longer
    return vehicle.advance(0.1).frame.boxes


def test_a_frame_has_boxes_by_the_seed():
    first, again, other = observed(1), observed(1), observed(2)
    assert first
    assert [box.centre.tolist() for box in first] == [box.centre.tolist() for box in again]
    assert [box.centre.tolist() for box in first] != [box.centre.tolist() for box in other]
    assert observed(1, robots=False) == ()


def test_an_image_upside_down_has_its_boxes_upside_down():
    turned = observed(1, "camera_flipped")
    assert np.array([(319, 239) - box.centre for box in turned]) == pytest.approx(
        np.array([box.centre for box in observed(1)])
    )
