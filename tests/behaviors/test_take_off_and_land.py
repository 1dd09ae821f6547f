"""Leaving the ground, holding, and coming back to it."""

from __future__ import annotations

import numpy as np
import pytest
from playing import at, play, status
from pydantic import ValidationError
from samples import calm

from missionkit.behaviors.hold import Hold
from missionkit.behaviors.land import Land
from missionkit.behaviors.take_off import TakeOff
from missionkit.geometry import vec
from missionkit.messages import Action, VehicleStatus

GROUND = {"armed": False, "in_air": False, "mode": "hold"}
UNALIGNED = calm().health._replace(aligned=False)
NOWHERE = calm().health._replace(placed=False)
DIVERGED = calm().health._replace(diverged=True)


def ground(height: float = 0.0, **changes):
    return at(10.0, 0.0, 0.0, -height, **changes)


def test_take_off_waits_arms_climbs_and_is_done():
    story = [
        ground(status=status(**GROUND), health=UNALIGNED),
        ground(status=None),
        ground(status=status(**GROUND, ready=False)),
        ground(status=status(**GROUND)),
        ground(status=status(**GROUND)),
        ground(status=status(in_air=False, mode="hold")),
        ground(0.4, status=status(mode="take_off")),
        ground(4.4, status=status(mode="take_off")),
        ground(4.5, status=status(mode="take_off")),
    ]
    steps = play(TakeOff(height=5.0), story)
    assert [(step.action, step.done, step.note) for step in steps] == [
        (None, False, "waiting for the estimate to align"),
        (None, False, "waiting for the vehicle's arming checks"),
        (None, False, "waiting for the vehicle's arming checks"),
        (Action.ARM, False, "arming"),
        (Action.ARM, False, "arming"),
        (Action.TAKE_OFF, False, "climbing, 0.0 m"),
        (None, False, "climbing, 0.4 m"),
        (None, False, "climbing, 4.4 m"),
        (None, True, ""),
    ]
    assert steps[5].height == 5.0
    assert all(step.guidance is None for step in steps)


@pytest.mark.parametrize("armed", [False, True])
def test_nothing_takes_off_without_a_position(armed):
    said = status(**GROUND | {"armed": armed})
    (step,) = play(TakeOff(), [ground(status=said, health=NOWHERE)])
    assert (step.action, step.done) == (None, False)
    assert "waiting for a position fix" in step.note


def test_nothing_takes_off_by_an_estimate_that_has_diverged():
    (step,) = play(TakeOff(), [ground(status=status(**GROUND), health=DIVERGED)])
    assert (step.action, step.done) == (None, False)
    assert "diverged" in step.note


def test_launched_by_hand_nothing_is_commanded_until_the_pilot_gives_control():
    story = [
        ground(status=status(**GROUND), health=UNALIGNED),
        ground(status=status(**GROUND)),
        ground(status=status(in_air=False, mode="position"), events=("control_resumed",)),
        ground(2.0, status=status(mode="position")),
        ground(2.0, status=status(mode="position"), events=("control_resumed",)),
    ]
    steps = play(TakeOff(height=2.0, by="pilot"), story)
    assert [(step.action, step.done, step.note) for step in steps] == [
        (None, False, "waiting for the estimate to align"),
        (None, False, "waiting for the pilot to take off"),
        (None, False, "waiting for the pilot to take off"),
        (None, False, "a pilot is flying, 2.0 m up: waiting for control"),
        (None, True, ""),
    ]


def test_take_off_is_done_when_the_autopilot_thinks_it_is_high_enough():
    """Its own idea of the height may differ by more than the tolerance."""
    climbing, above = status(mode="take_off"), status(mode="hold")
    heights = [(0.5, climbing), (4.2, climbing), (4.2, above)]
    steps = play(TakeOff(height=5.0), [ground(high, status=said) for high, said in heights])
    assert [step.done for step in steps] == [False, False, True]


CLIMBING, STEERED = status(mode="take_off"), status(mode="offboard")


@pytest.mark.parametrize("mode", ["hold", "brake", "position"])
def test_a_climb_that_is_cut_short_is_not_done_and_is_finished_by_guidance(mode):
    """A pilot holds, or the autopilot ends its climb by itself: neither is high enough."""
    cut = status(mode=mode)
    story = [(0.5, CLIMBING), (1.6, cut), (1.6, cut), (1.6, STEERED), (4.9, STEERED)]
    steps = play(TakeOff(height=6.0), [ground(high, status=said) for high, said in story])
    assert [step.done for step in steps] == [False] * 5
    assert all(step.action is None for step in steps)
    assert [step.takes_over for step in steps] == [False, True, True, True, True]
    assert [step.guidance.position.tolist() for step in steps[1:]] == [[0.0, 0.0, -6.0]] * 4
    (last,) = play(TakeOff(height=6.0), [ground(5.6, status=STEERED)])
    assert last.done


def test_a_climb_is_finished_straight_up_from_where_the_pilot_has_flown_to():
    story = [ground(1.0, status=CLIMBING)]
    story += [at(10.0, north, 0.0, -1.6, status=status(mode="position")) for north in (0.0, 3.0)]
    story += [at(10.0, north, 0.0, -1.6, status=STEERED) for north in (3.0, 3.4)]
    north = [step.guidance.position[0] for step in play(TakeOff(height=6.0), story)[1:]]
    assert north == [0.0, 3.0, 3.0, 3.0]


def test_control_returned_low_in_the_air_does_not_cause_a_new_take_off():
    back = ground(1.6, status=status(mode="position"), events=("control_resumed",))
    (step,) = play(TakeOff(height=6.0), [back])
    assert (step.done, step.action, step.takes_over) == (False, None, True)


