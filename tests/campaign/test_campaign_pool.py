"""Campaigns on processes: the same rows whoever flies them, and whatever happens to a worker."""

from __future__ import annotations

import multiprocessing
import os
import signal

import pytest
from campaigns import bombed, cases, hop

from missionkit.campaigns.process_pool import flown
from missionkit.campaigns.run_row import Case, RunOrder
from missionkit.campaigns.single_run import fly


def by_number(rows):
    return sorted(rows, key=lambda it: it.number)


@pytest.fixture
def order(tmp_path):
    return RunOrder(hop(tmp_path), {})


def test_rows_are_the_same_in_this_process_and_in_any_number_of_workers(order):
    here = [fly(order, case) for case in cases(4)]
    assert by_number(flown(order, cases(4), workers=1)) == here
    assert by_number(flown(order, cases(4), workers=3)) == here
    assert {it.outcome for it in here} == {"success"}
    assert len({it.metrics["energy"] for it in here}) == 4


def test_cases_are_taken_when_a_worker_is_free(order):
    taken = []

    def some():
        for case in cases(50):
            taken.append(case.number)
            yield case

    rows = flown(order, some(), workers=2)
    next(rows)
    rows.close()
    assert len(taken) < 6
    assert multiprocessing.active_children() == []


def test_a_lost_worker_loses_no_runs(order):
    whole = [fly(order, case) for case in cases(6)]
    rows = flown(order, cases(6), workers=2)
    some = [next(rows)]
    os.kill(multiprocessing.active_children()[0].pid, signal.SIGKILL)
    assert by_number([*some, *rows]) == whole


def test_runs_that_hang_or_kill_their_worker_are_rows_with_their_reason(tmp_path):
    mission, plugin = bombed(tmp_path)
    harm = ["no", "die", "hang", "no"]
    todo = [Case(n, 0, n, {"how": how}) for n, how in enumerate(harm)]
    rows = by_number(flown(RunOrder(mission, {}, (plugin,)), todo, workers=2, timeout=2.5))
    assert [it.outcome for it in rows] == ["success", "lost", "hung", "success"]
    assert rows[1].reason == "the process that flew it died, exit code 7"
    assert rows[2].reason == "no result within 2.5 s"
    assert rows[1].settings == {"how": "die"}


def test_a_run_that_breaks_is_a_row_with_its_reason(tmp_path):
    (row,) = flown(RunOrder(str(tmp_path / "gone.yaml"), {}), cases(1), workers=1)
    assert row.outcome == "error"
    assert "gone.yaml" in row.reason
