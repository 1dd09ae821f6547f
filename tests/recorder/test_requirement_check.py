"""One statement in flight, in the summary, in a campaign and on records: the same answers."""

from __future__ import annotations

import json

import pytest
from rehearsed import short, short_stage
from typer.testing import CliRunner

from missionkit.campaigns.requirement_statistics import requirement_statistics
from missionkit.campaigns.run_row import Row
from missionkit.chart.plugin_catalogue import builtin
from missionkit.chart.semantics.chart_compiler import compile_mission
from missionkit.cli.app import app
from missionkit.recorder.flight_recorder import FlightRecorder
from missionkit.recorder.requirement_check import check_record
from missionkit.rehearsal.rehearse import rehearse

HOP = """\
initial: idle
states:
  idle: {kind: idle, behavior: {use: take_off, height: 2}, transitions: [{to: land, when: done}]}
  land: {kind: land}
"""
REQUIREMENTS = """\
requirements:
  - {name: ends, existence: {in: land}, within: 60}
  - {name: full, always: {use: battery_below, floor: 0.5}}
  - {name: charged, never: {use: battery_below, floor: 0.5}}
  - {name: once, never: {enter: idle}, after: {enter: land}}
  - {name: climbs-first, precedence: {in: idle}, before: {enter: land}, within: 5}
  - {name: comes-down, response: {when: {enter: land}, then: {use: battery_below, floor: 0.1}}}
"""
FULFILLED = {
    **{"ends": True, "full": False, "charged": True, "once": True},
    **{"climbs-first": True, "comes-down": False},
}


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """The folder and the result of a flight with requirements."""
    folder, ready = tmp_path_factory.mktemp("run"), short_stage(HOP + REQUIREMENTS)
    with FlightRecorder(folder, camera=ready.plan.camera) as recorder:
        result = rehearse(ready, [lambda record, seen: recorder.write(record, seen.frame)])
    return folder, result


def checked(folder, text):
    return check_record(compile_mission(short(text), builtin()), folder / "flight.mcap")


def test_a_flight_ends_with_the_answers(flown):
    _, result = flown
    assert {it.name: it.fulfilled for it in result.requirements} == FULFILLED
    charged = next(it for it in result.requirements if it.name == "charged")
    assert 0.3 < charged.robustness < 0.5


def test_a_record_says_what_the_flight_said(flown):
    folder, result = flown
    found = checked(folder, HOP + REQUIREMENTS)
    assert {it.name: it.fulfilled for it in found.results} == FULFILLED
    assert (found.missing, found.ended) == ((), True)
    for mine, flight in zip(found.results, result.requirements, strict=True):
        assert mine.robustness == pytest.approx(flight.robustness, abs=0.01)


def test_a_requirement_may_be_made_after_the_flight(flown):
    folder, _ = flown
    later = """\
targets: {a: {position: [1, 0, 0]}}
requirements:
  - {name: climbs, precedence: {enter: idle}, before: {enter: land}}
  - {name: near, always: {use: within, of: a, radius: 5}}
"""
    found = checked(folder, HOP + later)
    assert [it.fulfilled for it in found.results] == [True, None]
    assert found.missing == ("within (of a, radius 5)",)


def test_a_flight_that_was_killed_may_still_fulfil_it(flown, tmp_path):
    folder, _ = flown
    (tmp_path / "flight.mcap").write_bytes((folder / "flight.mcap").read_bytes()[:20000])
    (tmp_path / "checkpoint.json").touch()
    found = checked(tmp_path, HOP + REQUIREMENTS)
    assert found.results[0].fulfilled is None
    assert not found.ended


def test_the_command_says_so(flown, tmp_path):
    folder, _ = flown
    mission = tmp_path / "hop.yaml"
    mission.write_text("missionkit: 1\nmission: short\ncamera: {use: none}\n" + HOP + REQUIREMENTS)
    said = CliRunner().invoke(app, ["check", str(mission), str(folder)])
    assert said.exit_code == 1
    lines = said.stdout.splitlines()
    assert lines[0] == "fulfilled: ends"
    assert lines[1].startswith("broken: full (robustness -0.5")
    said = CliRunner().invoke(app, ["check", str(mission), str(folder), "--json"])
    assert [it["fulfilled"] for it in json.loads(said.stdout)["requirements"]] == list(
        FULFILLED.values()
    )


def test_a_campaign_counts_them_and_names_the_worst_seed():
    def row(seed, **requirements):
        return Row(
            number=seed,
            variant=0,
            seed=seed,
            settings={},
            outcome="success",
            reason="",
            requirements=requirements,
        )

    rows = [row(n, near=(n != 7, 2.0 if n != 7 else -0.5), ends=(None, None)) for n in range(20)]
    near, ends = requirement_statistics([*rows, row(20)])
    assert (near.flights, near.fulfilled, near.broken) == (20, 19, 1)
    assert near.share.value == pytest.approx(0.95)
    assert near.share.low == pytest.approx(0.764, abs=0.001)  # Wilson, 19 of 20
    assert (near.worst, near.seed) == (-0.5, 7)
    assert near.low == pytest.approx(1.875)  # a twentieth of the way, between ranks 0 and 1
    assert (ends.fulfilled, ends.broken, ends.worst) == (0, 0, None)
