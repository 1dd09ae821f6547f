"""The search for the smallest change: it is enough, and with 1 % less it is not."""

import numpy as np
import pytest

from missionkit.errors import Place
from missionkit.replays.mission_numbers import MissionNumber
from missionkit.replays.smallest_change import Trials, less, pair_changes, single_changes

PLACE = Place("m.yaml", 1, 1)


def number(name, value, signs=(-1, 1)):
    return MissionNumber(None, name, name, name, value, PLACE, signs)


def trials(judge, least=-np.inf, most=np.inf):
    """Return trials whose judge reads the values by name."""

    def values(changes):
        return {it.field: value for it, value in changes}

    return Trials(
        lambda changes: judge(values(changes)),
        lambda changes: all(least <= value <= most for value in values(changes).values()),
    )


@pytest.mark.parametrize("seed", range(40))
def test_the_change_is_enough_and_one_per_cent_less_is_not(seed):
    rng = np.random.default_rng(seed)
    flown, edge = rng.uniform(0.01, 50.0, 2)
    judge = trials(lambda it: it["x"] >= edge if edge > flown else it["x"] <= edge)
    (change,) = single_changes([number("x", float(flown))], judge)
    assert judge.taken(change)
    assert not judge.taken(less(change))
    assert len(repr(change[0][1])) <= 8, "no more digits than it takes"


def test_a_count_is_changed_by_whole_numbers():
    judge = trials(lambda it: it["n"] <= 17, least=1)
    (change,) = single_changes([number("n", 30)], judge)
    assert change[0][1] == 17
    assert less(change)[0][1] == 18


def test_the_smallest_in_proportion_comes_first():
    judge = trials(lambda it: it.get("x", 10.0) <= 9.0 or it.get("y", 1.0) >= 3.0)
    every = single_changes([number("y", 1.0), number("x", 10.0)], judge)
    assert [it[0][0].field for it in every] == ["x", "y"]


def test_values_that_the_mission_may_not_have_are_not_tried():
    judge = trials(lambda it: it["x"] >= 0.999, most=1.0)
    (change,) = single_changes([number("x", 0.2)], judge)
    assert 0.999 <= change[0][1] <= 1.0
    assert single_changes([number("x", 0.2)], trials(lambda it: it["x"] > 1.0, most=1.0)) == []


def test_of_two_that_are_needed_neither_can_be_smaller():
    judge = trials(
        lambda it: it.get("x", 1.0) <= 0.4 and it.get("y", 5.0) >= 7.3, least=0.0, most=10
    )
    numbers = number("x", 1.0), number("y", 5.0)
    assert single_changes(numbers, judge) == []
    (change,) = pair_changes([numbers], judge)
    assert judge.taken(change)
    assert not judge.taken(less(change, 0))
    assert not judge.taken(less(change, 1))


def test_a_time_is_only_shortened():
    judge = trials(lambda it: it["for"] != 1.0)
    (change,) = single_changes([number("for", 1.0, signs=(-1,))], judge)
    assert change[0][1] < 1.0
