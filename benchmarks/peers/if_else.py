"""A chart written out by hand."""

from __future__ import annotations

from typing import Any

from benchmarks.peers.ring import Engine, Guards, Machine, Ring, Sky, source


def text(chart: Ring) -> str:
    """Write a module with one function."""
    numbers = {name: number for number, name in enumerate(chart.states)}
    lines = [f"state = {numbers[chart.initial]}", "def tick():", "    global state"]
    for name, ways in chart.states.items():
        lines.append(f"    if state == {numbers[name]}:")
        for number, (to, ask) in enumerate(ways):
            lines.append(f"        {'elif' if number else 'if'} {source(ask)}:")
            lines.append(f"            state = {numbers[to]}")
        lines.append("        return")
    return "\n".join(lines) + "\n"


def load(written: str, sky: Sky, _: Guards) -> Machine:
    """Run the module."""
    module: dict[str, Any] = {"sky": sky}
    exec(written, module)  # noqa: S102 - our own text
    return Machine(module["tick"], lambda: f"s{module['state']}")


HOW = "one function of `if` and `elif`, guards in place; load: compile and run its source"
ENGINES = (Engine("if-else", HOW, text, load, counted=False),)