@pytest.mark.parametrize("mode", ["take_off", "hold"])
def test_a_climb_that_stalls_in_the_air_is_finished_by_guidance(mode):
    said = status(mode=mode)
    story = [at(10.0 + n, 0.0, 0.0, -1.6, status=said) for n in range(11)]
    steps = play(TakeOff(height=6.0), story)
    assert [step.takes_over for step in steps] == [False] * 9 + [True] * 2


def test_a_climb_is_not_finished_by_an_estimate_that_has_diverged():
    story = [ground(1.0, status=CLIMBING), ground(1.6, status=status(), health=DIVERGED)]
    step = play(TakeOff(height=6.0), story)[-1]
    assert (step.guidance, step.action, step.done) == (None, None, False)
    assert "diverged" in step.note


def test_an_unheard_take_off_is_requested_again():
    steps = play(TakeOff(height=5.0), [ground(0.2, status=status(mode="hold"))] * 3)
    assert [(step.action, step.done) for step in steps] == [(Action.TAKE_OFF, False)] * 3


@pytest.mark.parametrize("height", [0.0, -1.0, float("nan")])
def test_a_take_off_without_a_valid_height_is_refused(height):
    with pytest.raises(ValidationError):
        TakeOff(height=height)


def test_land_is_requested_until_the_vehicle_is_disarmed():
    story = [
        ground(3.0, status=status()),
        ground(0.0, status=status(in_air=False, mode="land")),
        ground(0.0, status=None),
        ground(0.0, status=status(**GROUND)),
    ]
    steps = play(Land(), story)
    assert [(step.action, step.done) for step in steps] == [
        *[(Action.LAND, False)] * 3,
        (None, True),
    ]


def test_hold_stays_where_it_began():
    story = [at(10.0 + n, 1.0 + n, 2.0, -5.0) for n in range(3)]
    for step in play(Hold(), story):
        np.testing.assert_array_equal(step.guidance.position, vec(1.0, 2.0, -5.0))
        assert not step.done


def test_hold_does_nothing_on_the_ground_and_keeps_its_place():
    story = [ground(status=said) for said in (status(in_air=False), None, status())]
    steps = play(Hold(), story)
    assert [step.guidance is None for step in steps] == [True, True, False]
    assert {step.action for step in steps} == {None}


FAST = {"velocity": np.array([4.0, 3.0, 0.5])}


def flying(mode="offboard", **changes):
    status = VehicleStatus(10.0, armed=True, in_air=True, ready=True, mode=mode)
    return calm(status=status, **changes)


def test_a_vehicle_that_moves_comes_to_rest_before_it_lands():
    fast, slow = flying(**FAST), flying(velocity=np.array([0.4, 0.5, 1.5]))
    steps = play(Land(), [fast, fast, slow])
    assert [step.stop for step in steps] == [True, True, False]
    assert [step.action for step in steps] == [None, None, Action.LAND]


def test_braking_before_a_landing_takes_no_longer_than_it_may():
    steps = play(Land(brake=1.0), [flying(now=10.0 + 0.5 * n, **FAST) for n in range(4)])
    assert [step.stop for step in steps] == [True, True, False, False]


def test_with_a_diverged_estimate_it_brakes_for_a_while_however_fast_it_seems():
    lost = calm().health._replace(diverged=True)
    steps = play(Land(), [flying(now=10.0 + n, health=lost) for n in range(4)])
    assert [step.stop for step in steps] == [True, True, False, False]


@pytest.mark.parametrize("mode", ["hold", "take_off", "land", "return"])
def test_an_autopilot_flying_by_itself_is_ordered_to_land_at_once(mode):
    (step,) = play(Land(), [flying(mode, **FAST)])
    assert step.action is Action.LAND


WALL = np.array([[1.2, y, -2.0] for y in np.linspace(-2.0, 2.0, 9)])


def beside_a_wall(now, position_sd=5.0, **changes):
    health = calm().health._replace(position_sd=position_sd)
    return flying(now=now, health=health, position=vec(0.0, 0.0, -2.0), **changes)


def test_without_a_position_it_makes_room_before_it_lands_where_it_may_drift():
    story = [beside_a_wall(10.0, obstacles=WALL), beside_a_wall(11.0, obstacles=WALL + 1.0)]
    first, then = play(Land(), story)
    assert (first.stop, first.action) == (True, None)
    np.testing.assert_allclose(first.retreat, vec(-1.0, 0.0, 0.0), atol=1e-12)
    assert (then.retreat, then.action) == (None, Action.LAND)


@pytest.mark.parametrize(
    "seen",
    [
        beside_a_wall(10.0, position_sd=0.5, obstacles=WALL + 0.1),
        beside_a_wall(10.0),
        beside_a_wall(10.0, mode="land", obstacles=WALL),
    ],
    ids=["known", "nothing seen", "lands already"],
)
def test_otherwise_it_lands_right_here(seen):
    (step,) = play(Land(), [seen])
    assert step.action is Action.LAND


def test_with_a_position_it_makes_room_only_from_what_stands_close_by():
    near = WALL - np.array([0.6, 0.0, 0.0])
    (step,) = play(Land(), [beside_a_wall(10.0, position_sd=0.5, obstacles=near)])
    assert step.retreat[0] == pytest.approx(-0.8)
    (step,) = play(Land(room=0.0), [beside_a_wall(10.0, obstacles=near)])
    assert step.action is Action.LAND


def test_it_makes_room_for_a_while_only():
    steps = play(Land(), [beside_a_wall(10.0 + 4.0 * n, obstacles=WALL) for n in range(5)])
    assert [step.retreat is not None for step in steps] == [True] * 4 + [False]
