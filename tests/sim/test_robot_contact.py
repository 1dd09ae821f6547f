"""Robots in the simulated world: they meet the vehicle and the arena's sides by the rules."""

from __future__ import annotations

import math

import numpy as np
import pytest

from missionkit.ground_robot import GroundRobot
from missionkit.sim import ground_robots as of
from missionkit.sim import kernel_layout
from missionkit.sim.flight_grading import HerdGrade
from missionkit.sim.robot_contact import floor_of, leave, meet, start
from missionkit.sim.simulators import graded
from missionkit.sim.world import World

ROBOT = GroundRobot()
RADIUS = 0.2  # m, of the vehicle
REACH = 0.5 * ROBOT.diameter + RADIUS
NO_ROBOT = np.zeros(of.SIZE)


def robot(heading: float = 0.0):
    state = NO_ROBOT.copy()
    state[of.HEADING], state[of.REVERSAL_IN], state[of.TURN_IN] = heading, 9.0, 4.0
    return state


def met(state, north, east, height, *, before=None, sinking=0.0):
    """Let a vehicle at a place meet a robot at the origin; return its state and memory."""
    x, memory = np.zeros(17), np.zeros(kernel_layout.SIZE)
    x[:3], x[5] = (north, east, -height), sinking
    meet(x, height if before is None else before, memory, RADIUS, state, ROBOT)
    return x, memory


@pytest.mark.parametrize(
    ("bearing", "apart", "height", "bumps"),
    [
        (0.0, REACH - 0.01, 0.0, 1),
        (80.0, REACH - 0.01, 0.05, 1),
        (-80.0, REACH - 0.01, 0.05, 1),
        (100.0, REACH - 0.01, 0.0, 0),  # beside it, past the bumper
        (180.0, REACH - 0.01, 0.0, 0),
        (0.0, REACH + 0.01, 0.0, 0),
        (0.0, REACH - 0.01, 0.11, 0),  # it drives under the vehicle
    ],
)
def test_a_low_vehicle_before_the_bumper_turns_a_robot_by_half(bearing, apart, height, bumps):
    state = robot(heading=0.7)
    turn = 0.7 + math.radians(bearing)
    x, _ = met(state, apart * math.cos(turn), apart * math.sin(turn), height)
    assert (state[of.BUMPS], state[of.TOUCHES]) == (bumps, 0)
    assert state[of.SPIN_LEFT] == bumps * ROBOT.spin_time
    assert x[2] == -height


def test_a_vehicle_that_comes_down_on_the_plate_touches_it_once_and_rests_there():
    state = robot()
    x, memory = met(state, 0.3, 0.1, 0.098, before=0.102, sinking=1.0)
    assert (state[of.BUMPS], state[of.TOUCHES]) == (0, 1)
    assert state[of.SPIN_LEFT] == 0.25 * ROBOT.spin_time
    assert (x[2], x[5]) == (-0.1, 0.0)
    assert not memory[kernel_layout.CRASHED]
    state[of.SPIN_LEFT] = 0.0
    for height in (0.1, 0.097, 0.11, 0.099):  # it still presses
        met(state, 0.3, 0.1, height, before=0.1)
    assert state[of.TOUCHES] == 1
    met(state, 0.3, 0.1, 0.2)
    met(state, 0.3, 0.1, 0.09, before=0.11)
    assert state[of.TOUCHES] == 2


@pytest.mark.parametrize(("sinking", "hurt"), [(1.9, False), (2.1, True)])
def test_only_a_hard_touch_hurts_the_vehicle(sinking, hurt):
    _, memory = met(robot(), 0.0, 0.0, 0.09, before=0.11, sinking=sinking)
    assert bool(memory[kernel_layout.CRASHED]) == hurt


@pytest.mark.parametrize(
    ("place", "out"),
    [
        ((5.99, -8.0), 0.0),
        ((6.01, 1.0), of.LOST),
        ((-3.0, 2.01), of.HOME),
        ((-3.0, -18.01), of.LOST),
        ((-14.01, -8.0), of.LOST),
    ],
)
def test_a_robot_is_home_over_the_goals_side_and_lost_over_another(place, out):
    floor = floor_of(World(world="w", arena={"centre": (-4.0, -8.0), "side": 20, "goal": "east"}))
    state = robot()
    state[:2] = place
    leave(state, floor, 12.5)
    assert state[of.OUT] == out
    assert state[of.OUT_AT] == (12.5 if out else 0.0)


