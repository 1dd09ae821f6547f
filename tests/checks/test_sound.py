"""Soundness of the checks: random charts never do what was proved impossible."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st
from samples import calm

from missionkit.chart.checks import findings
from missionkit.chart.load import parse
from missionkit.chart.model.mission import Mission
from missionkit.chart.semantics.chart_compiler import compile_mission
from missionkit.chart.semantics.step import begin, decide
from missionkit.messages import Battery
from missionkit.plugin_containment import Containment
from studies.soundness_charts import CATALOGUE

STATES = ("s0", "s1", "s2", "s3", "in0", "in1", "left", "right")
LEAVES = [
    *(f"{{use: battery_below, floor: {floor}}}" for floor in ("0", "0.3", "0.5", "0.7", "1")),
    *("{use: elapsed, longer_than: 0.2}", "a", "b", "{in: s1}", "{in: right}"),
    "{hysteresis: {use: battery_below, floor: 0.5}, enter: 0.4, exit: 0.6}",
    *("{variable: n, at_least: 2}", "{variable: n, at_least: 5}"),
]
GUARDS = st.recursive(
    st.sampled_from(LEAVES),
    lambda inner: (
        st.tuples(st.sampled_from(["all", "any"]), st.lists(inner, min_size=1, max_size=3)).map(
            lambda it: f"{{{it[0]}: [{', '.join(it[1])}]}}"
        )
        | inner.map(lambda part: f"{{not: {part}}}")
    ),
    max_leaves=4,
)
FORMS = (
    *("{to: TO, when: GUARD", "{to: TO, when: GUARD, for: 0.1", "{to: TO, after: 0.3"),
    *("{to: TO, when: GUARD, event: e", "{to: TO, event: [e, f]"),
    *("{do: [{assign: {n: {add: 1}}}], when: GUARD", "{do: [{raise: e}], event: f"),
)
WAYS = st.tuples(st.sampled_from(STATES), st.sampled_from(FORMS), st.sampled_from(STATES), GUARDS)
SEEN = st.lists(
    st.tuples(
        st.sampled_from([0.0, 0.1, 0.3, 0.35, 0.45, 0.5, 0.55, 0.65, 0.8, 1.0, None]),
        st.lists(st.sampled_from(["a", "a?", "b", "b?", "e", "f"]), max_size=2, unique=True),
    ),
    min_size=1,
    max_size=30,
)


def chart(ways: list[tuple[str, str, str, str]], dwell: str) -> tuple[str, dict[int, str]]:
    """Return a mission and the name of the transition in each line."""
    of: dict[str, list[str]] = {name: [] for name in STATES}
    for at, (source, form, to, guard) in enumerate(ways):
        of[source].append(f"{form.replace('TO', to).replace('GUARD', guard)}, name: t{at}}}")
    lines = [
        *("missionkit: 1", "mission: random", f"dwell: {dwell}", "initial: s0"),
        "variables: {n: {initial: 0, max: 3}}",
        "guards: {a: {use: flag, name: a}, b: {use: flag, name: b}}",
        "states:",
    ]

    def state(name: str, indent: str, shape: str = "kind: custom, behavior: hold") -> None:
        lines.extend(f"{indent}{name}:\n".splitlines())
        lines.extend(f"{indent}  {each}" for each in shape.split(", "))
        lines.append(f"{indent}  transitions:" + ("" if of[name] else " []"))
        lines.extend(f"{indent}    - {way}" for way in of[name])

    for name in ("s0", "s1"):
        state(name, "  ")
    state("s2", "  ", "kind: logic, initial: in0")
    lines.append("    states:")
    state("in0", "      ")
    state("in1", "      ")
    state("s3", "  ", "kind: logic, parallel: true")
    lines.append("    states:")
    state("left", "      ")
    state("right", "      ", "kind: logic")
    lines.append("  land: {kind: land}")
    named = {
        at: line.rsplit("name: ", 1)[1].rstrip("}")
        for at, line in enumerate(lines, 1)
        if "name: t" in line
    }
    return "\n".join(lines), named


def flown(mission: Mission, seen: list) -> tuple[set[str], set[str], bool]:
    """Return the states entered, the transitions taken, and whether it always came to rest."""
    compiled = compile_mission(mission, CATALOGUE)
    memory, contain = begin(compiled, 0.0), Containment()
    entered, taken = set(memory.active), set()
    for tick, (charge, events) in enumerate(seen, 1):
        now = tick * 0.05
        battery = None if charge is None else Battery(now, charge, 16.0)
        estimate = calm(
            now=now,
            battery=battery,
            events=tuple(events),
            state=memory.state,
            entered_at=memory.entered_at,
        )
        memory, decision = decide(compiled, memory, estimate, contain)
        entered.update(memory.active, *(move.active for move in decision.moves))
        taken.update(fired.reason.partition(",")[0] for fired in decision.fired)
    return entered, taken, not any("come to rest" in each for each in contain.take())


@settings(deadline=None, derandomize=True, database=None, max_examples=80)
@given(st.lists(WAYS, min_size=2, max_size=9), st.sampled_from(["0", "0.1"]), SEEN)
def test_transitions_reported_dead_never_fire(ways, dwell, seen):
    text, named = chart(ways, dwell)
    mission = parse(text, "m.yaml", CATALOGUE)
    found = findings(mission, CATALOGUE)
    entered, taken, rested = flown(mission, seen)
    for problem in found:
        if problem.code == "unreachable-state":
            assert problem.message.split("'")[1] not in entered, text
        late = problem.code == "contradictory-timers" and problem.level == "error"
        if late or problem.code in {"never-true", "never-fires", "shadowed-transition"}:
            assert named[problem.place.line] not in taken, f"{problem}\n{text}"
    codes = {problem.code for problem in found}
    counts = any("assign" in form for _, form, _, _ in ways)
    assert rested or counts or "livelock" in codes, text
