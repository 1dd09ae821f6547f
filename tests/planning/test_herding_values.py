"""The table behind the herding policy, against independent computations."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from missionkit.ground_robot import GroundRobot
from missionkit.planning.herding import gain, value_table
from missionkit.planning.herding import robot_forecast as fc
from missionkit.planning.herding.value_iteration import values
from missionkit.sim import ground_robots as gr

ROBOT = GroundRobot()
HALF = 4.0
NEVER = (math.inf, math.inf)


def brute_force(steps, cells, headings, prices):
    """Return V by recursion over whole arrays: paths of 0.05 s, scipy's interpolation."""
    axis, circle = np.linspace(-HALF, HALF, cells), 2.0 * np.pi * np.arange(headings + 1) / headings
    H, X, Y = np.meshgrid(circle[:-1], axis, axis, indexing="ij")
    largest = 2.0 * 0.032 * 0.85 / 0.258
    V = [np.zeros(H.shape)]
    for k in range(1, steps + 1):
        grid = RegularGridInterpolator((circle, axis, axis), np.concatenate((V[-1], V[-1][:1])))

        def driven(turned, time, grid=grid):
            total = np.zeros(H.shape)
            for turn in largest * np.array([-0.8, -0.4, 0.0, 0.4, 0.8]):
                x, y, ends = X.copy(), Y.copy(), np.full(H.shape, np.nan)
                for t in np.arange(0.0, time, 0.01) + 0.005:
                    heading = H + turned + turn * min(1.0, t / 0.85)
                    x, y = x + 0.0033 * np.cos(heading), y + 0.0033 * np.sin(heading)
                    ends = np.where(np.isnan(ends) & (x >= HALF), 1.0, ends)
                    out = (x <= -HALF) | (np.abs(y) >= HALF)
                    ends = np.where(np.isnan(ends) & out, 0.0, ends)
                at = np.stack(((H + turned + turn) % (2.0 * np.pi), x, y), axis=-1)
                later = grid(np.clip(at, (0.0, -HALF, -HALF), (2.0 * np.pi, HALF, HALF)))
                total += np.where(np.isnan(ends), later, ends) / 5.0
            return total

        back, none, price = driven(np.pi, 5.0 - 2.456), driven(0.0, 5.0), prices[0]
        if k % 4 == 0:
            V.append(np.maximum(back, driven(0.0, 0.0) - price))
        else:
            ways = [none, back - price]
            if prices[1] < np.inf:
                ways.append(driven(np.pi / 4.0, 5.0 - 0.614) - prices[1])
                ways.append(driven(np.pi / 2.0, 5.0 - 1.228) - 2.0 * prices[1])
            V.append(np.max(ways, axis=0))
    return np.array(V)


@pytest.mark.parametrize("prices", [(0.2, math.inf), (0.2, 0.12)])
def test_value_iteration_against_brute_force(prices):
    """They differ where a path grazes an edge: there one sees an arc and the other a chord."""
    ours, theirs = values(5, 7, 8, HALF, prices, ROBOT), brute_force(5, 7, 8, prices)
    off = np.abs(ours - theirs)
    assert np.mean(off) < 0.01
    assert np.quantile(off[:, :, 1:-1, 1:-1], 0.98) < 0.03
    assert ours.max() <= 1.0
    assert ours.min() >= 0.0


def sampled(x, y, heading, reversal_in, length, runs=1000):
    """Return the share of sampled robots of the simulator that come home, nobody turning them."""
    rng = np.random.default_rng(3)
    robots = gr.placed(
        np.tile((x, y), (runs, 1)),
        np.full(runs, heading),
        np.full(runs, reversal_in),
        ROBOT,
        obstacles=0,
    )
    offsets = gr.random_offsets(rng, runs, length, ROBOT)
    home, inside = np.zeros(runs, bool), np.ones(runs, bool)
    for _ in range(round(length / 0.1)):
        gr.advance(robots, offsets, ROBOT, 0.1)
        n, e = robots[:, gr.NORTH], robots[:, gr.EAST]
        home |= inside & (n >= 10.0) & (np.abs(e) < 10.0)
        inside &= (np.abs(n) < 10.0) & (np.abs(e) < 10.0)
    return home.mean()


