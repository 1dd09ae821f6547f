"""The chart of contingencies: out of the operational volume it flies home, out of both it lands."""

from __future__ import annotations

from rehearsed import HEAD, MISSIONS, Flight, flown

from missionkit.chart.checks import findings
from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.errors import Level
from missionkit.rehearsal.stage import stage
from missionkit.sim.world import World

STRAYING = """\
targets: {far: {position: [60, 0, -4]}}
failsafes:
  - {name: control, when: {not: contingency/in-contingency}, to: contingency/lost}
  - {name: battery, when: {use: battery_below, floor: 0.25}, to: contingency/lost}
  - {name: link, when: {use: link_lost, longer_than: 3}, to: contingency/lost}
  - {name: lost, when: estimate_bad, for: 1.0, to: contingency/lost}
requirements:
  - {name: operation, always: contingency/in-operation, broken: {to: contingency}}
initial: up
states:
  up: {kind: idle, behavior: {use: take_off, height: 4}, transitions: [{to: out, when: done}]}
  out:
    kind: gps
    behavior: {use: go_to, target: far}
    transitions: [{to: contingency, when: done}, {to: contingency, after: 120}]
  contingency:
    include: charts/contingency.yaml
    with: {north: [-10, 15], east: [-10, 10], outer_north: OUTER, outer_east: [-20, 20]}
"""


def strayed(outer: str) -> Flight:
    catalogue = builtin()
    text = HEAD + STRAYING.replace("OUTER", outer)
    mission = parse(text, str(MISSIONS / "straying.yaml"), catalogue)
    errors = [it for it in findings(mission, catalogue) if it.level is Level.ERROR]
    assert [it.code for it in errors] in ([], ["outside-fence"])
    return flown(stage(mission, catalogue, World(world="field"), 1))


def test_out_of_the_operational_volume_it_flies_home():
    flight = strayed("[-30, 40]")
    assert flight.went()[1:] == [
        ("contingency", "requirement operation broken for 0 s"),
        ("contingency/lost", "when done"),
    ]
    (operation,) = flight.result.requirements
    assert operation.fulfilled is False
    assert -15.0 < operation.robustness < 0.0
    assert max(float(it.estimate.position[0]) for it in flight.records) < 30.0


def test_out_of_both_it_lands_at_once():
    flight = strayed("[-12, 15.5]")
    assert flight.went()[-1] == ("contingency/lost", "failsafe control")
    landed = flight.records[-1].estimate.position
    assert 15.0 < float(landed[0]) < 30.0
