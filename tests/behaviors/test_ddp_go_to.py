"""Flight to a point by plans that are made again and again."""

from __future__ import annotations

import math

import numpy as np
import pytest
from playing import TICK, at, marker, play, status
from samples import calm

from missionkit.behaviors.ddp_go_to import NO_PLAN, DdpGoTo
from missionkit.geometry import vec
from missionkit.messages import Occupancy, Target
from missionkit.planning.ddp import flight_plan, solver

HOME = vec(0.0, 0.0, 0.0)
GO = DdpGoTo(target="home", height=2.0)
SIXTY = DdpGoTo(target="trunk", speed=2.0)


def robot(*place, velocity=None):
    return Target("robot", vec(*place), 0.05, None, None, 9.9, velocity=velocity)


def follow(behavior, start, seconds, **changes):
    """The vehicle does exactly as it is guided: position and velocity at each tick, and steps."""
    place, velocity, memory = np.array(start, float), np.zeros(3), None
    path, steps = [], []
    for n in range(round(seconds / TICK)):
        now = 10.0 + n * TICK
        given = {key: each(now) if callable(each) else each for key, each in changes.items()}
        seen = at(now, *place, velocity=velocity, status=status(now), home=HOME, **given)
        memory = behavior.begin(seen) if n == 0 else memory
        step = behavior.step(seen, memory)
        memory = step.memory
        guidance = step.guidance
        velocity = np.zeros(3) if guidance is None else (guidance.position - place) / TICK
        velocity = np.clip(velocity, -behavior.speed, behavior.speed)
        place = place + TICK * velocity
        path.append(place)
        steps.append(step)
    return np.array(path), steps


def test_it_arrives_at_rest_within_its_limits():
    path, steps = follow(GO, (9.0, -3.0, -2.0), 8.0)
    assert steps[-1].done
    assert not steps[40].done
    assert math.dist(path[-1], (0.0, 0.0, -2.0)) < 0.05
    speeds = np.linalg.norm(np.diff(path, axis=0), axis=1) / TICK
    assert speeds.max() < 2.13 + 0.05
    assert speeds.max() > 2.0
    assert all(step.guidance.speed == 2.13 for step in steps)
    assert steps[0].note == "9.5 m to go"


def test_far_goals_are_flown_to_at_the_limit():
    path, steps = follow(SIXTY, (0.0, 0.0, -2.0), 4.0, targets={"trunk": marker(60, 20, -5)})
    speeds = np.linalg.norm(np.diff(path, axis=0), axis=1) / TICK
    assert speeds[-20:] == pytest.approx(2.0, abs=0.02)
    assert {round(step.guidance.yaw, 1) for step in steps} == {0.3}


def test_it_passes_between_what_the_scan_sees():
    east = np.linspace(-2.0, 2.0, 15)
    wall = np.column_stack([np.full(15, 4.0), east + np.where(east > 0, 1.2, -1.2), 0 * east - 2.0])
    path, steps = follow(GO, (8.0, 0.3, -2.0), 7.0, obstacles=wall, scanned_at=10.0)
    assert steps[-1].done
    gaps = np.linalg.norm(path[:, None, :2] - wall[None, :, :2], axis=2)
    assert gaps.min() >= GO.body + GO.clearance


def test_it_keeps_clear_of_the_walls_of_a_map():
    costs = np.ones((40, 40))
    costs[19:21, :22] = np.inf  # 0.5 m cells: north 4.5 to 5.5, up to east 1
    known = Occupancy(costs, 0.5, (-5.0, -10.0))
    path, steps = follow(GO, (9.0, 0.0, -2.0), 9.0, map=known)
    assert steps[-1].done
    assert min(known.gap((north, east)) for north, east, _ in path) >= GO.body + GO.clearance


