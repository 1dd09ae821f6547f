"""A converted chart under way, with the clock of an SCXML session."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from samples import calm

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.chart.semantics.chart_compiler import compile_mission
from missionkit.chart.semantics.compiled_chart import LEAVES
from missionkit.chart.semantics.quick_step import begin, decide
from missionkit.interchange.charts.scxml_chart import Converted
from missionkit.plugin_containment import Containment

CATALOGUE = builtin()


class Session:
    """A chart that hears one event at a time."""

    def __init__(self, converted: Converted) -> None:
        mission = parse(json.dumps(converted.document), "converted.yaml", CATALOGUE)
        self.chart = compile_mission(mission, CATALOGUE)
        self.ids = {name: given for given, name in converted.ids.items()}
        self.contain = Containment()
        self.now = 0.0
        self.memory = begin(self.chart, self.now)
        self.hear()
        self.wait(0.0)

    def hear(self, *events: str) -> None:
        """Let one tick pass."""
        seen = calm(now=self.now, status=None, events=events)
        self.memory, _ = decide(self.chart, self.memory, seen, self.contain)
        assert not self.contain.take()

    def wait(self, seconds: float) -> None:
        """Let time pass; the chart ticks when an event that it has delayed is due."""
        until = self.now + seconds
        while self.memory.delayed and self.memory.delayed[0].due <= until + 1e-9:
            self.now = max(self.now, self.memory.delayed[0].due)
            self.hear()
        self.now = until

    def innermost(self) -> list[str]:
        """Return the ids of the innermost active states."""
        states = self.chart.states
        leaves = [name for name in self.memory.active if states[name].shape in LEAVES]
        return sorted(self.ids[name] for name in leaves)


def followed(
    converted: Converted, script: Mapping[str, Any]
) -> tuple[list[list[str]], list[list[str]]]:
    """Return where a chart goes step by step, and where its script says."""
    session = Session(converted)
    went, wanted = [session.innermost()], [sorted(script["initialConfiguration"])]
    for step in script["events"]:
        session.wait(step.get("after", 0) / 1000)
        session.hear(step["event"]["name"])
        session.wait(0.0)
        went.append(session.innermost())
        wanted.append(sorted(step["nextConfiguration"]))
    return went, wanted
