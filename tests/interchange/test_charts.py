"""Charts of SCXML and XState become missions; what is code is refused, element by element."""

from __future__ import annotations

import json

import pytest
from samples import calm
from typer.testing import CliRunner

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.chart.semantics.chart_compiler import compile_mission
from missionkit.chart.semantics.quick_step import begin, decide
from missionkit.cli.app import app
from missionkit.plugin_containment import Containment

SCXML = """<?xml version="1.0"?>
<scxml xmlns="http://www.w3.org/2005/07/scxml" version="1.0" initial="idle">
  <!-- a comment -->
  <datamodel><data id="count" expr="0"/><data id="o" expr="{a: 1}"/></datamodel>
  <state id="idle"><transition event="start" target="work"/></state>
  <state id="work" initial="a">
    <onentry><log label="go"/><script>x()</script></onentry>
    <state id="a"><transition event="next" target="b" cond="count &lt; 3">
      <assign location="count" expr="count + 1"/></transition></state>
    <state id="b"><transition event="next" target="a" cond="foo(3)"><log label="x"/></transition>
      <transition event="back" target="a"/><transition event="gone" target="nowhere"/></state>
    <transition event="stop" target="end"/>
  </state>
  <final id="end"/>
</scxml>
"""
XSTATE = {
    "id": "light",
    "initial": "green",
    "context": {"cars": 0, "name": "A"},
    "on": {"OFF": ".dark"},
    "states": {
        "green": {"on": {"TIMER": "red"}, "entry": ["blink"]},
        "red": {
            "initial": "walk",
            "after": {"1500": "green", "slow": "green"},
            "on": {"TIMER": [{"target": "green", "guard": "isFree"}, "#light.dark"]},
            "invoke": {"src": "camera"},
            "states": {"walk": {"on": {"STEP": "stop"}}, "stop": {"type": "final"}},
            "onDone": "dark",
        },
        "dark": {"type": "final"},
    },
}


def run(tmp_path, data, name):
    path, out = tmp_path / name, tmp_path / "chart.yaml"
    path.write_text(data)
    result = CliRunner().invoke(app, ["import", str(path), "-o", str(out)])
    ledger = json.loads((tmp_path / "chart.yaml.ledger.json").read_text()) if out.exists() else {}
    return result, out, ledger


class Session:
    """A chart that hears one event at a time."""

    def __init__(self, out):
        catalogue = builtin()
        self.chart = compile_mission(parse(out.read_text(), "chart.yaml", catalogue), catalogue)
        self.memory, self.now = begin(self.chart, 0.0), 0.0
        self.hear()

    def hear(self, *events, wait=0.0):
        self.now += wait
        seen = calm(now=self.now, status=None, events=events)
        self.memory, _ = decide(self.chart, self.memory, seen, Containment())
        return self.memory.active[-1]


def test_scxml(tmp_path):
    result, out, ledger = run(tmp_path, SCXML, "file.scxml")
    assert result.exit_code == 0, result.output
    refused = [row["what"] for row in ledger["entries"] if row["outcome"] == "refused"]
    assert refused == [
        "<data o>",
        "<script>",
        "<transition next>",
        "<log>",
        "<transition gone>",
    ]
    assert (
        sum(ledger["counts"].values())
        == ledger["items"]
        == SCXML.count("<") - SCXML.count("</") - 3
    )
    session = Session(out)
    assert session.hear("start") == "a"
    for _ in range(3):
        assert session.hear("next") == "b"
        assert session.hear("back") == "a"
    assert session.hear("next") == "a"  # counted to three
    assert session.hear("stop") == "end"


def test_xstate(tmp_path):
    result, out, ledger = run(tmp_path, json.dumps(XSTATE), "file.json")
    assert result.exit_code == 0, result.output
    refused = [row["item"] for row in ledger["entries"] if row["outcome"] == "refused"]
    assert refused == ["context", "action", "invoke", "transition", "transition"]
    assert sum(ledger["counts"].values()) == ledger["items"] == 18
    session = Session(out)
    assert session.hear("TIMER") == "machine-red-walk"
    assert session.hear(wait=1.0) == "machine-red-walk"
    assert session.hear(wait=1.0) == "machine-green"
    session.hear("TIMER")
    session.hear("STEP")
    assert session.hear() == "machine-dark"
    other = Session(out)
    assert other.hear("OFF") == "machine-dark"


@pytest.mark.parametrize(
    ("data", "says"),
    [
        ('<scxml xmlns="http://www.w3.org/2005/07/scxml"/>', "no states"),
        (SCXML.replace('initial="idle"', 'initial="none"'), "it begins in 'none'"),
        ('{"states": {"a": 3}, "initial": "a"}', ""),
        ('{"states": {}}', ""),
    ],
)
def test_what_is_no_chart_is_one_sentence(tmp_path, data, says):
    result, _, _ = run(tmp_path, data, "file.any")
    assert "Traceback" not in result.output
    assert says in result.output
