import pytest

from missionkit.vehicle.authority import Authority, Holder, lost, ordered, reported, resumed


def heard(now, *modes):
    for mode in modes:
        now = reported(now, mode, armed=True)
    return now


def flying():
    """Armed and taken off by us, then setpoints."""
    now = reported(Authority(), "position", armed=False)
    now = heard(ordered(now, "hold"), "hold")
    now = heard(ordered(now, "take_off"), "hold", "take_off", "hold")
    return heard(ordered(now, "offboard"), "hold", "offboard", "offboard")


def test_a_whole_flight_takes_nothing_over():
    now = heard(ordered(flying(), "land"), "offboard", "land", "land", "hold")
    assert reported(now, "hold", armed=False).ours


@pytest.mark.parametrize("mode", ["position", "manual", "hold", "return", "altitude", "land"])
def test_leaving_offboard_without_being_asked_is_a_takeover(mode):
    assert heard(flying(), mode).holder is Holder.PILOT


def test_an_order_that_is_refused_or_lost_takes_nothing_over():
    now = heard(ordered(heard(ordered(flying(), "hold"), "hold"), "offboard"), "hold", "hold")
    assert now.ours


def test_the_climb_may_end_while_offboard_is_being_asked_for():
    now = heard(ordered(Authority(), "take_off"), "take_off")
    now = heard(ordered(now, "offboard"), "hold", "offboard")
    assert now.ours
    assert not heard(now, "hold").ours


def test_the_pilot_keeps_it_until_asked_even_back_in_offboard_or_on_the_ground():
    now = heard(flying(), "position", "offboard")
    assert not now.ours
    assert not reported(now, "hold", armed=False).ours
    assert resumed(now).ours
    assert heard(resumed(heard(now, "position")), "position").ours


def test_on_the_ground_any_mode_is_fine():
    now = Authority()
    for mode in ("manual", "position", "mission"):
        now = reported(now, mode, armed=False)
    assert now.ours


@pytest.mark.parametrize(("mode", "ours"), [("hold", True), ("offboard", True), ("manual", False)])
def test_a_vehicle_found_flying_is_a_pilots_unless_it_holds(mode, ours):
    assert reported(Authority(), mode, armed=True).ours is ours


def test_a_reboot_resumes_nothing():
    assert not heard(lost(flying()), "hold").ours
