"""Nothing is armed while a failsafe holds already, and the reason is reported."""

from dataclasses import replace

import pytest
from samples import calm
from typer.testing import CliRunner

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.chart.semantics.arming_check import against_arming
from missionkit.chart.semantics.compiled_chart import CompiledTransition
from missionkit.cli.app import app
from missionkit.engine.flight_end import ARMING_TIMEOUT, FlightEnd
from missionkit.engine.prepared_mission import begin, prepare
from missionkit.messages import Verdict
from missionkit.plugin_containment import Containment
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import stage
from missionkit.sim.fault_injection import parse_fault
from missionkit.sim.world import World

HOP = """
missionkit: 1
mission: hop
camera: {use: none}
initial: idle
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: 3}
    transitions: [{to: up, when: done}]
  up: {kind: custom, behavior: hold, transitions: [{to: land, after: 1}]}
  land: {kind: land}
failsafes:
  - {name: battery, when: {use: battery_below, floor: 0.2}, for: 2, to: land}
"""


def flown(*faults, anyway=False, text=HOP):
    catalogue = builtin()
    mission = parse(text, "hop", catalogue)
    ready = stage(mission, catalogue, World(world="empty"), 1, list(map(parse_fault, faults)))
    ready = ready._replace(plan=ready.plan._replace(arm_anyway=anyway))
    records = []
    result = rehearse(ready, (lambda record, _: records.append(record),))
    armed = any(it.estimate.status is not None and it.estimate.status.armed for it in records)
    return result, records, armed


def test_an_empty_battery_is_not_taken_off_with():
    result, records, armed = flown("battery_sag=0.82@0")
    assert result.flown.end is FlightEnd.NOT_ARMED
    assert not armed
    assert "failsafe battery holds: battery below (floor 0.2), now 0.18" in result.flown.says
    assert "--anyway" in result.flown.says
    assert any(
        record.step_note.startswith("not taking off: failsafe battery") for record in records
    )
    assert ARMING_TIMEOUT < result.flown.duration < ARMING_TIMEOUT + 10.0


def test_anyway_takes_off_all_the_same():
    result, _, armed = flown("battery_sag=0.82@0", anyway=True)
    assert armed
    assert result.flown.end is FlightEnd.LANDED


@pytest.mark.parametrize(
    ("verdict", "hold", "unknown_takes", "against"),
    [
        (Verdict(holds=True, why="empty"), 0.0, True, "failsafe battery holds: empty"),
        (Verdict(holds=True, why="empty"), 9.0, False, "failsafe battery holds: empty"),
        (Verdict(holds=False), 0.0, True, ""),
        (Verdict.unknown("no reading"), 0.0, True, "failsafe battery is unknown: no reading"),
        (Verdict.unknown("no reading"), 0.0, False, ""),
        (Verdict.unknown("no reading"), 1.0, True, ""),
    ],
)
def test_an_unknown_failsafe_counts_if_it_would_act_at_once(verdict, hold, unknown_takes, against):
    plan = prepare(parse(HOP, "hop", builtin()), builtin())
    memory = begin(plan)
    failsafe = CompiledTransition(
        1,
        ("land",),
        "failsafe battery",
        ask=lambda _: verdict,
        hold=hold,
        unknown_takes=unknown_takes,
    )
    chart = replace(plan.chart, failsafes=(failsafe,))
    seen = calm()
    assert against_arming(chart, memory.chart, seen, Containment()) == against


def test_what_counts_from_the_entry_of_a_state_does_not_speak_against_it():
    text = HOP.replace("{use: battery_below, floor: 0.2}", "{use: target_lost, target: tree}")
    text = text.replace("initial:", "targets: {tree: {position: [5, 0, -3]}}\ninitial:", 1)
    assert flown(text=text)[2]


def test_inputs_waited_for_in_vain_are_reported():
    result, _, armed = flown("battery_sag=0.95@0")
    assert not armed
    assert (
        result.flown.says == "the vehicle never took off: waiting for the vehicle's arming checks"
    )


@pytest.mark.parametrize(("more", "code"), [([], 1), (["--anyway"], 0)])
def test_the_command_says_why_and_how_to_mean_it(more, code, tmp_path):
    hop = HOP.replace("land, after: 1", "land, after: 0.2") + "success: {visit: land}\n"
    (tmp_path / "hop.yaml").write_text(hop)
    words = ["run", str(tmp_path / "hop.yaml"), "--headless", "--out", str(tmp_path / "runs")]
    done = CliRunner().invoke(app, [*words, "--fault", "battery_sag=0.82@0", *more])
    assert done.exit_code == code, done.output
    assert ("the vehicle was not armed: failsafe battery holds" in done.stdout) is (code == 1)
