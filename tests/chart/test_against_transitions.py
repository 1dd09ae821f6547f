"""Random flat charts leave and enter the same states as the package `transitions` says."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st
from stepping import Walk
from transitions import EventData, Machine

EVENTS = ("go", "stop", "turn")
FLAGS = ("a", "b", "c")  # guards of `stepping`


@dataclass(frozen=True)
class Arrow:
    """A transition; without a target only its action is carried out."""

    source: str
    target: str | None
    event: str
    needed: tuple[tuple[str, bool], ...]  # flags, and whether each must be up

    def holds(self, up: frozenset[str]) -> bool:
        return all((flag in up) is wanted for flag, wanted in self.needed)

    def written(self, number: int) -> str:
        to = "" if self.target is None else f"to: {self.target}, "
        parts = [flag if wanted else f"{{not: {flag}}}" for flag, wanted in self.needed]
        when = f"when: {{all: [{', '.join(parts)}]}}, " if parts else ""
        return f"{{{to}event: {self.event}, {when}do: [{{log: took-{number}}}]}}"


Arrows = tuple[Arrow, ...]
needs = st.dictionaries(st.sampled_from(FLAGS), st.booleans(), max_size=2)
ticks = st.lists(
    st.tuples(
        st.lists(st.sampled_from(EVENTS), max_size=3),
        st.frozensets(st.sampled_from(FLAGS)),
    ),
    min_size=1,
    max_size=20,
)


@st.composite
def charts(draw: st.DrawFn) -> tuple[list[str], Arrows]:
    """Draw the names of 3 to 8 states and the transitions between them."""
    states = [f"s{at}" for at in range(draw(st.integers(3, 8)))]
    state = st.sampled_from(states)
    arrow = st.builds(
        Arrow,
        source=state,
        target=st.one_of(state, state, state, st.none()),
        event=st.sampled_from(EVENTS),
        needed=needs.map(lambda flags: tuple(flags.items())),
    )
    return states, tuple(draw(st.lists(arrow, max_size=5 * len(states))))


def mission(states: list[str], arrows: Arrows) -> str:
    lines = [f"initial: {states[0]}", "dwell: 0", "states:"]
    for state in states:
        out = [arrow.written(at) for at, arrow in enumerate(arrows) if arrow.source == state]
        lines.append(
            f"  {state}: {{kind: custom, entry: [{{log: in-{state}}}], "
            f"exit: [{{log: out-{state}}}], transitions: [{', '.join(out)}]}}"
        )
    return "\n".join([*lines, "  land: {kind: land}", ""])


class Oracle:
    """The same chart as an ordinary machine of `transitions`."""

    def __init__(self, states: list[str], arrows: Arrows) -> None:
        self.trace: list[str] = []
        self.machine = Machine(
            self,
            states=states,
            initial=states[0],
            auto_transitions=False,
            send_event=True,
            ignore_invalid_triggers=True,
        )
        for state in states:
            self.machine.get_state(state).add_callback("enter", self.say(f"in-{state}"))
            self.machine.get_state(state).add_callback("exit", self.say(f"out-{state}"))
        for at, arrow in enumerate(arrows):
            self.add(arrow, at)

    def add(self, arrow: Arrow, number: int) -> None:
        def holds(event: EventData) -> bool:
            return arrow.holds(event.args[0])

        self.machine.add_transition(
            *(arrow.event, arrow.source, arrow.target),
            conditions=holds,
            before=self.say(f"took-{number}"),
        )

    def say(self, what: str) -> Any:
        return lambda _: self.trace.append(what)

    def tick(self, events: list[str], up: frozenset[str]) -> list[str]:
        self.trace.clear()
        for event in events:
            if event in self.machine.events:
                self.machine.events[event].trigger(self, up)
        return sorted_steps(self.trace)


def sorted_steps(trace: list[str]) -> list[str]:
    """Put what was done on leaving before the transition's own action, as a chart does."""
    for at, one in enumerate(trace[:-1]):
        if one.startswith("took") and trace[at + 1].startswith("out"):
            trace[at], trace[at + 1] = trace[at + 1], one
    return list(trace)


def said(walk: Walk, events: list[str], up: frozenset[str]) -> list[str]:
    decision = walk.tick(*sorted(up), *events)
    outputs = [each for fired in decision.fired for each in fired.outputs]
    return [each.removeprefix("log ") for each in outputs if each.startswith("log ")]


@given(charts(), ticks)
@settings(deadline=None, max_examples=150, derandomize=True, database=None)
def test_a_flat_chart_does_what_transitions_does(chart, sequence):
    walk, oracle = Walk(mission(*chart)), Oracle(*chart)
    assert said(walk, [], frozenset()) == [f"in-{walk.state}"]
    for events, up in sequence:
        assert said(walk, events, up) == oracle.tick(events, up)
        assert walk.state == oracle.state