@pytest.mark.parametrize(
    ("place", "heading", "reversal_in", "length"),
    [((7.5, 0.0), 0.2, 13.0, 30.0), ((6.0, 6.5), 0.6, 3.0, 60.0), ((5.0, -6.0), 2.6, 8.5, 90.0)],
)
def test_the_model_against_sampled_robots(place, heading, reversal_in, length):
    V = values(24, 41, 40, 10.0, NEVER, ROBOT)
    state = np.array([*place, heading, 0.0, reversal_in])
    expected = gain.worth(state, length, gain.Outlook(V, 10.0, ROBOT))
    assert expected == pytest.approx(sampled(*place, heading, reversal_in, length), abs=0.06)


@pytest.mark.parametrize("spin_left", [0.0, 1.3])
def test_the_forecast_is_the_simulators_without_random_turns(spin_left):
    truth = gr.placed(np.zeros((1, 2)), np.array([0.4]), np.array([7.0]), ROBOT, obstacles=0)
    state = np.array([0.0, 0.0, 0.4, spin_left, 7.0])
    truth[0, gr.SPIN_LEFT] = spin_left
    for dt in (3.0, 4.7, 2.2, 17.0):
        gr.advance(truth, np.zeros((1, 20)), ROBOT, dt)
        assert fc.forecast(state, dt, 50.0, ROBOT) == fc.INSIDE
        same = (gr.NORTH, gr.EAST, gr.HEADING, gr.SPIN_LEFT, gr.REVERSAL_IN)
        assert state == pytest.approx(truth[0, same], abs=1e-9)


@pytest.mark.parametrize(
    ("start", "way", "where"),
    [
        ((9.0, 0.0), (2.0, 0.0), fc.HOME),
        ((9.0, 9.5), (2.0, 0.9), fc.HOME),
        ((9.0, 9.5), (2.0, 1.1), fc.LOST),  # the side first
        ((9.5, 9.0), (2.0, 1.1), fc.HOME),
        ((-9.0, 0.0), (-2.0, 0.0), fc.LOST),
        ((9.0, 0.0), (0.5, 0.5), fc.INSIDE),
    ],
)
def test_where_a_robot_leaves(start, way, where):
    assert fc.crossed(*start, *way, 10.0) == where


def test_a_turn_pays_where_it_must_and_cannot_be_made_in_a_spin():
    known = gain.Outlook(values(24, 21, 16, 10.0, (0.2, math.inf), ROBOT), 10.0, ROBOT)
    spin = gain.Spins(ROBOT.spin_time, 2.4, 1)
    leaving = np.array([8.0, 9.0, 0.75 * np.pi, 0.0, 14.5])
    assert gain.gain(leaving, 2.0, spin, 100.0, known) > 0.8
    assert math.isnan(gain.gain(leaving, 4.4, spin, 100.0, known))  # it has left
    assert math.isnan(gain.gain(leaving, 2.0, spin, 1.0, known))  # time is up
    home = np.array([8.0, 0.0, 0.0, 0.0, 15.0])
    assert gain.gain(home, 2.0, spin, 100.0, known) < -0.05
    home[fc.SPIN_LEFT] = 2.2
    assert math.isnan(gain.gain(home, 2.0, spin, 100.0, known))


@pytest.mark.parametrize(
    ("begin", "end", "expected"), [(0.0, 3.0, False), (3.0, 9.0, True), (9.0, 12.0, False)]
)
def test_an_obstacle_robot_obstructs_the_places_it_comes_by(begin, end, expected):
    others = np.array([[2.0, 0.0, 0.5 * np.pi, 0.33, 0.066]])  # clockwise round (-3, 0)
    x, y = 5.0 * np.cos(0.4) - 3.0, 5.0 * np.sin(0.4)  # it is there after 6.06 s
    assert gain.obstructed(x, y, begin, end, others) is expected


def test_a_table_is_kept_on_disk_and_a_broken_file_is_replaced(tmp_path, monkeypatch):
    monkeypatch.setattr(value_table, "folder_for", lambda module: tmp_path)
    monkeypatch.setattr(value_table, "CELLS", 5)
    monkeypatch.setattr(value_table, "HEADINGS", 8)
    table = value_table.value_table.__wrapped__
    first = table(20.0, HALF, (0.2, math.inf), ROBOT)
    (path,) = tmp_path.iterdir()
    again = table(20.0, HALF, (0.2, math.inf), ROBOT)
    assert again.tobytes() == first.tobytes()
    path.write_bytes(b"broken")
    assert table(20.0, HALF, (0.2, math.inf), ROBOT).tobytes() == first.tobytes()
    assert np.load(path).tobytes() == first.tobytes()
    other = table(20.0, HALF, (0.3, math.inf), ROBOT)
    assert other.tobytes() != first.tobytes()
