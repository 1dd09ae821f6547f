"""The algebra of boxes against trying out points."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from samples import calm

from missionkit.chart.checks.counterexample_text import point
from missionkit.chart.checks.interval_boxes import (
    MOST_BOXES,
    clipped,
    covered,
    difference,
    intersection,
    meet,
    outside,
    remains,
    union,
    within,
)
from missionkit.guards.battery import CHARGE, BatteryBelow
from missionkit.guards.distances import NearGoal
from missionkit.guards.link_loss import LinkLost
from missionkit.guards.tick_timing import TickOverrun
from missionkit.messages import Battery
from missionkit.messages.region import Box, Interval, Quantity

X = Quantity("x", least=0.0, most=4.0)
N = Quantity("n", least=0.0, most=3.0, whole=True)
VALUES: dict[Quantity, list[float | None]] = {
    X: [None, *(step / 4 for step in range(17))],
    N: [None, 0.0, 1.0, 2.0, 3.0],
}
POINTS = [dict(zip(VALUES, values, strict=True)) for values in itertools.product(*VALUES.values())]
ENDS = st.sampled_from([-1.0, 0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0])
INTERVALS = st.builds(Interval, ENDS, ENDS, st.booleans(), st.booleans())
BOXES = st.dictionaries(st.sampled_from([X, N]), INTERVALS | st.none(), max_size=2)
UNIONS = st.lists(BOXES, max_size=3).map(clipped)


def holds(interval: Interval, value: float) -> bool:
    above = value > interval.low or (value == interval.low and not interval.low_open)
    below = value < interval.high or (value == interval.high and not interval.high_open)
    return above and below


def inside(box: Box, values: dict[Quantity, float | None]) -> bool:
    for quantity, interval in box.items():
        value = values[quantity]
        if value is None or interval is None:
            if value is not interval:
                return False
        elif not holds(interval, value):
            return False
    return True


def among(boxes, values) -> bool:
    return any(inside(box, values) for box in boxes)


exhaustive = settings(deadline=None, derandomize=True, database=None, max_examples=200)


@exhaustive
@given(UNIONS, UNIONS)
def test_algebra_is_that_of_sets(one, other):
    both, either = intersection(one, other, sure=True), union([one, other], sure=True)
    rest = remains(one, other)
    for values in POINTS:
        here, there = among(one, values), among(other, values)
        assert among(both, values) == (here and there)
        assert among(either, values) == (here or there)
        assert among(rest, values) == (here and not there)
    # points in steps of a quarter meet every box whose ends are multiples of a half
    assert covered(one, other) == all(among(other, v) for v in POINTS if among(one, v))


@exhaustive
@given(UNIONS)
def test_outside_is_where_a_known_quantity_refutes(boxes):
    for box, values in itertools.product(boxes, POINTS):
        refuted = any(
            interval is not None
            and values[quantity] is not None
            and not holds(interval, values[quantity])
            for quantity, interval in box.items()
        )
        assert among(outside(box), values) == refuted


@exhaustive
@given(UNIONS, UNIONS)
def test_pieces_of_a_difference_do_not_overlap(one, other):
    for box, cut in itertools.product(one, other):
        for here, there in itertools.combinations(difference(box, cut), 2):
            assert meet(here, there) is None


@exhaustive
@given(INTERVALS)
def test_examples_are_inside(interval):
    for quantity in (X, N):
        cut = within(quantity, interval)
        if cut is not None:
            assert holds(interval, point(quantity, cut))


def test_caps_err_on_the_safe_side():
    many = tuple({Quantity(f"q{n}"): Interval.at_least(n)} for n in range(MOST_BOXES + 5))
    assert union([many], sure=False) == ({},)
    assert union([many], sure=True) == many[:MOST_BOXES]
    small = intersection(many[:9], many[20:30], sure=True)
    large = intersection(many[:9], many[20:30], sure=False)
    assert covered(small, many[:9])
    assert large == many[:9]


@pytest.mark.parametrize("charge", [0.0, 0.19, 0.2, 0.21, 1.0])
def test_a_guard_holds_where_it_says(charge):
    guard = BatteryBelow(floor=0.2)
    (box,) = guard.region().may
    assert guard.check(calm(battery=Battery(10.0, charge, 16.0))).holds == holds(
        box[CHARGE], charge
    )


@pytest.mark.parametrize("guard", [LinkLost(), NearGoal(radius=2), TickOverrun()])
def test_built_in_guards_declare_one_quantity_exactly(guard):
    region = guard.region()
    assert region.surely is None
    assert [len(box) for box in region.may] == [1]
