from __future__ import annotations

import math

import numpy as np
import pytest
from control.lagging import seen
from hypothesis import assume, given
from hypothesis import strategies as st

from missionkit.control.half_space import OUTWARD, admissible_speed, inside, kept
from missionkit.control.velocity_limits import Limits
from missionkit.geometry import vec
from missionkit.messages import HalfSpace

LIMITS = Limits()
SOUTH = HalfSpace(vec(10.0, 0.0, -2.0), vec(-1.0, 0.0, 0.0))  # the vehicle stays south of 10 m
NUMBER = st.floats(-20.0, 20.0)
VECTOR = st.tuples(NUMBER, NUMBER, NUMBER).map(lambda each: vec(*each))


@given(st.floats(0.0, 50.0))
def test_the_admissible_speed_stops_at_the_plane_after_lag_and_braking(gap: float) -> None:
    v = admissible_speed(gap, LIMITS)
    assert v * LIMITS.lag + v * v / (2.0 * LIMITS.braking) == pytest.approx(gap, abs=1e-9)


@given(st.floats(0.0, 50.0))
def test_beyond_the_plane_it_leads_back(depth: float) -> None:
    assert -OUTWARD <= admissible_speed(-depth, LIMITS) <= 0.0


@given(VECTOR, VECTOR, VECTOR, VECTOR)
def test_only_the_part_towards_the_plane_changes_and_never_grows(
    at, moving, wanted, normal
) -> None:
    size = float(np.linalg.norm(normal))
    assume(size > 0.1)
    bound = HalfSpace(vec(0.0, 0.0, 0.0), normal / size)
    before = (float(wanted[0]), float(wanted[1]), float(wanted[2]))
    after = np.array(kept(before, seen(at, moving), bound, LIMITS))
    change = after - wanted
    assert np.isfinite(after).all()
    assert np.linalg.norm(np.cross(change, bound.normal)) < 1e-9
    assert change @ bound.normal >= -1e-9


def test_far_away_and_on_the_way_out_nothing_changes() -> None:
    far = seen(vec(-50.0, 0.0, -2.0), vec(3.0, 0.0, 0.0))
    assert kept((3.0, 1.0, 0.5), far, SOUTH, LIMITS) == pytest.approx((3.0, 1.0, 0.5))
    near = seen(vec(9.9, 0.0, -2.0), vec(0.0, 0.0, 0.0))
    assert kept((-1.0, 1.0, 0.5), near, SOUTH, LIMITS) == pytest.approx((-1.0, 1.0, 0.5))


@pytest.mark.parametrize("moving", [0.0, -1.0, 0.3])
@pytest.mark.parametrize("gap", [0.2, 1.0, 3.0])
def test_a_slow_vehicle_is_commanded_no_faster_than_it_could_stop(gap, moving) -> None:
    slow = seen(vec(10.0 - gap, 0.0, -2.0), vec(moving, 0.0, 0.0))
    assert kept((8.0, 0.0, 0.0), slow, SOUTH, LIMITS)[0] <= admissible_speed(gap, LIMITS) + 1e-9


def test_a_vehicle_that_is_too_fast_is_sent_back() -> None:
    fast = seen(vec(9.0, 0.0, -2.0), vec(2.0, 0.0, 0.0))
    assert kept((0.5, 0.0, 0.0), fast, SOUTH, LIMITS)[0] < -0.5


def test_what_is_not_a_number_is_left_to_the_last_check() -> None:
    lost = seen(vec(math.nan, 0.0, 0.0))
    assert kept((0.5, 0.0, 0.0), lost, SOUTH, LIMITS) == (0.5, 0.0, 0.0)


@given(VECTOR)
def test_the_nearest_place_inside_is_inside(at) -> None:
    place = inside(at, SOUTH)
    assert (place - SOUTH.point) @ SOUTH.normal >= -1e-9
    assert np.linalg.norm(place - at) == pytest.approx(max(0.0, at[0] - 10.0))


@pytest.mark.parametrize("learnt", [0.0, 2.0], ids=["prompt", "integral wound up"])
def test_a_lagging_vehicle_commanded_through_the_plane_does_not_cross_it(learnt: float) -> None:
    """The velocity loop of a quadrotor with drag: a = k (u - v) - c v + i, i' = k_i (u - v)."""
    position, velocity, integral = -6.0, 3.0, learnt
    commands = [3.0] * 4  # 0.2 s on its way
    nearest = -math.inf
    for _ in range(400):
        now = seen(vec(10.0 + position, 0.0, -2.0), vec(velocity, 0.0, 0.0))
        commands.append(kept((3.0, 0.0, 0.0), now, SOUTH, LIMITS)[0])
        for _ in range(5):
            error = commands[-5] - velocity
            push = 1.8 * error - 1.0 * velocity + integral
            integral += 0.4 * error * 0.01
            velocity += max(-5.0, min(5.0, push)) * 0.01
            position += velocity * 0.01
        nearest = max(nearest, position)
    assert nearest < 0.15
    assert position == pytest.approx(0.0, abs=0.12)
