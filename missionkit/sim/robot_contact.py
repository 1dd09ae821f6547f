"""Ground robots in the simulated world: their start, the vehicle's contacts, the arena's sides.

Imported late: it compiles kernels.

- The vehicle lower than a robot's plate, before its bumper and no farther than both radii: a bump.
- The vehicle that sinks through the height of the plate over the robot, as far: a touch on top. It
  rests on the plate, which does not carry it along; a touch faster than one of the ground may be is
  a crash. The next touch counts once it has risen.
- An obstacle robot and its tower are an upright cylinder among the obstacles.
"""

from __future__ import annotations

import math
from typing import Final, NamedTuple

import numpy as np

from missionkit.geometry import Mat, Vec3
from missionkit.ground_robot import GroundRobot
from missionkit.jit import compiled
from missionkit.sim import ground_robots as of
from missionkit.sim import kernel_layout as at
from missionkit.sim.arena import HIT_RADIUS
from missionkit.sim.obstacle_distance import CYLINDER_ROW
from missionkit.sim.rigid_body import HARD
from missionkit.sim.world import World

RELEASED: Final = 0.02  # m above the plate
LENGTH: Final = 7200.0  # s, for which random turns are drawn


class Floor(NamedTuple):
    """The square in which robots are in play (m)."""

    north: float = 0.0  # of its centre
    east: float = 0.0
    half: float = math.inf  # half of its side
    goal_north: float = 1.0  # direction of the goal line from the centre
    goal_east: float = 0.0


class Herd(NamedTuple):
    """Ground robots at the start of a flight."""

    robots: Mat  # (R, SIZE), targets first, then obstacles
    things: Mat  # (K, 8), the obstacle robots as obstacles
    constants: tuple[Mat, GroundRobot, Floor]  # random turns (R, k), m/s, and what the kernels read


def start(world: World, rng: np.random.Generator) -> Herd:
    """Return the robots of a world as they start.

    Args:
        world: says where.
        rng: draws the phase of each one's clock and its random turns.
    """
    targets, obstacles = world.target_starts, world.obstacle_starts
    circling = world.obstacle_robots
    robot = GroundRobot()
    if circling is not None:
        robot = robot._replace(circle_radius=circling.circle)
    places = [*(it.at for it in targets), *(it.at for it in obstacles)]
    headings = [*(it.heading_deg for it in targets), *(it.heading_deg for it in obstacles)]
    phases = rng.uniform(0.0, robot.reversal_every, len(places))
    for n, one in enumerate(targets):
        phases[n] = phases[n] if one.reversal is None else one.reversal
    robots = of.placed(
        np.array(places).reshape(-1, 2),
        np.radians(headings),
        phases,
        robot,
        obstacles=len(obstacles),
    )
    things = np.array(
        [(CYLINDER_ROW, *it.at, HIT_RADIUS, 0.0, 0.0, it.tower, 0.0) for it in obstacles]
    )
    offsets = of.random_offsets(rng, len(places), LENGTH, robot)
    return Herd(robots, things.reshape(-1, 8), (offsets, robot, floor_of(world)))


def floor_of(world: World) -> Floor:
    """Return where the robots of a world are in play; everywhere without an arena."""
    arena = world.arena
    if arena is None:
        return Floor()
    directions = {
        "north": (1.0, 0.0),
        "south": (-1.0, 0.0),
        "east": (0.0, 1.0),
        "west": (0.0, -1.0),
    }
    return Floor(*arena.centre, 0.5 * arena.side, *directions[arena.goal])


@compiled
def live(
    x: Vec3,
    before: float,
    now: float,
    memory: Vec3,
    radius: float,
    robots: Mat,
    offsets: Mat,
    robot: GroundRobot,
    floor: Floor,
    things: Mat,
) -> None:
    """Move the robots by one physics step, and let them meet the vehicle and the arena's sides.

    Args:
        x: (17,) state of the vehicle, changed where a plate carries it.
        before: m, its height at the beginning of the step.
        now: s, at the end of the step.
        memory: of the simulator, changed in place.
        radius: m, of the vehicle.
        robots: (R, SIZE) changed in place.
        offsets: (R, k) m/s, of their random turns.
        robot: how they drive.
        floor: where they are in play.
        things: (N, 8) obstacles; the last ones are the obstacle robots, moved in place.
    """
    of.advance(robots, offsets, robot, at.DT)
    for i in range(robots.shape[0]):
        state = robots[i]
        if state[of.OUT] > 0.0:
            continue
        if state[of.OBSTACLE] > 0.0:
            row = things.shape[0] - robots.shape[0] + i
            things[row, 1], things[row, 2] = state[of.NORTH], state[of.EAST]
            continue
        meet(x, before, memory, radius, state, robot)
        leave(state, floor, now)


@compiled
def meet(
    x: Vec3, before: float, memory: Vec3, radius: float, state: Vec3, robot: GroundRobot
) -> None:
    """Let the vehicle bump into one robot, or touch its top and rest on it.

    Args:
        x: (17,) state of the vehicle, changed where the plate carries it.
        before: m, its height at the beginning of the step.
        memory: of the simulator, changed on a crash.
        radius: m, of the vehicle.
        state: (SIZE,) of the robot, changed in place.
        robot: its size, and how it drives.
    """
    north, east = x[0] - state[of.NORTH], x[1] - state[of.EAST]
    over = math.sqrt(north * north + east * east) <= 0.5 * robot.diameter + radius
    height = -x[2]
    if not over or height > robot.height + RELEASED:
        state[of.PRESSED] = 0.0
        return
    if height >= robot.height:
        return
    if before >= robot.height or state[of.PRESSED] > 0.0:
        if state[of.PRESSED] == 0.0:
            of.touch(state, robot)
        state[of.PRESSED] = 1.0
        if x[5] > HARD:
            memory[at.CRASHED] = 1.0
        x[2] = -robot.height
        x[5] = min(0.0, x[5])
        return
    ahead = north * math.cos(state[of.HEADING]) + east * math.sin(state[of.HEADING])
    if ahead > 0.0:
        of.bump(state, robot)


@compiled
def leave(state: Vec3, floor: Floor, now: float) -> None:
    """Take a robot off the floor when its middle is beyond one of the arena's sides.

    Args:
        state: (SIZE,) of the robot, changed in place.
        floor: where robots are in play.
        now: s.
    """
    north, east = state[of.NORTH] - floor.north, state[of.EAST] - floor.east
    if max(abs(north), abs(east)) <= floor.half:
        return
    beyond = north * floor.goal_north + east * floor.goal_east
    state[of.OUT] = of.HOME if beyond >= max(abs(north), abs(east)) else of.LOST
    state[of.OUT_AT] = now
