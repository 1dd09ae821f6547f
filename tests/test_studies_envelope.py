"""The study of the envelope: what is flown, how it is kept, and its page."""

from __future__ import annotations

import math

from missionkit.sim.fault_injection import parse_fault
from studies import envelope
from studies.envelope_flight import Run, Trouble
from studies.envelope_orders import STRONGEST, groups
from studies.envelope_page import page

SAFE = Run(Trouble(1, 5.0), True, True, False, True, 0.4, 93.0, 0.04, "")
HURT = Run(
    Trouble(2, 7.5, (3.0, -4.0), 1.5, ("gnss_lost@gps:3.0+2.0",)),
    *(False, False, True, True, -0.01, 60.0, None, "in gps at 14.0 s, [43.9, 7.2, -2.5]"),
)


def test_every_flight_has_its_own_trouble_and_can_be_flown():
    wanted = groups(seeds=4, random=200, first=50)
    assert [len(group) for group in wanted.values()] == [4] * 7 + [200]
    assert {order.cruise for order in wanted["cruise 8 m/s"]} == {8.0}
    found = wanted["random search"]
    assert len(set(found)) == 200
    for order in found:
        faults = list(map(parse_fault, order.faults))
        gusts = [fault.value for fault in faults if fault.name == "wind_gust"]
        assert math.hypot(*order.wind) + max(gusts, default=0.0) <= STRONGEST + 0.02
        assert 3.0 <= order.cruise <= 8.0
        assert faults


def test_the_same_seed_means_the_same_trouble():
    assert groups(2, 20, 7) == groups(2, 20, 7)
    assert groups(2, 20, 7)["random search"][1:] == groups(2, 19, 8)["random search"]


def test_runs_already_flown_are_kept_and_not_repeated(tmp_path):
    kept = tmp_path / "flights"
    kept.write_text(f"{SAFE.written()}\n{HURT.written()}\n")
    runs = envelope.gathered([SAFE.order, HURT.order], kept, workers=1)
    assert runs == {SAFE.order: SAFE, HURT.order: HURT}


def test_the_page_names_every_crash_with_what_it_takes_to_fly_it_again():
    text = page({"calm": [SAFE, SAFE], "random search": [SAFE, HURT]}, "the command")
    (row,) = [line for line in text.splitlines() if line.startswith("| random search")]
    cells = [cell.strip() for cell in row.split("|")]
    assert cells[2:4] == ["2", "1"]
    assert cells[5:8] == ["1", "1", "-0.01"]
    assert (
        "- random search: seed 2, cruise 7.5, wind [3, -4, 0] gust 1.5, gnss_lost@gps:3.0+2.0: "
        "in gps at 14.0 s, [43.9, 7.2, -2.5]"
    ) in text
    assert "None." in page({"calm": [SAFE]}, "the command")
