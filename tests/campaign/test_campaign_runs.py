"""A row tells of the flight that `missionkit run` flies."""

from __future__ import annotations

import json
import shlex
from types import SimpleNamespace

import pytest
from campaigns import hop
from typer.testing import CliRunner

from missionkit.campaigns.analysis import command
from missionkit.campaigns.campaign_plan import Campaign
from missionkit.campaigns.run_row import Case, RunOrder
from missionkit.campaigns.single_run import fly
from missionkit.campaigns.visit_log import VisitLog, parts, way
from missionkit.cli.app import app


def test_the_command_of_a_row_flies_it_again(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mission, faults = hop(tmp_path), ("gnss_drift=0.3@2",)
    row = fly(RunOrder(mission, {}, (), faults), Case(4, 1, 9, {"height": "3"}))
    campaign = Campaign(mission=mission, name="hop", runs=9, faults=faults, digest="")
    words = shlex.split(command(campaign, row))
    result = CliRunner().invoke(app, [*words[1:], "--headless"])
    assert result.exit_code == 0
    summary = json.loads((tmp_path / "runs/hop-seed9/summary.json").read_text())
    assert summary["grade"]["distance"] == row.metrics["distance"]
    assert summary["grade"]["energy"] == row.metrics["energy"]
    assert (summary["outcome"], summary["reason"]) == (row.outcome, row.reason)
    assert summary["parameters"] == row.parameters
    changes = [f"{it['source']} -> {it['to']}" for it in summary["transitions"]]
    assert changes == list(row.transitions)
    assert [it["state"] for it in summary["states"]] == [state for state, _ in row.visits]


def test_times_add_up(tmp_path):
    row = fly(RunOrder(hop(tmp_path), {}), Case(0, 0, 0, {}))
    assert row.times == pytest.approx(dict(row.visits))
    assert sum(row.times.values()) == pytest.approx(row.metrics["duration"])


def test_a_record_is_kept_on_request(tmp_path):
    order = RunOrder(hop(tmp_path), {}, records=str(tmp_path / "records"))
    for _ in range(2):  # a campaign that was killed flies it again
        assert fly(order, Case(7, 0, 0, {})).succeeded
    assert (tmp_path / "records/7/flight.mcap").stat().st_size > 10_000


def test_a_crash_is_reported_with_its_reason(tmp_path):
    row = fly(RunOrder(hop(tmp_path), {}, (), ("battery_sag=1@4",)), Case(0, 0, 0, {}))
    assert (row.outcome, row.reason) == ("crash", "hit an obstacle or the ground")


def seen(state, *fired, active=()):
    ways = [SimpleNamespace(source=a, to=b, reason=f"{b}!") for a, b in fired]
    return SimpleNamespace(state=state, active=active or (state,), fired=ways, problems=("odd",))


def test_a_visit_log_has_visits_times_and_transitions():
    diary = VisitLog(0.5)
    for record in [
        seen("a"),
        seen("a"),
        seen("a", ("a", "a")),  # again: another visit
        seen("b", ("a", "c"), ("c", "b"), active=("out", "b")),
        seen("b", active=("out", "b")),
    ]:
        diary(record, None)
    assert diary.visits == (("a", 1.0), ("a", 0.5), ("b", 1.0))
    assert diary.times == {"a": 1.5, "b": 1.0, "out": 1.0}
    assert diary.transitions == {"a -> a": 1, "a -> c": 1, "c -> b": 1}
    assert diary.ways == {"a -> a: a!": 1, "a -> c: c!": 1, "c -> b: b!": 1}
    assert diary.entries == {"a": 2, "c": 1, "b": 1, "out": 1}  # c: within a tick
    assert diary.problems == ("odd",)


def test_a_diary_counts_entries_of_states_around_and_in_regions():
    inside, diary = ("out", "x", "y"), VisitLog(0.5)
    for record in [
        seen("x", active=inside),
        seen("x", ("y", "y"), active=inside),  # acts only, in another region
        seen("x", ("x", "out"), active=inside),  # leaves it and enters it again
        seen("z", ("out", "u, v"), ("u", "z"), active=("z",)),
        seen("x", ("z", "room"), ("door", "x, y"), active=inside),  # the room begins at its door
        seen("x", active=inside),
    ]:
        diary(record, None)
    assert diary.entries == {"out": 3, "x": 2, "y": 2, "u": 1, "v": 1, "z": 1, "room": 1, "door": 1}


def test_the_reason_of_a_transition_may_be_anything():
    for name in (("a", "b", "when x -> y: 3"), ("a", "b, c", "after 3 s"), ("a", "a", "")):
        assert parts(way(*name)) == name
