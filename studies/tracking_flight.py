"""One robot, followed as in P4's Fig. 5: two slow turns, a spin, and a vehicle that stays above."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.estimation.target_tracking.motion_models import moved
from missionkit.estimation.target_tracking.multiple_models import Estimator
from missionkit.estimation.target_tracking.tracker import MultiTargetTracker, Tracker
from missionkit.geometry import Mat, Vec3
from missionkit.messages import GroundFrame, Target
from missionkit.messages.robot_modes import SPIN, STRAIGHT
from studies.tracking_scene import FOCAL, HEIGHT, PERIOD, ROBOT, Scene, Watcher, above

LENGTH, FOUND_AT = 60.0, 5.0  # s
TURNS = ((15.0, 18.0, 1.0), (45.0, 49.0, -1.0))
"""From, to (s), and which way it turns, with the largest offset of the wheels."""
SPINS_AT = 30.0  # s
DELAY = 2  # frames from the exposure to the tracker
SPEED, ACCELERATION = 2.13, 3.05  # m/s, m/s²: P4 section V
PULL = 1.5  # 1/s, of the vehicle towards the place above the target
UPRIGHT, ALONG = 120.0, 160.0  # px, half the image


class Followed(NamedTuple):
    """One run, frame by frame."""

    times: Mat  # (n,), s
    heading: Mat  # (n,), rad, true
    estimate: Mat  # (n,), rad, NaN before it is known
    spin: Mat  # (n,), probability
    error: Mat  # (n,), m, of the position; NaN before it is known
    pixels: Mat  # (n, 2), px, of the robot from the middle of the image


def path() -> Mat:
    """Return the robot's true states (n, 3), frame by frame."""
    x, rows = np.array([0.0, 0.0, 0.3]), []
    for k in range(round(LENGTH / PERIOD)):
        at = k * PERIOD
        rate = 2.0 * ROBOT.turn_offset / ROBOT.wheel_base
        turn = sum(way for start, end, way in TURNS if start <= at < end)
        model = np.array([ROBOT.speed, turn * rate, 0.0, 0.0])
        left = SPINS_AT + ROBOT.spin_time - at
        if at >= SPINS_AT and left > 0.0:
            model = np.array([0.0, ROBOT.spin_rate, 0.0, 0.0])
            x = moved(x, model, min(PERIOD, left))
            model, rest = np.array([ROBOT.speed, 0.0, 0.0, 0.0]), max(PERIOD - left, 0.0)
            x = moved(x, model, rest)
        else:
            x = moved(x, model, PERIOD)
        rows.append(x)
    return np.array(rows)


def followed(estimator: Estimator, seed: int) -> Followed:
    """Fly above the robot of P4's Fig. 5 by what one estimator says.

    The vehicle is a point with P4's limits of speed and acceleration; it leads by the target's
    velocity while the target is likeliest to drive, and by its place alone in a spin.

    Args:
        estimator: of the tracker.
        seed: of the noise.
    """
    truth = path()
    tracker = Tracker(MultiTargetTracker(estimator=estimator), ROBOT)
    known, watcher = tracker.begin(), Watcher(Scene(), np.random.default_rng([seed, 4]))
    place, velocity = truth[0, :2].copy(), np.zeros(2)
    waiting: list[GroundFrame] = []
    rows = []
    for k, robot in enumerate(truth):
        at = k * PERIOD
        waiting.append(watcher.frame(at, above(*place), robot[None, :2], np.zeros(1)))
        if at >= FOUND_AT and len(waiting) > DELAY:
            known = tracker.observe(known, waiting[-1 - DELAY])
        target = next(iter(tracker.targets(known, at).values()), None)
        offset = FOCAL * (robot[:2] - place) / HEIGHT
        rows.append([at, robot[2], *_seen(target, robot), *offset])
        if target is None:  # it follows the truth until it has found the robot
            place, velocity = robot[:2].copy(), np.zeros(2)
            continue
        wanted = _limited(PULL * (target.position[:2] - place) + _lead(target), SPEED)
        velocity = velocity + _limited(wanted - velocity, ACCELERATION * PERIOD)
        place = place + PERIOD * velocity
    times, heading, estimate, spin, error, x, y = np.array(rows).T
    return Followed(times, heading, estimate, spin, error, np.column_stack((x, y)))


def _seen(target: Target | None, robot: Vec3) -> tuple[float, float, float]:
    """Return heading, probability of a spin and error of the position; NaN: not known."""
    if target is None:
        return math.nan, math.nan, math.nan
    error = math.dist(target.position[:2], robot[:2])
    heading = math.nan if target.heading is None else target.heading
    return heading, target.modes.get(SPIN, math.nan), error


def _lead(target: Target) -> Vec3:
    if target.velocity is None or target.modes[SPIN] > target.modes[STRAIGHT]:
        return np.zeros(2)
    return np.asarray(target.velocity[:2])


def _limited(vector: Vec3, largest: float) -> Vec3:
    return np.asarray(vector * min(1.0, largest / max(math.hypot(*vector), 1e-9)))
