from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from missionkit.geometry import vec
from missionkit.messages import Setpoint
from missionkit.vehicle.command.velocity_correction import (
    COMPARABLE_AGE,
    LARGEST_CORRECTION,
    Correction,
    corrected,
    step,
)
from missionkit.vehicle.telemetry.observer import TimedVelocity

PERIOD = 0.05
BIAS = vec(0.2, -0.15, 0.05)
ANYTHING = st.floats(allow_nan=True, allow_infinity=True)
VELOCITIES = st.tuples(ANYTHING, ANYTHING, ANYTHING).map(lambda each: vec(*each))
MOVING = st.none() | st.builds(TimedVelocity, ANYTHING, VELOCITIES)


def run(ticks, own, said, correction=None):
    """Step from tick to tick; `own` and `said` give velocities at a time, or None."""
    correction = Correction() if correction is None else correction
    first = 0 if correction.at is None else round(correction.at / PERIOD) + 1
    for tick in range(first, first + ticks):
        now = tick * PERIOD
        correction = step(correction, now, own(now), said(now))
    return correction


def still(now):
    return TimedVelocity(now, vec(0.0, 0.0, 0.0))


def biased(now):
    return TimedVelocity(now - 0.03, BIAS)


def nothing(now):
    return None


def test_it_becomes_the_difference_with_its_time_constant() -> None:
    at_once = run(1, still, biased)
    assert at_once.offset == pytest.approx([0.0, 0.0, 0.0])
    assert run(6, still, biased).offset == pytest.approx(BIAS * (1 - math.exp(-1.0)))
    assert run(60, still, biased).offset == pytest.approx(BIAS, abs=1e-5)


def test_acceleration_is_not_a_difference_at_any_telemetry_delay() -> None:
    def own(now):
        return TimedVelocity(now, vec(2.0 * now, 0.0, 0.0))

    def said(now):
        return TimedVelocity(now - 0.2, vec(2.0 * (now - 0.2), 0.0, 0.0))

    assert run(40, own, said).offset == pytest.approx([0.0, 0.0, 0.0], abs=0.2)
    later = run(40, own, said)
    assert run(40, own, said, later).offset == pytest.approx([0.0, 0.0, 0.0], abs=1e-3)


@pytest.mark.parametrize(
    ("own", "said"),
    [
        pytest.param(nothing, biased, id="no target is seen"),
        pytest.param(still, nothing, id="the stream is lost"),
        pytest.param(still, lambda now: TimedVelocity(now - 2 * COMPARABLE_AGE, BIAS), id="old"),
        pytest.param(
            still, lambda now: TimedVelocity(now + 2 * COMPARABLE_AGE, BIAS), id="from the future"
        ),
        pytest.param(
            still, lambda now: TimedVelocity(now, vec(math.nan, 0.0, 0.0)), id="not a number"
        ),
        pytest.param(lambda now: TimedVelocity(now, vec(0.0, math.inf, 0.0)), biased, id="nor we"),
    ],
)
def test_it_fades_out_when_there_is_nothing_to_compare(own, said) -> None:
    learnt = run(60, still, biased)
    assert run(5, own, said, learnt).offset == pytest.approx(BIAS * math.exp(-1.0), rel=1e-3)
    assert run(60, own, said, learnt).offset == pytest.approx([0.0, 0.0, 0.0], abs=1e-5)


def test_it_is_bounded_and_keeps_its_direction() -> None:
    wild = run(60, still, lambda now: TimedVelocity(now, vec(30.0, 40.0, 0.0)))
    assert np.linalg.norm(wild.offset) <= LARGEST_CORRECTION + 1e-9
    assert wild.offset / np.linalg.norm(wild.offset) == pytest.approx([0.6, 0.8, 0.0])


@given(st.lists(st.tuples(st.floats(-1e3, 1e3), MOVING, MOVING), max_size=12))
def test_any_input_gives_a_finite_and_bounded_result(ticks) -> None:
    correction = Correction()
    for now, own, said in ticks:
        correction = step(correction, now, own, said)
        assert np.isfinite(correction.offset).all()
        assert np.linalg.norm(correction.offset) <= LARGEST_CORRECTION + 1e-9


def test_the_setpoint_turns_as_before() -> None:
    sent = corrected(Setpoint(vec(1.0, 0.0, 0.0), 0.3), Correction(BIAS))
    assert sent.velocity == pytest.approx([1.2, -0.15, 0.05])
    assert sent.yaw_rate == 0.3
