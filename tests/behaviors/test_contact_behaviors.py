"""Landing in front of a tracked robot and touching its top: the way, refusals, the end."""

from __future__ import annotations

import math

import numpy as np
import pytest
from playing import TICK, at

from missionkit.behaviors.robot_contact import LandInFront, TouchTop
from missionkit.geometry import vec
from missionkit.messages import Target

SPEED, HEADING, REACH = 0.33, 0.5, 0.37  # m/s, rad, m: from centre to centre at a bump
WAY = np.array([math.cos(HEADING), math.sin(HEADING), 0.0])
RIGHT = np.array([-WAY[1], WAY[0], 0.0])


def robot(now, start, name="robot_4", *, obstacle=0.0, spin=0.0, **other):
    place = np.array(start, float) + SPEED * (now - 10.0) * WAY
    found = Target(name, place, 0.02, None, None, now, velocity=SPEED * WAY, heading=HEADING)
    modes = {"straight": 1.0 - spin, "spin": spin}
    classes = {"target": 1.0 - obstacle, "obstacle": obstacle}
    return found._replace(heading_sd=0.05, modes=modes, classes=classes, **other)


def named(*robots):
    return {**{it.name: it for it in robots}, "tracked": robots[0]}


def played(behavior, targets, seconds, start=(-2.0, 1.0, -2.5)):
    """The vehicle does exactly as it is guided; places, targets and steps until it is done."""
    place, velocity, memory, rows = np.array(start), np.zeros(3), None, []
    for n in range(round(seconds / TICK)):
        now = 10.0 + n * TICK
        seen = at(now, *place, velocity=velocity, targets=targets(now))
        step = behavior.step(seen, memory)
        memory = step.memory
        rows.append((now, place.copy(), seen.targets.get("tracked"), step))
        if step.done:
            break
        if step.guidance is not None:
            velocity = (step.guidance.position - place) / TICK
            place = place + TICK * np.clip(velocity, -2.2, 2.2)
        else:
            velocity = np.zeros(3)
    return rows


def test_it_lands_ahead_of_the_robot_which_then_runs_into_it():
    behavior = LandInFront()
    rows = played(behavior, lambda now: named(robot(now, (0.0, 0.0, 0.0))), 12.0)
    assert rows[-1][3].done
    down = next(row for row in rows if row[3].note.startswith("down"))
    offset = down[1] - down[2].position
    assert float(offset @ WAY) == pytest.approx(behavior.block, abs=0.1)
    assert float(offset @ WAY) > REACH
    assert abs(float(offset @ RIGHT)) < 0.05
    assert down[0] - 10.0 < 5.0
    last = rows[-1][1] - rows[-1][2].position
    assert float(last @ WAY) < REACH  # it has run into the vehicle
    assert all(row[3].lands for row in rows if row[1][2] > -1.0)


def test_down_it_waits_for_the_bump_though_the_camera_loses_the_robot():
    def seen(now):
        return named(robot(now, (0.0, 0.0, 0.0)))

    whole = played(LandInFront(), seen, 12.0)
    down = next(row[0] for row in whole if row[3].note.startswith("down"))
    rows = played(LandInFront(), lambda now: seen(now) if now <= down else {}, 12.0)
    lost = [row[3] for row in rows if row[2] is None]
    assert {it.note for it in lost} == {"down before robot_4"}
    assert lost[-1].done
    assert all(it.lands for it in lost)


def test_it_touches_the_top_of_a_robot_that_drives_on():
    rows = played(TouchTop(), lambda now: named(robot(now, (0.0, 0.0, 0.0))), 12.0)
    assert rows[-1][3].done
    offset = rows[-1][1] - rows[-1][2].position
    assert math.hypot(*offset[:2]) < 0.15
    assert offset[2] == pytest.approx(-0.1, abs=0.03)