def test_it_keeps_clear_of_a_target_that_crosses():
    """Where it will be counts: at rest in the same place it would be in nobody's way."""
    behavior = GO.model_copy(update={"obstacles": ("robot",)})

    def crossing(now):
        return {"robot": robot(4.0, 2.0 - 0.7 * (now - 10.0), 0.0, velocity=vec(0.0, -0.7, 0.0))}

    path, steps = follow(behavior, (8.0, 0.0, -2.0), 8.0, targets=crossing)
    assert steps[-1].done
    times = TICK * np.arange(1, len(path) + 1)
    gaps = np.hypot(path[:, 0] - 4.0, path[:, 1] - (2.0 - 0.7 * times))
    assert gaps.min() >= behavior.keep_out
    straight, _ = follow(GO, (8.0, 0.0, -2.0), 8.0, targets=crossing)
    gaps = np.hypot(straight[:, 0] - 4.0, straight[:, 1] - (2.0 - 0.7 * times))
    assert gaps.min() < behavior.keep_out


def test_without_a_plan_it_comes_to_rest_says_so_once_and_goes_on_when_there_is_one():
    ring = 0.8 * np.array([[math.cos(a), math.sin(a)] for a in np.linspace(0.0, 6.0, 16)])
    shut = np.column_stack([8.0 + ring[:, 0], ring[:, 1], np.full(16, -2.0)])
    far = np.array([[30.0, 0.0, -2.0]])

    def opens(now):
        return shut if now < 12.0 else far

    _, steps = follow(GO, (8.0, 0.0, -2.0), 9.0, obstacles=opens, scanned_at=10.0)
    closed = steps[:39]
    assert all(step.stop and step.guidance is None for step in closed)
    assert [step.events for step in closed if step.events] == [(NO_PLAN,)]
    assert closed[0].note == "no plan keeps its distances, 8.0 m to go: coming to rest"
    assert steps[-1].done


def test_a_vehicle_that_is_too_fast_comes_to_rest_first():
    seen = at(10.0, 9.0, 0.0, -2.0, velocity=vec(-4.0, 0.0, 0.0), home=HOME, status=status())
    (step,) = play(GO, [seen])
    assert step.stop


@pytest.mark.parametrize("bad", [math.nan, math.inf])
@pytest.mark.parametrize("where", ["position", "velocity", "home"])
def test_what_is_not_a_number_leads_to_rest_and_nowhere_else(where, bad):
    here = {"position": vec(9.0, 0.0, -2.0), "velocity": vec(0.0, 0.0, 0.0), "home": HOME}
    (step,) = play(GO, [calm(**{**here, where: vec(bad, 0.0, 0.0)})])
    assert step.stop
    assert step.guidance is None


@pytest.mark.parametrize(("target", "known"), [("home", {"home": None}), ("trunk", {})])
def test_an_unknown_place_is_not_a_goal(target, known):
    (step,) = play(DdpGoTo(target=target), [at(10.0, 0.0, 0.0, -2.0, **known)])
    assert (step.guidance, step.goal, step.done, step.stop) == (None, None, False, False)
    assert step.note == f"the position of {target} is unknown"


def test_it_needs_the_targets_it_stays_clear_of():
    behavior = DdpGoTo(target="trunk", obstacles=("robot",))
    assert behavior.targets() == ("trunk", "robot")
    assert GO.targets() == ()


def test_a_first_plan_is_searched_for_over_several_ticks(monkeypatch):
    """No tick solves more than once, and the plan that is flown is kept while it is clear."""
    solved = []

    def counted(*given, **more):
        solved.append(given)
        return solver.solve(*given, **more)

    monkeypatch.setattr(flight_plan, "solve", counted)
    wall = np.array([[4.0, east, -2.0] for east in np.linspace(-1.0, 1.0, 9)])
    seen = [at(10.0 + TICK * n, 0.0, 0.0, -2.0, obstacles=wall, scanned_at=10.0) for n in range(8)]
    known = {"trunk": marker(8, 0, -2)}
    counts = []
    for step in play_each(SIXTY, (it._replace(targets=known) for it in seen)):
        counts.append(len(solved))
        if step.guidance is not None:
            break
    assert len(counts) > 1
    assert np.diff([0, *counts]).max() == 1


def play_each(behavior, story):
    """Yield each step as it is made."""
    memory = None
    for seen in story:
        memory = memory or behavior.begin(seen)
        step = behavior.step(seen, memory)
        memory = step.memory
        yield step
