"""Following a planned path: the reference it gives, and how it answers what is in the way."""

from __future__ import annotations

import math

import numpy as np
import pytest
from playing import at, play

from missionkit.behaviors.follow_path import FollowPath
from missionkit.geometry import norm, vec
from missionkit.messages import Health, Target
from missionkit.planning import path_following
from missionkit.planning.polygon_cells import drawn

AREA = ((-2.0, -2.0), (12.0, 8.0))
WALL = [(4.0, -2.0), (4.2, -2.0), (4.2, 3.0), (4.0, 3.0)]
ROOM = drawn(AREA, 0.1, [WALL])
GOAL = {"goal": Target("goal", vec(8.0, 0.0, 0.0), 0.1, None, None, None)}
SURE = Health(True, False, 10.0, None, 0.0, 0)
FLY = FollowPath(target="goal", height=2.0)


def seen(now, *place, **changes):
    about = {"targets": GOAL, "map": ROOM, "health": SURE} | changes
    return at(now, *place, **about)


def flown(behavior, seconds=60.0, speed=None, **changes):
    """Fly the reference exactly from (0, 0), at half a second a step; return places and steps."""
    place, now, memory = vec(0.0, 0.0, -2.0), 10.0, behavior.begin(seen(10.0, 0.0, 0.0, -2.0))
    places, steps = [], []
    while now < 10.0 + seconds:
        step = behavior.step(seen(now, *place, **changes), memory)
        memory = step.memory
        places.append(place)
        steps.append(step)
        if step.done:
            break
        if step.guidance is not None:
            pull = step.guidance.position - place
            velocity = (
                step.guidance.velocity if step.guidance.velocity is not None else vec(0, 0, 0)
            )
            place = place + 0.05 * velocity + 0.1 * pull
        now += 0.05
    return np.array(places), steps


@pytest.mark.parametrize("neighbours", [4, 8])
@pytest.mark.parametrize("smooth", [False, True])
def test_it_flies_round_the_wall_to_the_goal(neighbours, smooth):
    places, steps = flown(FollowPath(target="goal", neighbours=neighbours, smooth=smooth))
    assert steps[-1].done
    assert not steps[-2].done
    off = np.maximum(
        np.maximum(np.min(WALL, 0) - places[:, :2], places[:, :2] - np.max(WALL, 0)), 0
    )
    assert np.hypot(*off.T).min() > 0.85
    moved = np.linalg.norm(np.diff(places[:, :2], axis=0), axis=1) / 0.05
    assert np.median(moved) > 0.3
    wanted = [norm(step.guidance.velocity) for step in steps]
    assert max(wanted) <= 0.5 + 1e-9
    assert {step.guidance.speed for step in steps} == {0.5}


def test_it_keeps_its_height_or_the_one_it_began_with():
    assert {step.guidance.position[2] for step in flown(FLY, 5.0)[1]} == {-2.0}
    began = play(FollowPath(target="goal"), [seen(10.0, 0.0, 0.0, -3.5)])
    assert began[0].guidance.position[2] == -3.5


def test_the_nose_looks_along_the_path_or_stays():
    _, along = flown(FLY, 5.0)
    route = along[20].memory.spots
    ahead = path_following.leg_at(path_following.legs(route), along[20].memory.along + 1.0)
    assert along[20].guidance.yaw == pytest.approx(math.atan2(ahead.way[1], ahead.way[0]), abs=0.4)
    free = FollowPath(target="goal", heading="free")
    turned = play(free, [seen(10.0 + n, 0.0, 0.0, -2.0, yaw=1.2) for n in range(3)])
    assert [step.guidance.yaw for step in turned] == pytest.approx([1.2] * 3)


def test_without_a_map_or_a_target_it_stays_and_reports_it():
    (step,) = play(FLY, [seen(10.0, 0.0, 0.0, -2.0, map=None)])
    assert (step.guidance, step.note) == (None, "there is no map")
    (step,) = play(FLY, [seen(10.0, 0.0, 0.0, -2.0, targets={})])
    assert (step.guidance, step.note) == (None, "the position of goal is unknown")


