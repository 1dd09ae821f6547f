"""A mission compiled for the tick: states, transitions and guards as closures."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from missionkit.chart.contain import Containment
from missionkit.messages import Estimate, Verdict
from missionkit.plugin import Behavior
from missionkit.states.contract import StateKind


class Question:
    """What the guards of one tick are asked with, and what they answered."""

    __slots__ = ("answers", "contain", "seen", "windows")

    def __init__(self, seen: Estimate, windows: Sequence[Any], contain: Containment) -> None:
        self.seen = seen
        self.windows = windows
        self.contain = contain
        self.answers: dict[str, Verdict] = {}


Ask = Callable[[Question], Verdict]


class Slot(NamedTuple):
    """A guard that remembers: its place in the windows is its index in the chart's slots."""

    name: str
    begin: Callable[[], Any]
    advance: Callable[[Any, Question], Any]


class Output(NamedTuple):
    """One Mealy output of a transition, or an entry or exit action."""

    verb: str  # log, raise
    text: str


class Transition(NamedTuple):
    """When to leave, and where to."""

    number: int  # unique in the chart
    to: str
    text: str  # what the record calls it: "when converged for 1.0 s"
    ask: Ask | None = None
    hold: float = 0.0  # s the guard must have held
    after: float | None = None  # s since entry
    event: str | None = None
    outputs: tuple[Output, ...] = ()
    unknown_takes: bool = False  # failsafes: an unknown verdict counts as holding
    patient: bool = True  # waits for the state's dwell
    reads: frozenset[str] = frozenset()  # names of the guards it asks


class State(NamedTuple):
    """One state of the mission."""

    name: str
    kind: StateKind
    behavior: Behavior
    target: str | None  # what the behaviour works on
    dwell: float  # s, least time before a transition that is no failsafe
    transitions: tuple[Transition, ...] = ()
    entry: tuple[Output, ...] = ()
    exit: tuple[Output, ...] = ()
    violated_to: str | None = None  # where a broken invariant leads
    tolerated: float = 0.0  # s a broken invariant is tolerated
    promise: Ask | None = None  # what the mission demands besides the kind's invariant


class Chart(NamedTuple):
    """A compiled mission. Immutable; shared by any number of flights."""

    initial: str
    states: Mapping[str, State]
    failsafes: tuple[Transition, ...]
    slots: tuple[Slot, ...]
    land: str  # the state an operator's abort leads to
