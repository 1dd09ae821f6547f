"""sismic."""

from __future__ import annotations

from sismic.interpreter import Interpreter
from sismic.io import import_from_yaml

from benchmarks.peers.ring import Engine, Guards, Machine, Ring, Sky


def text(chart: Ring) -> str:
    """Write its YAML."""
    lines = ["statechart:", "  name: ring", "  root state:", "    name: root"]
    lines += [f"    initial: {chart.initial}", "    states:"]
    for name, ways in chart.states.items():
        lines += [f"      - name: {name}", "        transitions:"]
        lines += [f"          - {{guard: {ask.name}(), target: {to}}}" for to, ask in ways]
    return "\n".join(lines) + "\n"


def load(written: str, _: Sky, guards: Guards) -> Machine:
    """Read the YAML and enter the initial state."""
    machine = Interpreter(import_from_yaml(written), initial_context=dict(guards))
    machine.execute_once()
    return Machine(machine.execute_once, lambda: machine.configuration[-1])


HOW = "eventless transitions, `execute_once`, guards as functions in its context; load: from YAML"
ENGINES = (Engine("sismic", HOW, text, load, "sismic"),)
