import pytest

from missionkit.vehicle.telemetry.batteries import (
    all_of,
    battery,
    counted,
    pack_of,
)

UNKNOWN, ALL, PROPULSION, AVIONICS, PAYLOAD = range(5)
CELLS = [4100, 4100, 4090, 4110, *(65535,) * 6]


def said(ident, remaining, function=ALL, **more):
    return {
        "id": ident, "battery_function": function, "battery_remaining": remaining,
        "voltages": CELLS, "voltages_ext": [0, 0, 0, 0], **more,
    }  # fmt: skip


def packs(*fields, times=3):
    """Each pack says the same some times, a second apart."""
    return all_of((each, float(n)) for n in range(times) for each in fields)


def charge(*fields, times=3):
    return battery(packs(*fields, times=times)).charge


def test_one_pack_is_read():
    read = battery(packs(said(0, 87)))
    assert (read.at, read.charge, read.voltage) == (2.0, 0.87, pytest.approx(16.4))


def test_it_is_unknown_rather_than_empty():
    assert battery(packs(said(0, -1))) is None
    assert battery({}) is None


def test_cells_beyond_the_tenth_count_too():
    assert pack_of(said(0, 50, voltages_ext=[4100, 4100, 0, 0]), 0.0).voltage > 24.0


@pytest.mark.parametrize("function", [ALL, PROPULSION])
def test_a_payload_pack_neither_hides_an_empty_pack_nor_lands_the_flight(function):
    assert charge(said(0, 8, function), said(1, 95, PAYLOAD)) == 0.08
    assert charge(said(0, 80, function), said(1, 5, PAYLOAD), said(2, 4, AVIONICS)) == 0.8
    assert battery(packs(said(1, 5, PAYLOAD))) is None


def test_of_several_that_carry_it_the_emptiest_counts():
    assert charge(said(0, 80), said(1, 30, PROPULSION)) == 0.3


def test_one_that_carries_it_and_does_not_know_its_charge_does_not_hide_the_other():
    assert charge(said(0, -1), said(1, 30)) == 0.3


def test_where_none_says_what_it_is_for_the_first_counts():
    assert charge(said(1, 95, UNKNOWN), said(0, 8, UNKNOWN)) == 0.08
    assert charge(said(0, 80, UNKNOWN), said(1, 8, UNKNOWN)) == 0.8
    assert charge(said(0, 80, UNKNOWN), said(1, 30, PROPULSION)) == 0.3


def test_a_pack_of_another_component_is_another_one():
    own = said(0, 80)
    assert charge(own, said(0, 5, PAYLOAD, component=180)) == 0.8
    assert charge(own, said(0, 30, ALL, component=180)) == 0.3


def test_a_pack_reported_once_is_ignored_beside_one_reported_often():
    known = all_of([*((said(0, 80), float(n)) for n in range(20)), (said(7, 1), 20.0)])
    assert battery(known).charge == 0.8


def test_the_charge_is_as_old_as_its_oldest_reading():
    both = [(said(ident, 80 - ident), float(n)) for n in range(3) for ident in (0, 1)]
    silent = all_of([*both, *((said(1, 70), 3.0 + n) for n in range(10))])
    assert battery(silent).at == 2.0


def test_packs_are_named_for_people():
    (pack,) = counted(packs(said(0, 8)))
    assert pack.says == "battery 0 for everything, 8%"
    (other,) = packs(said(2, -1, PAYLOAD, component=180)).values()
    assert other.says == "battery 2 of component 180 for payload, charge not known"
