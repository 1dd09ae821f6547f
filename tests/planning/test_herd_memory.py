"""What is remembered of robots out of view: places, clocks and who is who."""

from __future__ import annotations

import math

import numpy as np
import pytest

from missionkit.ground_robot import GroundRobot
from missionkit.messages import Target
from missionkit.messages.herd import Arena
from missionkit.planning.herding import robot_forecast as fc
from missionkit.planning.herding.herd_memory import Seen, at_start
from missionkit.planning.herding.remembered_herd import Met, Sight, beginning, looked
from missionkit.sim import ground_robots as gr

ROBOT = GroundRobot()
ARENA = Arena()
NAMES = {0: "a", 1: "b"}
FAR = (9.0, 9.0)


def herd(clocks):
    """Return two robots of the simulator, back to back in the middle, and the memory of them."""
    places, headings = np.array([[1.0, 0.0], [-1.0, 0.0]]), np.array([0.0, math.pi])
    truth = gr.placed(places, headings, np.array(clocks), ROBOT, obstacles=0)
    return truth, at_start(2, ARENA)


def passed(truth, memory, seconds, watched=()):
    """Let time pass in steps of 0.5 s, some robots in view all the time, the others out of it."""
    offsets = gr.random_offsets(np.random.default_rng(1), len(truth), 600.0, ROBOT)
    spun = np.zeros(len(truth))
    for _ in range(round(seconds / 0.5)):
        gr.advance(truth, offsets, ROBOT, 0.5)
        memory.advance(0.5)
        spun = np.where(truth[:, gr.SPIN_LEFT] > 0.0, spun + 0.5, 0.0)
        seen = [Seen(f"track {i}", tuple(truth[i, :3]), float(spun[i])) for i in watched]
        memory.look(seen, FAR, 0.1)


def test_a_reversal_that_is_seen_tells_the_clock():
    truth, memory = herd([7.0, 7.0])
    assert memory.clock(0) is None
    passed(truth, memory, 12.0, watched=[0])
    assert memory.clock(0) == pytest.approx(truth[0, gr.REVERSAL_IN], abs=0.6)
    assert memory.clock(1) is None


def test_a_robot_out_of_view_is_where_its_clock_brings_it():
    truth, memory = herd([7.0, 18.0])
    passed(truth, memory, 12.0, watched=[0])
    passed(truth, memory, 20.0)
    robot = memory.robots(ARENA, NAMES, 2.0)[0]
    assert (robot.name, robot.in_view) == ("a", False)
    assert math.dist(robot.position, truth[0, :2]) < 2.0
    assert robot.found > 0.7


def test_where_a_robot_is_found_tells_its_clock():
    """It came back: so it reversed, and how far it is tells when."""
    truth, memory = herd([6.0, 18.0])
    passed(truth, memory, 16.0)
    assert memory.clock(0) is None
    passed(truth, memory, 1.0, watched=[0])
    off = memory.particles[0, :, 4] - truth[0, gr.REVERSAL_IN]
    assert memory.who == {"track 0": 0}
    assert np.abs((off + 10.0) % 20.0 - 10.0).mean() < 1.5


def test_an_empty_view_removes_a_robot_from_there():
    _, memory = herd([18.0, 18.0])
    memory.advance(0.5)
    (first, _) = memory.robots(ARENA, NAMES, 2.0)
    assert first.found > 0.9
    memory.look([], first.position, 3.0)
    found = {it.name: it for it in memory.robots(ARENA, NAMES, 2.0)}
    assert "a" not in found or found["a"].found < 0.5


def test_a_new_track_is_the_robot_that_agrees_with_it():
    truth, memory = herd([18.0, 18.0])
    passed(truth, memory, 5.0)
    memory.look([Seen(7, tuple(truth[1, :3])), Seen(8, tuple(truth[0, :3]))], FAR, 0.1)
    assert memory.who == {7: 1, 8: 0}
    memory.look([Seen(9, tuple(truth[1, :3]))], FAR, 0.1)
    assert memory.who == {9: 1}


