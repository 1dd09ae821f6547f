"""The runs of the study of tracking: one robot, two that cross, one of either class, many."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Literal, NamedTuple

import numpy as np

from missionkit.estimation.target_tracking import model_bank, multiple_models
from missionkit.estimation.target_tracking.multiple_models import (
    Estimator,
    bank,
    kernels,
)
from missionkit.estimation.target_tracking.tracker import MultiTargetTracker, Tracker
from missionkit.geometry import Mat
from missionkit.messages import GroundDetection, Target
from missionkit.messages.robot_modes import OBSTACLE, SPIN
from missionkit.sim.ground_robots import SPIN_LEFT, advance, placed, random_offsets
from studies.tracking_scene import HEIGHT, PERIOD, ROBOT, Scene, Watcher, above

ESTIMATORS: tuple[Estimator, ...] = ("imm", "mmae", "static")
START_SD = math.radians(17.0)
"""Of the heading that a filter begins with, in the runs of one robot."""
SETTLED = 3.0  # s, from which errors count
AFTER = 3.0  # s after a spin, in which errors count apart


class Single(NamedTuple):
    """One robot, followed for a while by one estimator."""

    delays: tuple[float, ...]  # s, from the start of each spin until it is the likeliest
    missed: int  # spins that never were
    straight: Mat  # (n, 2) errors while it drives: m, rad
    after: Mat  # (n, 2) errors in the time after a spin
    wrong_at: Mat  # (k, 3) rad, error of the heading 0.5, 1 and 3 s after each spin
    false: tuple[int, int]  # frames called a spin wrongly, of how many


def driven(seed: int, length: float) -> tuple[Mat, Mat]:
    """Return the truth (n, 3) of one robot, and how long it still spins (n,), frame by frame.

    Args:
        seed: of its path.
        length: s.
    """
    rng = np.random.default_rng([seed, 0])
    heading, phase = rng.uniform(-math.pi, math.pi, 1), rng.uniform(5.0, 20.0, 1)
    robots = placed(np.zeros((1, 2)), heading, phase, ROBOT, obstacles=0)
    offsets = random_offsets(rng, 1, length, ROBOT)
    rows = []
    for _ in range(round(length / PERIOD)):
        advance(robots, offsets, ROBOT, PERIOD)
        rows.append(robots[0].copy())
    truth = np.array(rows)
    return truth[:, :3], truth[:, SPIN_LEFT]


def singles(seed: int, length: float = 45.0) -> dict[Estimator, Single]:
    """Follow one robot by each of the estimators, on the same measurements.

    The camera stays above the robot; the filters begin with its first place and with a heading
    that is off by `START_SD`.

    Args:
        seed: of path and noise.
        length: s.
    """
    truth, spinning = driven(seed, length)
    rng = np.random.default_rng([seed, 1])
    watcher = Watcher(Scene(), rng)
    bodies = (above(round(north), round(east)) for north, east, _ in truth)
    measured = [
        watcher.detections(body, it[None, :2]) for body, it in zip(bodies, truth, strict=True)
    ]
    heading = truth[0, 2] + START_SD * rng.standard_normal()
    return {
        name: _graded(spinning, *_followed(name, [it for (it,) in measured], heading, truth))
        for name in ESTIMATORS
    }


def _followed(
    estimator: Estimator, measured: Sequence[GroundDetection], heading: float, truth: Mat
) -> tuple[Mat, Mat]:
    """Return the probability of a spin (n,), and errors (n, 2), m and rad, frame by frame."""
    models, library = bank(estimator, ROBOT), kernels("numba")
    first = measured[0]
    P = np.diag([0.0, 0.0, START_SD**2])
    P[:2, :2] = first.covariance
    known = multiple_models.begun(models, np.array([*first.position, heading]), P)
    spin, means = [], []
    for k, seen in enumerate(measured):
        if k > 0:
            known = multiple_models.predicted(models, known, PERIOD, library)
            z, R = seen.position, seen.covariance
            known = multiple_models.corrected(models, known, z, R, library)
        spin.append(known.mu[models.names.index(SPIN)] if SPIN in models.names else 0.0)
        means.append(model_bank.combined(*known)[0])
    off = np.array(means) - truth
    turns = np.abs((off[:, 2] + math.pi) % (2.0 * math.pi) - math.pi)
    return np.array(spin), np.column_stack((np.hypot(off[:, 0], off[:, 1]), turns))


def _graded(spinning: Mat, spin: Mat, errors: Mat) -> Single:
    times = PERIOD * np.arange(1, len(spinning) + 1)
    turning = spinning > 0.0
    begins = np.flatnonzero(turning[1:] & ~turning[:-1]) + 1
    driving, after = times > SETTLED, np.zeros(len(times), bool)
    delays, missed, wrong_at = [], 0, []
    for k in begins:
        start = times[k] - (ROBOT.spin_time - spinning[k])
        end = start + ROBOT.spin_time
        driving &= (times < start) | (times > end + AFTER)
        if end + AFTER + PERIOD > times[-1]:
            continue
        hits = times[(times >= start) & (times <= end) & (spin > 0.5)]
        delays += [float(hits[0] - start)] if len(hits) else []
        missed += not len(hits)
        after |= (times > end) & (times <= end + AFTER)
        wrong_at.append([errors[int((end + it) / PERIOD), 1] for it in (0.5, 1.0, 3.0)])
    return Single(
        tuple(delays),
        missed,
        errors[driving],
        errors[after],
        np.array(wrong_at).reshape(-1, 3),
        (int((spin[driving] > 0.5).sum()), int(driving.sum())),
    )


SEEN_FOR = (1.0, 3.0)
"""Times in view (s) after which a robot's class is asked for."""
MANY = Scene(detectors=("haar", "template"), found=0.9, false=0.05)
"""Two detectors, each of which misses one robot in ten."""


