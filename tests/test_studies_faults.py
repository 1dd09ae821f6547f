"""The study of faults: its rows, its judgement, its page, and a few of its runs."""

from __future__ import annotations

import numpy as np
import pytest

from missionkit.sim.fault_injection import FAULT_KINDS
from studies import fault_processes, faults
from studies.fault_flights import FENCE, Outcome, Seen, outside
from studies.fault_rows import FLIGHTS, ROWS, once
from studies.faults import good, page

NAMES = [row.name for row in ROWS]


def row(name):
    return ROWS[NAMES.index(name)]


def test_every_fault_is_there_once_and_declared():
    assert len(NAMES) == len(set(NAMES)) >= 27
    assert all(row.declared and row.what for row in ROWS)
    said = " ".join(row.what for row in FLIGHTS)
    new = ("gnss_toggling", "baro_stuck", "range_lost", "camera_flipped", "imu_biased")
    assert all(f"`{name}" in said and name in FAULT_KINDS for name in new)


def test_a_seed_draws_the_same_fault_again():
    drawn = [fault_of(seed) for seed in (1, 1, 2)]
    assert drawn[0] == drawn[1] != drawn[2]


def fault_of(seed):
    flight = row("GNSS off").once.args[0]
    return flight.faults(np.random.default_rng(seed))


def test_the_fence_is_judged_by_the_track():
    rows = np.zeros((3, 21))
    assert outside(rows, FENCE) == 0.0
    rows[1, 1:4] = (121.5, 0.0, -31.0)
    assert outside(rows, FENCE) == pytest.approx(1.5)


def test_the_page_lists_every_deviation_and_no_other():
    sag = row("battery sag")
    results = [
        (sag, Seen(1, Outcome.DONE, "as planned")),
        (sag, Seen(2, Outcome.HIT, "the trunk")),
        (sag, Seen(3, Outcome.DONE, "so it said", false_success=True)),
    ]
    assert [good(*each) for each in results] == [True, False, False]
    text = page(results, "the command")
    assert "As declared: 1 of 3" in text
    assert "Something was hit: 1. False reports of success: 1." in text
    assert "- battery sag, seed 2: hit something (the trunk)" in text
    assert "seed 3: work done, landed where it should, reported as a success (so it said)" in text
    assert "seed 1" not in text
    assert "$" not in text.replace("$command", "")


@pytest.mark.parametrize(
    "name", ["GNSS jump", "fence", "filter diverged", "plug-in raises", "bad file", "bad import"]
)
def test_one_seed_gives_the_declared_results(name):
    seen = once(name, 1)
    assert good(row(name), seen), seen


def test_a_refusal_is_a_sentence_and_no_traceback(tmp_path):
    mission = tmp_path / "none.yaml"
    with fault_processes.program(mission) as process:
        assert fault_processes.refusal(process).startswith("exit 2: ")


def test_an_unknown_fault_is_refused_with_the_nearest():
    with pytest.raises(SystemExit, match="GNSS of"):
        faults.chosen_rows(["GNSS of"])