@pytest.fixture
def built(perfect, pilot):
    def make(seed: int = 1, **parts: object):
        body = {"mass": 0.6, "inertia": (0.004, 0.004, 0.007), "radius": RADIUS}
        plain = perfect.model_dump(exclude_unset=True)
        return pilot(World.model_validate({**plain, "quadrotor": body, **parts}), seed=seed)

    return make


def placed(*robots: tuple[float, float, float]):
    """Return a section with robots: north, east, heading in degrees."""
    return {
        "placed": [{"at": (n, e), "heading_deg": turn, "reversal": 19} for n, e, turn in robots]
    }


def test_robots_drive_into_the_standing_vehicle_and_off_the_floor(built):
    flown = built(
        robots=placed((1.0, 0.0, 180), (0.5, 3.0, 0), (0.0, 3.5, 90)), arena={"side": 8.0}
    )
    flown.wait(3.9)  # before the first random turn
    assert graded(flown.vehicle).herd == HerdGrade(
        0, 1, 2, (), pytest.approx((1.515,), abs=0.01), 1, 0
    )
    states, times = flown.vehicle.herd.states, flown.vehicle.herd.times
    assert np.hypot(*states[:, 0, :2].T).min() == pytest.approx(REACH, abs=0.005)
    spinning = times[states[:, 0, of.SPIN_LEFT] > 0.0]
    assert spinning[0] == pytest.approx((1.0 - REACH) / 0.33, abs=0.06)
    assert states[-1, 1, of.NORTH] == pytest.approx(0.5 + 3.9 * 0.33, abs=1e-5)
    driven = flown.vehicle.herd.driven()
    assert [it.end for it in driven] == ["", "", "lost"]
    assert driven[2].places[-1] == pytest.approx([0.0, 4.0], abs=0.2)  # and no farther


def test_a_tower_that_touches_the_vehicle_is_a_crash(built):
    towards = {"at": (2.0, 0.0), "heading_deg": 180.0, "tower": 1.0}
    flown = built(obstacle_robots={"circle": 200.0, "placed": [towards]})
    flown.wait(4.7)
    assert not flown.vehicle.truth.crashed
    assert flown.vehicle.truth.clearance == pytest.approx(2.0 - 4.7 * 0.33 - 0.4, abs=0.01)
    flown.wait(0.3)
    assert flown.vehicle.truth.crashed
    assert graded(flown.vehicle).herd is None


def test_a_flying_vehicle_touches_a_robot_on_top_and_climbs_away(built):
    flown = built(robots=placed((-1.0, 0.5, 0)))
    flown.rise(1.0)
    vehicle = flown.vehicle
    for _ in range(200):
        state, truth = vehicle.robots[0], vehicle.truth
        away = state[:2] - truth.position[:2]
        turn = state[of.HEADING]
        climb = 0.5 if np.hypot(*away) < 0.1 else 0.0
        north, east = 0.33 * np.array((np.cos(turn), np.sin(turn))) + 1.2 * away
        if state[of.TOUCHES] > 0:
            break
        flown.fly((north, east, climb), 0.05)
    flown.fly((0.0, 0.0, -0.5), 3.0)
    herd = graded(vehicle).herd
    assert (herd.touches, herd.bumps) == (1, 0)
    assert not vehicle.truth.crashed
    assert vehicle.truth.position[2] < -0.8
    spun = vehicle.herd.states[:, 0, of.SPIN_LEFT] > 0.0
    assert np.ptp(vehicle.herd.times[spun]) < 0.25 * ROBOT.spin_time


def test_without_robots_no_paths_are_driven(built):
    flown = built()
    flown.wait(0.2)
    assert flown.vehicle.herd.driven() == []
    assert graded(flown.vehicle).herd is None


def test_robots_follow_the_physics_clock_exactly_and_the_seed_alone():
    world = World(world="w", start=(-9.0, 0.0), robots={}, obstacle_robots={"circle": 3.0})
    herds = [start(world, np.random.default_rng(seed)) for seed in (4, 4, 5)]
    parts, whole, other = (it.robots for it in herds)
    assert np.array_equal(parts, whole)
    assert not np.array_equal(parts, other)
    offsets, robot, _ = herds[0].constants
    for _ in range(5000):
        of.advance(parts, offsets, robot, kernel_layout.DT)
    of.advance(whole, offsets, robot, 5000 * kernel_layout.DT)
    assert parts == pytest.approx(whole, abs=1e-6)
    assert np.hypot(*whole[10:, :2].T) == pytest.approx(3.0)  # around the middle, in circles
