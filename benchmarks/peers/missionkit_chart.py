"""missionkit itself."""

from __future__ import annotations

from functools import partial

from benchmarks.peers.ring import Engine, Guards, Machine, Ring, Sky, views
from missionkit.chart.load import parse
from missionkit.chart.model.state_contracts import unmet
from missionkit.chart.plugin_catalogue import builtin
from missionkit.chart.semantics.chart_compiler import compile_mission
from missionkit.chart.semantics.quick_step import begin, decide
from missionkit.plugin_containment import Containment

CATALOGUE = builtin()
FILE = "ring.yaml"  # what messages would call the text
HEAD = "missionkit: 1\nmission: ring\ndwell: 0\n"


def text(chart: Ring, event: str = "") -> str:
    """Write a mission file; the last state of the ring is the one to land in."""
    *rest, last = chart.states
    kinds = {**dict.fromkeys(rest, "logic"), last: "land"}
    lines = [f"{HEAD}initial: {chart.initial}", "states:"]
    for name, ways in chart.states.items():
        lines += [f"  {name}:", f"    kind: {kinds[name]}", "    transitions:"]
        for to, ask in ways:
            when = f"{{use: {ask.use}, {ask.key}: {ask.limit:g}}}"
            heard = f", event: {event}" if event else ""
            lines.append(f"      - {{to: {to}, when: {when}{heard}}}")
    return "\n".join(lines) + "\n"


def load(written: str, sky: Sky, _: Guards) -> Machine:
    """Parse, check and compile a mission file."""
    mission = parse(written, FILE, CATALOGUE)
    unmet(mission, CATALOGUE)
    chart = compile_mission(mission, CATALOGUE)
    contain = Containment()
    memory = begin(chart, 0.0)

    def tick() -> None:
        nonlocal memory
        memory, _ = decide(chart, memory, sky.seen, contain)

    return Machine(tick, lambda: memory.active[-1])


HOW = "`quick_step.decide`, guards of the package, dwell 0; load: parse, check, compile a YAML text"
AIR = "the same with the vehicle in the air, where the failsafe for failed plug-ins is asked too"
EVENT = "the same with transitions that wait for an event, which comes at every tick"
ENGINES = (
    Engine("missionkit", HOW, text, load),
    Engine("missionkit, in the air", AIR, text, load, views=views(in_air=True)),
    Engine(
        "missionkit, by an event",
        EVENT,
        partial(text, event="tick"),
        load,
        views=views(events=("tick",)),
    ),
)
