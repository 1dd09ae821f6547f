"""Figures that differ are printed so that they differ."""

from __future__ import annotations

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from missionkit.number_text import beside, beside_short, rounded_down, rounded_up

NUMBERS = st.floats(-1e6, 1e6, allow_subnormal=False)


def order(value, limit):
    return (value > limit) - (value < limit)


@pytest.mark.parametrize("written", [beside, beside_short])
@given(NUMBERS, st.one_of(NUMBERS, st.sampled_from([0.1, 5.0, 0.02])), st.integers(1, 4))
@settings(derandomize=True, database=None, max_examples=200)
def test_two_texts_compare_as_their_numbers_do(written, value, limit, digits):
    for one, other in ((value, limit), (limit * (1 + 1e-9), limit), (limit, limit)):
        shown, border = map(float, written(one, other, digits))
        assert order(shown, border) == order(one, other)


def test_no_more_digits_are_shown_than_needed():
    assert beside(0.2, 0.1, 2) == ("0.20", "0.1")
    assert beside(0.10004, 0.1, 2) == ("0.10004", "0.1")
    assert beside_short(1.0, 1.5, 2) == ("1", "1.5")


@pytest.mark.parametrize("value", [math.inf, -math.inf, math.nan])
def test_a_figure_that_is_not_finite_is_written_too(value):
    assert beside(value, 0.1, 2) == (str(value), "0.1")


@given(st.floats(0, 1e4))
@settings(derandomize=True, database=None)
def test_what_is_advised_is_on_the_safe_side(value):
    assert float(rounded_up(value, 2)) >= value - 1e-9
    assert float(rounded_down(value, 2)) <= value + 1e-9