@pytest.mark.parametrize("behavior", [LandInFront(), TouchTop()])
@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"obstacle": 0.2}, "robot_4 may be an obstacle robot (0.20)"),
        ({"heading": None}, "the heading of robot_4 is not known yet"),
        ({"heading_sd": 0.5}, "the heading of robot_4 is uncertain"),
        (None, "tracked is not tracked"),
    ],
)
def test_it_refuses_in_words_and_holds(behavior, changes, says):
    def targets(now):
        found = robot(now, (0.0, 0.0, 0.0))
        if changes is None:
            return {}
        if "obstacle" in changes:
            return named(robot(now, (0.0, 0.0, 0.0), **changes))
        return named(found._replace(**changes))

    rows = played(behavior, targets, 1.0)
    assert {row[3].note for row in rows} == {f"holding: {says}"}
    assert all(row[3].guidance is None and not row[3].done for row in rows)


def test_it_does_not_go_on_with_another_robot():
    def targets(now):
        return named(robot(now, (0.0, 0.0, 0.0), "robot_4" if now < 11.0 else "robot_7"))

    *_, last = played(LandInFront(), targets, 2.0)
    assert last[3].note == "holding: robot_4 is not tracked"
    assert last[3].guidance is None


def test_it_gives_up_what_is_not_possible_and_at_once_when_it_descends():
    def lost(now):
        return named(robot(now, (0.0, 0.0, 0.0))) if now <= 12.2 else {}

    rows = played(LandInFront(), lost, 6.0)
    assert rows[-2][3].note == "holding: robot_4 is not tracked"
    assert rows[-1][3].done
    assert rows[-1][3].events == ("meeting.given_up",)
    assert rows[-1][0] == pytest.approx(12.55)  # while it is 0.6 m up: a tower might come
    *_, last = played(LandInFront(), lambda now: {}, 6.0)
    assert (last[0], last[3].done) == (pytest.approx(12.0), True)


def crossing(now, north, obstacle=0.95):
    """An obstacle robot that drives towards the robot's way from its right."""
    return robot(now, (0.0, 0.0, 0.0), "robot_9", obstacle=obstacle)._replace(
        position=(north * WAY + 2.2 * RIGHT) - SPEED * (now - 10.0) * RIGHT,
        heading=HEADING - 0.5 * math.pi,
    )


@pytest.mark.parametrize(("north", "blocked"), [(1.5, True), (5.5, False)])
def test_it_does_not_land_where_an_obstacle_robot_comes_by(north, blocked):
    def targets(now):
        return named(robot(now, (0.0, 0.0, 0.0)), crossing(now, north))

    rows = played(LandInFront(height=2.5), targets, 9.0)
    says = "robot_9 with its tower comes within" in rows[-1][3].note
    assert (rows[-1][3].done, says) == (True, blocked)
    assert bool(rows[-1][1][2] < -1.9) is blocked


def test_it_does_not_descend_beside_an_obstacle_robot_that_drives_away():
    def targets(now):
        leaves = robot(now, (0.0, 0.0, 0.0), "robot_9", obstacle=0.95)._replace(
            position=(0.6 - SPEED * (now - 10.0)) * WAY,
            velocity=-SPEED * WAY,
            heading=HEADING + math.pi,
        )
        return named(robot(now, (0.0, 0.0, 0.0)), leaves)

    rows = played(LandInFront(height=2.5), targets, 8.0, start=(*(0.8 * WAY[:2]), -2.5))
    assert rows[-1][3].note.startswith("down")
    low = [row for row in rows if row[3].note.startswith("descending")]
    gaps = [np.hypot(*(row[1] - targets(row[0])["robot_9"].position)[:2]) for row in low]
    assert min(gaps) > 0.6


