"""A converted chart under way, with the clock and the outside queue of an SCXML session."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from convert import SENT, Converted
from samples import calm

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.chart.semantics.chart_compiler import compile_mission
from missionkit.chart.semantics.compiled_chart import LEAVES
from missionkit.chart.semantics.step import begin, decide
from missionkit.plugin_containment import Containment

CATALOGUE = builtin()


class Session:
    """A chart that hears one event at a time; what it sends comes back when it is due."""

    def __init__(self, converted: Converted) -> None:
        mission = parse(json.dumps(converted.document), "converted.yaml", CATALOGUE)
        self.chart = compile_mission(mission, CATALOGUE)
        self.ids = {name: given for given, name in converted.ids.items()}
        self.contain = Containment()
        self.now = 0.0
        self.due: list[tuple[float, str]] = []
        self.memory = begin(self.chart, self.now)
        self.hear()
        self.wait(0.0)

    def hear(self, *events: str) -> None:
        """Let one tick pass."""
        seen = calm(now=self.now, status=None, events=events)
        self.memory, decision = decide(self.chart, self.memory, seen, self.contain)
        assert not self.contain.take()
        for fired in decision.fired:
            for said in fired.outputs:
                self._send(said)

    def wait(self, seconds: float) -> None:
        """Let time pass, and what was sent come in when it is due."""
        until = self.now + seconds
        while self.due and min(self.due)[0] <= until + 1e-9:
            first = min(self.due, key=lambda each: each[0])
            self.due.remove(first)
            self.now = max(self.now, first[0])
            self.hear(first[1])
        self.now = until

    def innermost(self) -> list[str]:
        """Return the ids of the innermost active states."""
        states = self.chart.states
        leaves = [name for name in self.memory.active if states[name].shape in LEAVES]
        return sorted(self.ids[name] for name in leaves)

    def _send(self, said: str) -> None:
        match said.split(" "):
            case ["log", verb, event, delay] if verb == SENT:
                self.due.append((self.now + float(delay), event))


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