def test_it_plans_at_rest_only():
    moving = seen(10.0, 0.0, 0.0, -2.0, velocity=vec(0.4, 0.0, 0.0))
    first, second = play(FLY, [moving, seen(10.05, 0.0, 0.0, -2.0)])
    assert first.events == ()
    assert first.guidance.position[:2] == pytest.approx([0.12, 0.0])
    assert second.events == ("path.planned",)


def test_an_unsure_filter_keeps_further_off_where_there_is_room():
    narrow = drawn(AREA, 0.1, [WALL, [(4.0, 6.5), (4.2, 6.5), (4.2, 8.0), (4.0, 8.0)]])
    unsure = SURE._replace(position_sd=0.3)
    gaps = []
    for known in (ROOM, narrow):
        for health in (SURE, unsure):
            (step,) = play(FLY, [seen(10.0, 0.0, 0.0, -2.0, health=health, map=known)])
            path = path_following.legs(step.memory.spots)
            gaps.append(min(known.gap(path[0].at(0) if not s else _at(path, s)) for s in range(12)))
    assert gaps[1] > gaps[0] + 0.2
    assert gaps[3] > 1.0


def _at(path, along):
    return path_following.leg_at(path, along).at(along)


def door(north, east, down=-2.0):
    """Return the scan of a closed door 1 m wide."""
    return np.array([[north, east + off, down] for off in np.arange(-0.5, 0.51, 0.1)])


def test_what_the_scan_sees_on_the_path_stops_it_and_leads_round():
    begun, stopped, waits, planned = play(
        FLY,
        [
            seen(10.0, 0.0, 0.0, -2.0),
            seen(10.6, 0.0, 0.0, -2.0, obstacles=door(1.3, 1.2), velocity=vec(0.3, 0.3, 0.0)),
            seen(10.7, 0.05, 0.05, -2.0, obstacles=door(1.3, 1.2), velocity=vec(0.2, 0.2, 0.0)),
            seen(11.0, 0.08, 0.08, -2.0, obstacles=door(1.3, 1.2)),
        ],
    )
    assert begun.events == planned.events == ("path.planned",)
    assert stopped.note == waits.note == "the path is blocked: stopping"
    assert stopped.guidance.velocity is None
    assert stopped.guidance.position[:2].tolist() == [0.0, 0.0]  # it has hardly left it
    gap = [
        min(
            math.dist(_at(path_following.legs(step.memory.spots), s), point[:2])
            for point in door(1.3, 1.2)
        )
        for step in (begun, planned)
        for s in np.arange(0.0, 6.0, 0.1)
    ]
    assert min(gap[:60]) < 0.6
    assert min(gap[60:]) > 0.95
    unseen = FLY.step(seen(12.0, 0.08, 0.08, -2.0), planned.memory._replace(spots=()))
    assert unseen.memory.spots == planned.memory.spots


def test_it_stops_where_it_is_once_it_has_left_the_place_where_it_stood():
    begun = FLY.step(seen(10.0, 0.0, 0.0, -2.0), FLY.begin(seen(10.0, 0.0, 0.0, -2.0)))
    on, ahead = begun.memory, _at(path_following.legs(begun.memory.spots), 0.5)
    blocking = door(ahead[0] + 0.9, ahead[1] + 0.9)
    moving = seen(11.0, *ahead, -2.0, obstacles=blocking, velocity=vec(0.3, 0.3, 0.0))
    stopped = FLY.step(moving, on)
    assert stopped.note == "the path is blocked: stopping"
    assert stopped.guidance.position[:2] == pytest.approx([ahead[0] + 0.09, ahead[1] + 0.09])


def test_a_path_blocked_before_departure_does_not_move_the_hold_position():
    """Blown 5 cm each time it tries, it would be carried into the wall that it stands before."""
    memory, places = FLY.begin(seen(10.0, 0.0, 0.0, -2.0)), []
    for n in range(60):
        way = path_following.legs(memory.spots)
        block = door(*_at(way, 1.5)) if way else door(-1.5, 0.0)
        drifted = seen(10.0 + 0.3 * n, 0.005 * n, 0.0, -2.0, obstacles=block)
        step = FLY.step(drifted, memory)
        memory = step.memory
        if not memory.spots:
            places.append(step.guidance.position.tolist())
    assert len(places) > 20
    assert places == [[0.0, 0.0, -2.0]] * len(places)