def test_a_bump_leaves_the_clock_alone():
    truth, memory = herd([7.0, 7.0])
    passed(truth, memory, 12.0, watched=[0])
    before = memory.clock(0)
    state = tuple(truth[0, :3])
    memory.look([Seen("track 0", state, 0.5, ROBOT.spin_time)], FAR, 0.1)
    assert memory.clock(0) == before
    assert memory.particles[0, :, 3] == pytest.approx(ROBOT.spin_time - 0.5)


def test_a_spin_whose_begin_was_not_seen_leaves_the_clock_alone():
    truth, memory = herd([7.0, 7.0])
    passed(truth, memory, 12.0, watched=[0])
    known = memory.clock(0)
    memory.look([Seen("track 0", tuple(truth[0, :3]), math.nan)], FAR, 0.1)
    assert memory.clock(0) is None or memory.clock(0) != pytest.approx(20.0, abs=1.0)
    truth, memory = herd([7.0, 7.0])
    passed(truth, memory, 12.0, watched=[0])
    passed(truth, memory, known + 0.2)
    memory.look([Seen("track 0", tuple(truth[0, :3]), math.nan)], FAR, 0.1)
    gap = memory.clock(0) - truth[0, gr.REVERSAL_IN]
    assert math.remainder(gap, 20.0) == pytest.approx(0.0, abs=1.0)


def sighted(name, *, spin_left=None):
    place = np.array([3.0, 2.0, 0.0])
    found = Target(name, place, 0.02, None, None, 0.0, heading=0.3, heading_sd=0.05)
    return found._replace(modes={"spin": 0.9}, spin_left=spin_left)


def sight(now, robot, met_at, action="front"):
    return Sight(now, (robot,), (3.0, 2.0), 0.0, Met("robot_1", action, met_at))


@pytest.mark.parametrize(
    ("met_at", "own"),
    [
        (6.0, False),  # 3.5 s after the meeting began: the bump
        (9.0, True),  # 0.5 s after it: no vehicle is down so soon
        (0.0, True),  # 9.5 s after it: long left
    ],
)
def test_a_spin_is_a_bump_only_when_the_vehicle_may_have_been_down(met_at, own):
    at = 10.0  # it has spun for 0.5 s
    seen = sight(at, sighted("robot_1", spin_left=ROBOT.spin_time - 0.5), met_at)
    known = looked(beginning(1, ARENA), seen, ARENA)
    clocks = known.particles[0, :, fc.REVERSAL_IN]
    assert bool(np.allclose(clocks, 20.0 - 0.5)) is own


def test_a_spin_that_is_first_seen_after_a_meeting_began_with_the_bump():
    known = looked(beginning(1, ARENA), sight(11.0, sighted("robot_1"), 6.0), ARENA)
    assert np.allclose(known.particles[0, :, fc.SPIN_LEFT], ROBOT.spin_time - 1.6)


def test_a_touch_turns_by_a_quarter_of_a_spin():
    seen = sight(10.0, sighted("robot_1", spin_left=ROBOT.spin_time - 0.2), 6.8, "top")
    known = looked(beginning(1, ARENA), seen, ARENA)
    assert np.allclose(known.particles[0, :, fc.SPIN_LEFT], 0.25 * ROBOT.spin_time - 0.2)


@pytest.mark.parametrize(("action", "turn"), [("front", 180.0), ("top", 45.0)])
def test_a_robot_may_have_been_turned_while_the_vehicle_was_too_low_to_see_it(action, turn):
    before = sighted("robot_1")._replace(modes={})
    known = looked(beginning(1, ARENA), sight(0.5, before, -60.0), ARENA)
    met = Met("robot_1", action, 0.6)
    after = looked(known, Sight(8.0, (), (-9.0, 0.0), 0.0, met), ARENA)
    turned = np.degrees(after.particles[0, :, fc.HEADING] - 0.3)
    spun = known.particles[0, :, fc.REVERSAL_IN] < 7.5
    assert np.median(turned[~spun][1::2]) == pytest.approx(turn, abs=13.0)
    soon = looked(known, Sight(2.0, (), (-9.0, 0.0), 0.0, met), ARENA)  # given up at once
    assert np.abs(np.degrees(soon.particles[0, ~spun, fc.HEADING] - 0.3)).max() < 13.0
