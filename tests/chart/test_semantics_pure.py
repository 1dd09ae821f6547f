"""The step is a pure function; a flat chart does what `transitions` does."""

from __future__ import annotations

import copy
import pickle

from hypothesis import given, settings
from hypothesis import strategies as st
from stepping import TICK, Walk, chart_of
from transitions import Machine

from missionkit.chart.semantics.step import begin, decide
from missionkit.plugin_containment import Containment

INPUTS = ("a", "b", "c")
STATES = ("s0", "s1", "s2", "s3")

conditions = st.recursive(
    st.sampled_from(INPUTS),
    lambda inner: st.one_of(
        st.fixed_dictionaries({"not": inner}),
        st.fixed_dictionaries({"all": st.lists(inner, min_size=1, max_size=3)}),
        st.fixed_dictionaries({"any": st.lists(inner, min_size=1, max_size=3)}),
    ),
    max_leaves=4,
)
arrows = st.tuples(st.sampled_from(STATES), st.sampled_from(STATES), conditions)
inputs = st.lists(st.sets(st.sampled_from(INPUTS)), min_size=1, max_size=20)


def written(condition) -> str:
    if isinstance(condition, str):
        return condition
    ((form, inner),) = condition.items()
    if form == "not":
        return f"{{not: {written(inner)}}}"
    return f"{{{form}: [{', '.join(map(written, inner))}]}}"


def holds(condition, present) -> bool:
    if isinstance(condition, str):
        return condition in present
    ((form, inner),) = condition.items()
    if form == "not":
        return not holds(inner, present)
    return (all if form == "all" else any)(holds(part, present) for part in inner)


def chart_with(wires) -> str:
    lines = ["initial: s0", "dwell: 0", "states:"]
    for state in STATES:
        out = [
            f"{{to: {to}, when: {written(when)}}}" for source, to, when in wires if source == state
        ]
        lines.append(f"  {state}: {{kind: custom, transitions: [{', '.join(out)}]}}")
    return "\n".join([*lines, "  land: {kind: land}", ""])


class Oracle:
    """The same chart as an ordinary machine of `transitions`."""

    def __init__(self, wires) -> None:
        self.machine = machine = Machine(
            self, states=list(STATES), initial="s0", auto_transitions=False, send_event=True
        )
        machine.ignore_invalid_triggers = True
        for source, to, when in wires:
            machine.add_transition(
                "go", source, to, conditions=lambda event, when=when: holds(when, event.args[0])
            )
        if not wires:
            self.go = lambda _: False

    def run(self, present) -> None:
        """Go on until nothing is ready; stay where it began if that never comes to an end."""
        start = self.state
        if all(self.go(present) for _ in STATES):
            self.machine.set_state(start)


@given(st.lists(arrows, max_size=10), inputs)
@settings(deadline=None, max_examples=120, derandomize=True, database=None)
def test_a_flat_chart_goes_where_transitions_goes(wires, sequence):
    walk, oracle = Walk(chart_with(wires)), Oracle(wires)
    for present in sequence:
        walk.tick(*present)
        oracle.run(present)
        assert walk.state == oracle.state


TIMED = chart_of("""\
initial: s0
dwell: 0.1
failsafes: [{name: f, when: {use: tally, name: c, count: 9}, for: 0.2, unknown: ignore, to: land}]
states:
  s0: {kind: custom, transitions: [{to: s1, when: a, for: 0.15}, {to: s2, after: 1}]}
  s1: {kind: custom, entry: [{raise: e}], transitions: [{to: s2, event: e}, {to: s0, when: b}]}
  s2: {kind: custom, invariant: {holds: b, exit: s1}, transitions: [{to: s0, when: {not: a}}]}
  land: {kind: land}
""")


@given(inputs)
@settings(deadline=None, max_examples=60, derandomize=True, database=None)
def test_a_step_changes_nothing_it_was_given_and_always_answers_the_same(sequence):
    walk, memory = Walk(TIMED), begin(TIMED, 0.0)
    for count, present in enumerate(sequence, 1):
        seen = walk.seen(*sorted(present), now=count * TICK, state=memory.state)
        before = copy.deepcopy(memory)
        first = decide(TIMED, memory, seen, Containment())
        assert memory == before
        restored = pickle.loads(pickle.dumps(memory))  # noqa: S301
        assert decide(TIMED, restored, seen, Containment()) == first
        memory = first[0]
