"""The operator's way home, and what a flight knows of the pilot at the page."""

import pytest
from samples import calm

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.engine.flight_loop import Operator
from missionkit.engine.prepared_mission import prepare
from missionkit.guards.operator_silence import OperatorSilent
from missionkit.messages import PAUSE, OperatorAction, OperatorReport
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import stage, world_of

TOUR = """\
missionkit: 1
mission: tour
camera: {use: none}
dwell: 0.1
targets: {pole: {position: [6, 0, -2]}}
initial: idle
failsafes:
  - {name: alone, when: {use: operator_silent, longer_than: 3}, unknown: ignore, to: land}
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: 2}
    transitions: [{to: out, when: done}]
  out:
    kind: gps
    behavior: {use: go_to, target: pole}
    transitions: [{to: home, when: done}, {to: home, after: 60}]
  home:
    kind: return
    behavior: {use: go_to, target: home, height: 2}
    transitions: [{to: land, when: done}]
  land: {kind: land}
"""
ACTION = OperatorAction("return", "", "pilot 1", "127.0.0.1")


def flown(tmp_path, operator, *, then):
    """Fly the tour; `then` is called at every tick with its record and the operator."""
    catalogue = builtin()
    mission = parse(TOUR, "tour.yaml", catalogue)
    records = []

    def watch(record, observation):
        records.append((record, observation))
        then(record, operator)

    ready = stage(mission, catalogue, world_of(mission, tmp_path), 0)
    rehearse(ready, (watch,), operator=operator)
    return [
        (fired.source, fired.to, fired.reason) for record, _ in records for fired in record.fired
    ], records


def test_return_leads_home_from_a_pause_too(tmp_path):
    def then(record, operator):
        if (
            record.state == "out"
            and not then.sent
            and record.now - record.estimate.entered_at > 0.5
        ):
            then.sent = True
            operator.send(PAUSE)
        if record.paused:
            operator.home()

    then.sent = False
    went, records = flown(tmp_path, Operator(), then=then)
    assert ("out", "home", "operator: return") in went
    assert [to for _, to, _ in went] == ["out", "home", "land"]
    assert any(record.paused for record, _ in records)
    assert not records[-1][0].paused


def test_on_the_ground_and_on_the_way_home_it_does_nothing(tmp_path):
    def then(record, operator):
        status = record.estimate.status
        if record.state in {"home", "land"} or status is None or not status.armed:
            operator.home()

    went, _ = flown(tmp_path, Operator(), then=then)
    assert [reason for _, _, reason in went] == ["when done"] * 3


def test_a_silent_pilot_takes_the_failsafe_and_actions_are_in_the_record(tmp_path):
    operator = Operator()
    said = iter([OperatorReport(None), OperatorReport(0.5, (ACTION,))])
    operator.present = lambda: next(said, OperatorReport(operator_silence(), ()))
    clock = {"now": 0.0}

    def operator_silence():
        return clock["now"] - 4.0 if clock["now"] > 4.0 else 0.0

    def then(record, _):
        clock["now"] = record.now

    went, records = flown(tmp_path, operator, then=then)
    assert ("failsafe alone") in [reason for _, _, reason in went]
    assert [action for record, _ in records for action in record.actions] == [ACTION]
    assert records[1][1].operator.actions == (ACTION,)


@pytest.mark.parametrize(("silence", "holds"), [(None, None), (9.0, False), (11.0, True)])
def test_the_guard_compares_the_silence(silence, holds):
    assert OperatorSilent().check(calm(operator_silence=silence)).holds is holds


def test_a_chart_without_a_way_home_has_none():
    catalogue = builtin()
    without = TOUR.replace("kind: return", "kind: gps")
    assert prepare(parse(TOUR, "tour.yaml", catalogue), catalogue).chart.home == "home"
    assert prepare(parse(without, "tour.yaml", catalogue), catalogue).chart.home == ""