def test_while_it_stands_it_keeps_off_a_wall_that_its_drift_brings_near():
    shut = ROOM.with_walls([(4.1, 3.0 + 0.1 * n) for n in range(51)])  # no way: it stands
    memory, offs = FLY.begin(seen(10.0, 0.0, 0.0, -2.0)), []
    for n in range(100):
        wall = np.array([[1.2 - 0.01 * n, east, -2.0] for east in np.arange(-2.0, 2.0, 0.1)])
        step = FLY.step(seen(10.0 + 0.1 * n, 0.0, 0.0, -2.0, map=shut, obstacles=wall), memory)
        memory = step.memory
        offs.append(wall[0, 0] - step.guidance.position[0])
    assert offs[0] == pytest.approx(1.2)
    assert min(offs) == pytest.approx(0.85, abs=0.01)


def test_what_the_scan_sees_elsewhere_does_not_matter():
    steps = play(FLY, [seen(10.0 + n, 0.0, 0.0, -2.0, obstacles=door(-1.5, 0.0)) for n in range(3)])
    assert [step.events for step in steps] == [("path.planned",), (), ()]


def test_a_changed_map_is_replanned():
    closed = ROOM.with_walls([(1.0, -2.0 + 0.1 * n) for n in range(60)])
    first, stopped, planned = play(
        FLY,
        [
            seen(10.0, 0.0, 0.0, -2.0),
            seen(11.0, 0.0, 0.0, -2.0, map=closed),
            seen(12.0, 0.0, 0.0, -2.0, map=closed),
        ],
    )
    assert stopped.note == "the path is blocked: stopping"
    assert planned.events == ("path.planned",)
    assert first.memory.spots != planned.memory.spots


def test_without_a_path_it_stops_notifies_the_chart_and_tries_again():
    shut = ROOM.with_walls([(4.1, 3.0 + 0.1 * n) for n in range(51)])
    times = (10.0, 10.5, 11.9, 12.1)
    none, *waiting, again = play(FLY, [seen(now, 0.0, 0.0, -2.0, map=shut) for now in times])
    assert none.events == again.events == ("path.none",)
    assert [step.events for step in waiting] == [(), ()]
    assert none.note == "no way from (0.00, 0.00) to (8.00, 0.00) that keeps 1.05 m"
    assert none.guidance.position.tolist() == [0.0, 0.0, -2.0]


def test_obstacles_out_of_sight_are_forgotten_when_there_is_no_other_way():
    gone = play(FLY, [seen(10.0, 0.0, 0.0, -2.0)])[0].memory
    ring = [(4.1, 3.0 + 0.1 * n) for n in range(51)]
    memory = gone._replace(spots=(), sensed=tuple(ring), again=0.0)
    step = FLY.step(seen(20.0, 0.0, 0.0, -2.0), memory)
    assert step.events == ("path.planned",)
    assert step.memory.sensed == ()


def test_speed_falls_before_corners_and_the_end():
    path = path_following.legs(((0.0, 0.0), (5.0, 0.0), (5.0, 5.0)))
    speeds = [
        path_following.allowed_speed(path, along, 2.0, 0.5) for along in (0.0, 4.0, 5.0, 6.0, 9.9)
    ]
    assert speeds[0] == 2.0
    assert speeds[1] == pytest.approx(math.sqrt(0.01 + 1.0))
    assert speeds[2] == pytest.approx(path_following.CORNER_SPEED)
    assert speeds[3] == 2.0
    assert speeds[4] == pytest.approx(math.sqrt(0.1))


def test_the_nearest_point_is_never_behind_and_not_on_a_later_lap():
    path = path_following.legs(((0.0, 0.0), (5.0, 0.0), (5.0, 0.5), (0.0, 0.5)))
    assert path_following.nearest(path, 1.0, (1.7, 0.4)) == pytest.approx(1.7)
    assert path_following.nearest(path, 3.0, (1.7, 0.4)) == 3.0
    assert path_following.nearest(path, 4.8, (4.9, 0.6)) == pytest.approx(5.6)
