"""The herding mission as points on a floor: robots, obstacle robots, the vehicle's flight.

Axes: x (north) towards the goal line, y (east) to its right, from the arena's centre.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.geometry import Mat
from missionkit.ground_robot import GroundRobot
from missionkit.jit import compiled
from missionkit.planning.herding import robot_forecast as fc
from missionkit.sim import ground_robots as gr

CRUISE, DESCEND, GROUND, CLIMB, CRASHED = 0, 1, 2, 3, 4
FRONT, TOP = 0, 1
PX, PY, HEIGHT, VX, VY, MODE, SINCE = 0, 1, 2, 3, 4, 5, 6
"""The vehicle (7,): m, m, m, m/s, m/s, what it does, since when (s)."""
BUMPS, TOUCHES, MISTAKES, VAIN, HITS = 0, 1, 2, 3, 4
"""Counts (5,): MISTAKES: touches when it meant to land in front; VAIN: landings nobody hit."""
SPUN_FOR, SPUN_AT, SPIN_WAS, CLOCK_SEEN = 5, 6, 7, 8
"""Behind the state of `robot_forecast` in a row of what is seen (9,), s."""
SEEN_SIZE = 9
NEAR = 0.25  # m, from where a descent begins
NOISE_TIME = 0.5  # s, in which an error of the tracker changes
STEP = 0.05  # s
AHEAD = 2.0  # s, that avoidance looks ahead
KEPT = 0.75  # m, from the centre of an obstacle robot
TOUCH_HEIGHT = 0.1  # m, of a robot's top
ROBOT_TOP = 0.25  # m, off its centre where a touch still works


class Facts(NamedTuple):
    """The vehicle and the arena."""

    half: float = 10.0  # m, of the arena's side
    speed: float = 2.13  # m/s
    acceleration: float = 3.05  # m/s²
    down: float = 1.0  # m/s
    up: float = 1.5  # m/s
    cruise: float = 1.5  # m
    lead: float = 0.5  # m, of centres when it stands
    contact: float = 0.37  # m, of centres: a bump
    patience: float = 2.5  # s, on the ground
    hit: float = 0.40  # m, of centres: a tower
    sight: float = math.inf  # m, radius of what it sees around it
    noise: tuple[float, float] = (0.0, 0.0)  # m, rad, of the tracker
    latency: float = 0.0  # s, until a spin is noticed
    resets: bool = False  # a bump sets a robot's clock back


class Scene(NamedTuple):
    """All that moves; arrays, changed in place."""

    vehicle: Mat  # (7,)
    truth: Mat  # (robots, gr.SIZE), obstacle robots last
    fate: Mat  # (robots,), of `robot_forecast`
    offsets: Mat  # (robots, n), m/s
    seen: Mat  # (targets, SEEN_SIZE)
    noise: Mat  # (targets, 3), m, m, rad
    caused: Mat  # (targets,), s that a spin takes which the vehicle began, 0: its own
    counts: Mat  # (5,)


class Order(NamedTuple):
    """What the vehicle is to do."""

    action: int = FRONT
    target: int = -1  # of the robots; -1: fly to a place
    start_at: float = 0.0  # s, when it may descend
    x: float = 0.0  # m, the place
    y: float = 0.0  # m


@compiled
def advance_robots(truth: Mat, fate: Mat, offsets: Mat, robot: GroundRobot, half: float) -> None:
    """Move all robots by a step; note which of them leave the arena."""
    for i in range(len(truth)):
        if fate[i] != fc.INSIDE:
            continue
        x, y = truth[i, gr.NORTH], truth[i, gr.EAST]
        gr.advance(truth[i : i + 1], offsets[i : i + 1], robot, STEP)
        if truth[i, gr.OBSTACLE] == 0.0:
            dx, dy = truth[i, gr.NORTH] - x, truth[i, gr.EAST] - y
            fate[i] = fc.crossed(x, y, dx, dy, half)


@compiled
def touch_down(
    seen: Mat, action: int, after: float, facts: Facts, robot: GroundRobot
) -> tuple[float, float]:
    """Return where (m) to be in `after` s to turn a robot that was seen as `seen` (fc.SIZE,)."""
    there = seen.copy()
    if math.isnan(there[fc.REVERSAL_IN]):
        there[fc.REVERSAL_IN] = 1e3
    fc.forecast(there, after, 1e3, robot)
    if action == TOP:
        return there[fc.X], there[fc.Y]
    heading = there[fc.HEADING] + there[fc.SPIN_LEFT] * math.pi / robot.spin_time
    return (
        there[fc.X] + facts.lead * math.cos(heading),
        there[fc.Y] + facts.lead * math.sin(heading),
    )


@compiled
def steer(vehicle: Mat, aim: Mat, obstacles: Mat, facts: Facts, robot: GroundRobot) -> None:
    """Fly level for a step to a place (4,): m, m, m/s, m/s, round obstacle robots."""
    dx, dy = aim[0] - vehicle[PX], aim[1] - vehicle[PY]
    distance = math.hypot(dx, dy)
    closing = min(2.5 * distance, math.sqrt(1.4 * facts.acceleration * distance))
    scale = closing / max(distance, 1e-9)
    wx, wy = limited(aim[2] + scale * dx, aim[3] + scale * dy, facts.speed)
    wx, wy = avoided(vehicle, wx, wy, obstacles, facts, robot)
    ax, ay = limited((wx - vehicle[VX]) / STEP, (wy - vehicle[VY]) / STEP, facts.acceleration)
    vehicle[PX] += STEP * (vehicle[VX] + 0.5 * STEP * ax)
    vehicle[PY] += STEP * (vehicle[VY] + 0.5 * STEP * ay)
    vehicle[VX] += STEP * ax
    vehicle[VY] += STEP * ay


@compiled
def limited(x: float, y: float, most: float) -> tuple[float, float]:
    """Return a vector shortened to `most`."""
    length = math.hypot(x, y)
    share = min(1.0, most / max(length, 1e-9))
    return x * share, y * share


@compiled
def avoided(
    vehicle: Mat, wx: float, wy: float, obstacles: Mat, facts: Facts, robot: GroundRobot
) -> tuple[float, float]:
    """Return the velocity nearest to the wanted one that keeps away from obstacle robots."""
    if room(vehicle, wx, wy, obstacles, facts, robot) >= KEPT:
        return wx, wy
    best_x, best_y, best = 0.0, 0.0, math.inf
    for ring in range(4):
        speed = facts.speed * ring / 3.0
        for turn in range(1 if ring == 0 else 24):
            x, y = speed * math.cos(turn * math.pi / 12.0), speed * math.sin(turn * math.pi / 12.0)
            near = room(vehicle, x, y, obstacles, facts, robot)
            cost = math.hypot(x - wx, y - wy) + 1e3 * max(0.0, KEPT - near)
            if cost < best:
                best_x, best_y, best = x, y, cost
    return best_x, best_y


@compiled
def room(
    vehicle: Mat, vx: float, vy: float, obstacles: Mat, facts: Facts, robot: GroundRobot
) -> float:
    """Return how near (m) the vehicle would come to an obstacle robot that it sees."""
    least = math.inf
    for it in obstacles:
        x, y = it[gr.NORTH] - vehicle[PX], it[gr.EAST] - vehicle[PY]
        if math.hypot(x, y) > min(facts.sight, 6.0):
            continue
        # what the vehicle's inertia adds: it changes its velocity in some time
        change = math.hypot(vx - vehicle[VX], vy - vehicle[VY]) / facts.acceleration
        x -= 0.5 * change * (vehicle[VX] - vx)
        y -= 0.5 * change * (vehicle[VY] - vy)
        ux = robot.speed * math.cos(it[gr.HEADING]) - vx
        uy = robot.speed * math.sin(it[gr.HEADING]) - vy
        square = ux * ux + uy * uy
        at = min(AHEAD, max(0.0, -(x * ux + y * uy) / max(square, 1e-9)))
        least = min(least, math.hypot(x + at * ux, y + at * uy))
    return least


@compiled
def free(
    x: float,
    y: float,
    ahead: float,
    kept: float,
    obstacles: Mat,
    facts: Facts,
    vehicle: Mat,
    robot: GroundRobot,
) -> bool:
    """Say whether obstacle robots that are seen stay `kept` m away from a place for a while."""
    for it in obstacles:
        if math.hypot(it[gr.NORTH] - vehicle[PX], it[gr.EAST] - vehicle[PY]) > facts.sight:
            continue
        rate = robot.speed / robot.circle_radius
        for k in range(11):
            t = ahead * k / 10.0
            mid = it[gr.HEADING] + 0.5 * rate * t
            ox = it[gr.NORTH] + robot.speed * t * math.cos(mid)
            oy = it[gr.EAST] + robot.speed * t * math.sin(mid)
            if math.hypot(ox - x, oy - y) < kept:
                return False
    return True


@compiled
def aim_at(scene: Scene, order: Order, facts: Facts, robot: GroundRobot) -> Mat:
    """Return where (m, m) to be now and how fast to move there (m/s, m/s)."""
    if order.target < 0:
        return np.array([order.x, order.y, 0.0, 0.0])
    vehicle, state = scene.vehicle, scene.seen[order.target]
    after = max(0.0, vehicle[HEIGHT] - _floor(order)) / facts.down
    x, y = touch_down(state, order.action, after, facts, robot)
    stands = state[fc.SPIN_LEFT] > 0.0 or (order.action == FRONT and vehicle[MODE] == DESCEND)
    speed = 0.0 if stands else robot.speed
    return np.array(
        [x, y, speed * math.cos(state[fc.HEADING]), speed * math.sin(state[fc.HEADING])]
    )


@compiled
def _floor(order: Order) -> float:
    return TOUCH_HEIGHT if order.action == TOP else 0.0


@compiled
def act(scene: Scene, order: Order, facts: Facts, robot: GroundRobot, now: float) -> None:
    """Fly the vehicle for a step."""
    vehicle, obstacles = scene.vehicle, scene.truth[len(scene.seen) :]
    for it in obstacles:
        if math.hypot(it[gr.NORTH] - vehicle[PX], it[gr.EAST] - vehicle[PY]) < facts.hit:
            scene.counts[HITS] += 1.0
            vehicle[MODE] = CRASHED
            return
    if vehicle[MODE] == CRUISE:
        _cruise(scene, order, facts, robot, now)
    elif vehicle[MODE] == DESCEND:
        _descend(scene, order, facts, robot, now)
    elif vehicle[MODE] == GROUND:
        _wait(scene, facts, robot, now)
    else:
        vehicle[HEIGHT] += facts.up * STEP
        if vehicle[HEIGHT] > 0.2:
            still = np.array([vehicle[PX], vehicle[PY], 0.0, 0.0])
            steer(vehicle, still, obstacles, facts, robot)
        if vehicle[HEIGHT] >= facts.cruise:
            vehicle[HEIGHT] = facts.cruise
            vehicle[MODE], vehicle[SINCE] = CRUISE, now


@compiled
def _cruise(scene: Scene, order: Order, facts: Facts, robot: GroundRobot, now: float) -> None:
    vehicle, obstacles = scene.vehicle, scene.truth[len(scene.seen) :]
    aim = aim_at(scene, order, facts, robot)
    steer(vehicle, aim, obstacles, facts, robot)
    near = math.hypot(aim[0] - vehicle[PX], aim[1] - vehicle[PY]) < NEAR
    due = order.target >= 0 and near and order.start_at <= now
    if due and free(aim[0], aim[1], 5.0, 0.9, obstacles, facts, vehicle, robot):
        vehicle[MODE], vehicle[SINCE] = DESCEND, now


@compiled
def _descend(scene: Scene, order: Order, facts: Facts, robot: GroundRobot, now: float) -> None:
    """Come down; a robot that begins to spin, or an obstacle robot that comes, ends it."""
    vehicle, obstacles = scene.vehicle, scene.truth[len(scene.seen) :]
    steer(vehicle, aim_at(scene, order, facts, robot), obstacles, facts, robot)
    vehicle[HEIGHT] -= facts.down * STEP
    left = scene.seen[order.target, fc.SPIN_LEFT]
    spins = order.action == FRONT and vehicle[HEIGHT] > 0.4 and left > vehicle[HEIGHT] / facts.down
    safe = free(vehicle[PX], vehicle[PY], 2.0, 0.7, obstacles, facts, vehicle, robot)
    if spins or not safe or scene.fate[order.target] != fc.INSIDE:
        vehicle[MODE], vehicle[SINCE] = CLIMB, now
    elif vehicle[HEIGHT] <= _floor(order):
        vehicle[HEIGHT] = _floor(order)
        vehicle[MODE], vehicle[SINCE] = (CLIMB if order.action == TOP else GROUND), now
        _touch(scene, order, facts, robot)


@compiled
def _touch(scene: Scene, order: Order, facts: Facts, robot: GroundRobot) -> None:
    """Touch what is under the vehicle as it comes down."""
    vehicle, truth = scene.vehicle, scene.truth
    for i in range(len(scene.seen)):
        off = math.hypot(truth[i, gr.NORTH] - vehicle[PX], truth[i, gr.EAST] - vehicle[PY])
        if scene.fate[i] != fc.INSIDE or off >= facts.contact:
            continue
        vehicle[MODE] = CLIMB
        if (order.action == FRONT or off < ROBOT_TOP) and gr.touch(truth[i], robot):
            scene.counts[TOUCHES if order.action == TOP else MISTAKES] += 1.0
            scene.caused[i] = 0.25 * robot.spin_time


@compiled
def _wait(scene: Scene, facts: Facts, robot: GroundRobot, now: float) -> None:
    """Stand on the floor until a robot hits the vehicle with its bumper, the front half of it."""
    vehicle, truth, obstacles = scene.vehicle, scene.truth, scene.truth[len(scene.seen) :]
    vehicle[VX] = vehicle[VY] = 0.0
    late = now - vehicle[SINCE] > facts.patience
    for i in range(len(scene.seen)):
        x, y = vehicle[PX] - truth[i, gr.NORTH], vehicle[PY] - truth[i, gr.EAST]
        ahead = x * math.cos(truth[i, gr.HEADING]) + y * math.sin(truth[i, gr.HEADING])
        if scene.fate[i] != fc.INSIDE or math.hypot(x, y) >= facts.contact or ahead <= 0.0:
            continue
        if gr.bump(truth[i], robot):
            scene.caused[i] = robot.spin_time
            scene.counts[BUMPS] += 1.0
            vehicle[MODE], vehicle[SINCE] = CLIMB, now
            if facts.resets:
                truth[i, gr.REVERSAL_IN] = robot.reversal_every
    if vehicle[MODE] == GROUND and late:
        scene.counts[VAIN] += 1.0
    safe = free(vehicle[PX], vehicle[PY], 2.5, 0.7, obstacles, facts, vehicle, robot)
    if vehicle[MODE] == GROUND and (late or not safe):
        vehicle[MODE], vehicle[SINCE] = CLIMB, now


@compiled
def look(
    scene: Scene, facts: Facts, robot: GroundRobot, now: float, rng: np.random.Generator
) -> None:
    """Update what the vehicle sees of all robots; a spin is noticed after `latency`."""
    truth, seen, noise = scene.truth, scene.seen, scene.noise
    keep = math.exp(-STEP / NOISE_TIME)
    fresh = math.sqrt(1.0 - keep * keep)
    for i in range(len(seen)):
        for axis in range(3):
            noise[i, axis] *= keep
            if facts.noise[0] > 0.0:
                sd = facts.noise[1] if axis == 2 else facts.noise[0]
                noise[i, axis] += fresh * sd * rng.standard_normal()
        if truth[i, gr.SPIN_LEFT] > seen[i, SPIN_WAS] + 1e-6:
            seen[i, SPUN_AT] = now
            own = truth[i, gr.REVERSAL_IN] > robot.reversal_every - 2.0 * STEP
            if own:
                scene.caused[i] = 0.0
                seen[i, CLOCK_SEEN] = 1.0
        seen[i, SPIN_WAS] = truth[i, gr.SPIN_LEFT]
        noticed = truth[i, gr.SPIN_LEFT] > 0.0 and now - seen[i, SPUN_AT] >= facts.latency
        seen[i, SPUN_FOR] = now - seen[i, SPUN_AT] if noticed else 0.0
        seen[i, fc.X] = truth[i, gr.NORTH] + noise[i, 0]
        seen[i, fc.Y] = truth[i, gr.EAST] + noise[i, 1]
        seen[i, fc.HEADING] = truth[i, gr.HEADING] + noise[i, 2]
        seen[i, fc.SPIN_LEFT] = truth[i, gr.SPIN_LEFT] if noticed else 0.0
        if math.isinf(facts.sight):  # else the memory says so
            known = seen[i, CLOCK_SEEN] > 0.0
            seen[i, fc.REVERSAL_IN] = truth[i, gr.REVERSAL_IN] if known else math.nan
        elif not math.isnan(seen[i, fc.REVERSAL_IN]):
            seen[i, fc.REVERSAL_IN] = max(0.0, seen[i, fc.REVERSAL_IN] - STEP)


@compiled
def fly(
    scene: Scene,
    order: Order,
    facts: Facts,
    robot: GroundRobot,
    times: tuple[float, float],
    rng: np.random.Generator,
) -> float:
    """Fly from a time until another (s), with the whole arena in view until the vehicle cruises.

    Returns:
        The time (s).
    """
    now, until = times
    mode = scene.vehicle[MODE]
    while now < until - 1e-9 or (math.isinf(facts.sight) and mode not in (CRUISE, CRASHED)):
        advance_robots(scene.truth, scene.fate, scene.offsets, robot, facts.half)
        now += STEP
        look(scene, facts, robot, now, rng)
        if mode != CRASHED:
            act(scene, order, facts, robot, now)
        mode = scene.vehicle[MODE]
    return now