def test_down_it_does_not_wait_for_an_obstacle_robot():
    down = []

    def targets(now):
        near = (crossing(now, 2.4),) if down else ()
        return named(robot(now, (0.0, 0.0, 0.0)), *near)

    behavior, memory = LandInFront(block=1.5, wait=9.0), None
    place = np.array((1.4, 0.8, -1.5))
    for n in range(300):
        now = 10.0 + n * TICK
        step = behavior.step(at(now, *place, velocity=np.zeros(3), targets=targets(now)), memory)
        memory = step.memory
        if step.done:
            break
        if step.guidance is not None:
            place = step.guidance.position
        if step.note.startswith("down"):
            down.append(now)
    assert step.done
    assert now - down[0] < 5.0


def test_a_robot_that_begins_to_spin_is_given_up():
    def targets(now):
        return named(robot(now, (0.0, 0.0, 0.0), spin=0.9 if now > 12.2 else 0.0))

    rows = played(LandInFront(), targets, 6.0)
    assert rows[-2][3].note.startswith("descending")
    assert (rows[-1][3].done, rows[-1][3].events) == (True, ("meeting.given_up",))
    assert rows[-1][0] == pytest.approx(12.25)


def spinning(now, ends=12.0):
    """A robot that ends its half turn at a time, and drives on by `WAY` then."""
    left = max(0.0, ends - now)
    turning = {"spin": 0.9, "spin_left": left} if left > 0.0 else {}
    found = robot(10.0 + max(0.0, now - ends), (0.0, 0.0, 0.0), **turning)
    return found._replace(heading=HEADING - 1.279 * left, seen_at=now)


def test_it_descends_while_a_robot_spins_to_where_it_drives_then():
    rows = played(LandInFront(), lambda now: named(spinning(now)), 9.0, start=(0.0, 0.0, -2.5))
    low = next(row[0] for row in rows if row[3].note.startswith("descending"))
    down = next(row for row in rows if row[3].note.startswith("down"))
    offset = down[1] - down[2].position
    assert low < 11.0  # it spins until 12 s
    assert float(offset @ WAY) == pytest.approx(0.5, abs=0.1)
    assert abs(float(offset @ RIGHT)) < 0.05


def test_it_does_not_descend_before_a_robot_whose_spin_may_end_at_any_time():
    rows = played(LandInFront(), lambda now: named(robot(10.0, (0.0, 0.0, 0.0), spin=0.9)), 4.0)
    assert {row[3].note for row in rows} == {"flying to robot_4"}


def test_it_leaves_soon_after_the_bump_though_nothing_shows_it():
    """From down there the camera sees nothing: the robot that is tracked seems to drive on."""
    rows = played(LandInFront(), lambda now: named(robot(now, (0.0, 0.0, 0.0))), 12.0)
    down = next(row for row in rows if row[3].note.startswith("down"))
    gap = float((down[1] - down[2].position) @ WAY)
    bump = down[0] + (gap - REACH) / SPEED
    assert rows[-1][0] == pytest.approx(bump + 0.4, abs=0.1)


def test_it_keeps_clear_of_obstacle_robots_on_the_way():
    def targets(now):
        tower = robot(now, (-0.2, 0.0, 0.0), "robot_9", obstacle=0.95)
        return named(robot(now, (1.5, 0.0, 0.0)), tower)

    rows = played(LandInFront(), targets, 12.0, start=(-2.0, -0.7, -1.5))
    gaps = [np.hypot(*(row[1] - targets(row[0])["robot_9"].position)[:2]) for row in rows]
    assert min(gaps) > 0.6
    assert rows[-1][3].done


@pytest.mark.parametrize("bad", [math.nan, math.inf])
@pytest.mark.parametrize("where", ["position", "velocity"])
def test_what_is_not_a_number_leads_nowhere(where, bad):
    given = {"velocity": np.zeros(3), where: vec(bad, 0.0, 0.0)}
    seen = at(10.0, -2.0, 1.0, -2.5, targets=named(robot(10.0, (0.0, 0.0, 0.0))))
    step = LandInFront().step(seen._replace(**given), None)
    assert step.guidance is None