Identity = Literal["kept", "swapped", "lost"]


def crossing(seed: int, scene: Scene = MANY) -> Identity:
    """Let two robots pass each other at 0.3 m; say what became of their identities.

    Places are compared as the vehicle sees them: its own pose is wrong in some scenes.

    Args:
        seed: of paths and noise.
        scene: how well they are seen.
    """
    rng = np.random.default_rng([seed, 2])
    paths = _paths_that_cross(rng)
    tracker = Tracker(MultiTargetTracker(), ROBOT)
    known, watcher = tracker.begin(), Watcher(scene, rng)
    first: list[str] = []
    last: list[str] = []
    for k in range(len(paths)):
        at, body = k * PERIOD, above(0.0, 0.0)
        known = tracker.observe(known, watcher.frame(at, body, paths[k], np.zeros(2)))
        if k in {round(1.0 / PERIOD), len(paths) - 1}:
            last = _names(tracker.targets(known, at), watcher.as_believed(body, paths[k]))
            first = first or last
    if "" not in first and first == last:
        return "kept"
    return "swapped" if "" not in first and first == last[::-1] else "lost"


def _paths_that_cross(rng: np.random.Generator) -> Mat:
    """Return paths in view (n, 2 robots, 2), m, that come as near as 0.25 to 0.35 m."""
    while True:
        headings, phases = rng.uniform(-math.pi, math.pi, 2), rng.uniform(0.0, 20.0, 2)
        back = 1.5 * ROBOT.speed * np.column_stack((np.cos(headings), np.sin(headings)))
        places = rng.uniform(-0.3, 0.3, (2, 2)) - back
        robots = placed(places, headings, phases, ROBOT, obstacles=0)
        offsets = random_offsets(rng, 2, 4.0, ROBOT)
        rows = []
        for _ in range(round(4.0 / PERIOD)):
            advance(robots, offsets, ROBOT, PERIOD)
            rows.append(robots[:, :2].copy())
        paths = np.array(rows)
        gaps = np.hypot(*(paths[:, 0] - paths[:, 1]).T)
        nearest = int(gaps.argmin())
        inside = bool((np.abs(paths) < (1.0, 1.3)).all())
        if inside and 0.25 < gaps[nearest] < 0.35 and 25 < nearest < len(paths) - 10:
            return paths


def _names(targets: Mapping[str, Target], places: Mat) -> list[str]:
    """Return the target nearest to each place (n, 2); "": none within 0.15 m."""
    names = []
    for place in places:
        near = [(math.dist(it.position[:2], place), name) for name, it in targets.items()]
        gap, name = min(near, default=(math.inf, ""))
        names.append(name if gap < 0.15 else "")
    return names


def classified(seed: int, *, obstacle: bool) -> tuple[float, ...] | None:
    """Return the probability that a robot is an obstacle robot after each of the times `SEEN_FOR`.

    Args:
        seed: of path and noise.
        obstacle: what it is.

    Returns:
        None if it left the view before; NaN where no target is tracked.
    """
    rng = np.random.default_rng([seed, 3, obstacle])
    heading = rng.uniform(-math.pi, math.pi, 1)
    place = rng.uniform((-1.0, -1.3), (1.0, 1.3))[None]
    robots = placed(place, heading, rng.uniform(0.0, 20.0, 1), ROBOT, obstacles=int(obstacle))
    offsets = random_offsets(rng, 1, SEEN_FOR[-1], ROBOT)
    towers = np.array([rng.uniform(1.0, 2.0) if obstacle else 0.0])
    tracker, watcher = Tracker(MultiTargetTracker(), ROBOT), Watcher(MANY, rng)
    known, answers = tracker.begin(), []
    for k in range(1, round(SEEN_FOR[-1] / PERIOD) + 1):
        advance(robots, offsets, ROBOT, PERIOD)
        if (np.abs(robots[0, :2]) > (1.0, 1.3)).any():
            return None
        frame = watcher.frame(k * PERIOD, above(0.0, 0.0, HEIGHT), robots[:, :2], towers)
        known = tracker.observe(known, frame)
        if k in {round(it / PERIOD) for it in SEEN_FOR}:
            targets = tracker.targets(known, known.now.at)
            (name,) = _names(targets, robots[:, :2])
            answers.append(targets[name].classes[OBSTACLE] if name else math.nan)
    return tuple(answers)
