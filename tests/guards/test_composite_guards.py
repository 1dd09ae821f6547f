"""Guards that read other guards and variables, in a chart that is stepped."""

from __future__ import annotations

import numpy as np
from documents import MINIMAL
from samples import calm

from missionkit.chart.load import load, parse
from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.plugin_catalogue import builtin
from missionkit.chart.semantics.chart_compiler import compile_mission
from missionkit.chart.semantics.quick_step import begin, decide
from missionkit.messages import Look, Target
from missionkit.plugin_containment import Containment
from missionkit.recorder import value_codec

GUARDED = """\
variables: {tries: 3}
perception: [{use: aruco, target: pole, dictionary: DICT_6X6_250, id: 7, size: 0.4}]
guards:
  gap: {use: within, of: pole, radius: 1.0}
  likely:
    use: markov_steady_state
    states: [far, near]
    matrix:
      - [rest, {variable: tries, over: 4}]
      - [{product: [{guard: gap, over: 20}, {quantity: confidence of pole, window: 4}]}, rest]
    of: near
    at_least: 0.5
"""
POLE = Target("pole", np.array([10.0, 0.0, -5.0]), 0.2, None, None, 9.0)
MISSION = (MINIMAL + GUARDED).replace("when: done", "when: likely")


def stepped(memory, chart, looks=()):
    seen = calm(looks=tuple(looks))
    return decide(chart, memory, seen._replace(targets={"pole": POLE}), Containment())


def test_variables_other_guards_and_windows_reach_the_chain():
    chart = compile_mission(parse(MISSION, "m.yaml", builtin()), builtin())
    hit, miss = Look(0.0, frozenset({"pole"})), Look(0.0, frozenset())
    _, decision = stepped(begin(chart, 0.0), chart, [hit, miss, hit, hit])
    p, q = 3 / 4, 10 / 20 * 3 / 4
    assert decision.answers["gap"].value == 10.0
    assert decision.answers["likely"].value == p / (p + q)
    assert decision.answers["likely"].why == "far to near 0.75, near to far 0.375"


def test_its_windows_go_on_from_a_checkpoint():
    chart = compile_mission(parse(MISSION, "m.yaml", builtin()), builtin())
    memory, _ = stepped(begin(chart, 0.0), chart, [Look(0.0, frozenset({"pole"}))] * 3)
    again = value_codec.read(value_codec.written(memory))
    miss = [Look(0.0, frozenset())]
    assert stepped(again, chart, miss)[1].answers == stepped(memory, chart, miss)[1].answers


def test_the_text_names_every_transition_and_its_target():
    guard = parse(MISSION, "m.yaml", builtin()).guards["likely"]
    assert ex.text(guard) == (
        "markov steady state (of near at least 0.5; far to far rest, near tries / 4; "
        "near to far value of gap / 20 * confidence of pole, near rest)"
    )


def test_names_of_an_included_file_get_its_prefix(tmp_path):
    part = """\
kind: logic
initial: look
variables: {tries: 3}
guards:
  gap: {use: within, of: pole, radius: 1.0}
  likely:
    use: markov_steady_state
    states: [far, near]
    matrix: [[rest, {variable: tries, over: 4}], [{guard: gap, over: 20}, rest]]
    of: near
    at_least: 0.5
states:
  look: {kind: hover, transitions: [{to: home, when: likely}, {to: home, after: 9}]}
"""
    (tmp_path / "part.yaml").write_text(part)
    whole = MINIMAL.replace("  watch:\n    kind: hover\n", "  watch:\n    include: part.yaml\n")
    (tmp_path / "m.yaml").write_text(whole)
    guards = load(tmp_path / "m.yaml", builtin()).guards
    named = {it.name for it in guards["watch/likely"].plugin.named_inputs()}
    assert named == {"watch/tries", "watch/gap"}
