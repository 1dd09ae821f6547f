"""A mission compiled for the tick: states, transitions and guards as closures.

What the tick reads again and again is a dataclass: its attributes are found three times as fast
as a named tuple's.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Any, NamedTuple

from missionkit.chart.model.variables import Value, Values, Variable
from missionkit.chart.semantics.requirement_watch import WatchedRequirement
from missionkit.messages import Estimate, Mode, Verdict
from missionkit.plugin_containment import Containment
from missionkit.plugin_protocols import BehaviorProtocol
from missionkit.states.contract import StateKind

NO_VALUES: Values = {}
ROOT_STATE = ""  # the name of the state around all others, which is never left


class GuardContext:
    """Inputs and answers of the guards in one tick."""

    __slots__ = ("active", "answers", "contain", "frugal", "seen", "variables", "windows")

    def __init__(
        self,
        seen: Estimate,
        windows: Sequence[Any],
        contain: Containment,
        active: tuple[str, ...] = (),
        variables: Values = NO_VALUES,
        *,
        frugal: bool = False,
    ) -> None:
        self.frugal = frugal  # ask no guard that the selection does not need
        self.seen = seen
        self.windows = windows
        self.contain = contain
        self.active = active
        self.variables = variables
        self.answers: dict[str, Verdict] = {}


GuardFunction = Callable[[GuardContext], Verdict]


def _as_it_was(memory: Any, _: float) -> Any:
    return memory


class GuardMemory(NamedTuple):
    """A guard that remembers: its place in the windows is its index in the chart's slots."""

    name: str
    begin: Callable[[], Any]
    advance: Callable[[Any, GuardContext], Any]
    resumed: Callable[[Any, float], Any] = _as_it_was  # memory and gap (s)


class Output(NamedTuple):
    """One Mealy output of a transition, or an entry or exit action."""

    verb: str  # log, raise, cancel, assign, vehicle
    text: str
    operation: str = ""  # assign: set, add, copy, toggle; raise: after
    operand: Value = ""  # raise: s, or the variable that holds them


class Shape(Enum):
    """Type of a state in the tree."""

    ATOMIC = "atomic"
    COMPOUND = "compound"
    PARALLEL = "parallel"
    FINAL = "final"
    SHALLOW = "shallow history"
    DEEP = "deep history"


HISTORY = frozenset((Shape.SHALLOW, Shape.DEEP))
LEAVES = frozenset((Shape.ATOMIC, Shape.FINAL))


class DefaultEntry(NamedTuple):
    """Where a compound state or a history leads by default."""

    to: tuple[str, ...] = ()
    outputs: tuple[Output, ...] = ()


NO_DEFAULT_ENTRY = DefaultEntry()


@dataclass(frozen=True, slots=True)
class CompiledTransition:
    """When to leave, and where to."""

    number: int  # unique in the chart
    to: tuple[str, ...]  # none: targetless, only its outputs
    text: str  # what the record calls it: "when converged for 1.0 s"
    source: str = ROOT_STATE
    ask: GuardFunction | None = None
    hold: float = 0.0  # s the guard must have held
    after: float | None = None  # s since entry
    events: tuple[str, ...] = ()  # one of them must have come
    outputs: tuple[Output, ...] = ()
    unknown_takes: bool = False  # failsafes: an unknown verdict counts as holding
    patient: bool = False  # waits for the dwell of its source
    internal: bool = False
    reads: tuple[str, ...] = ()  # names of the guards it evaluates, in that order
    check: Callable[[Estimate], Verdict] | None = None  # of its only guard, one of the package
    default: bool = False  # a default failsafe: added by the contract of a kind


@dataclass(frozen=True, slots=True)
class CompiledState:
    """One state of the mission."""

    name: str
    kind: StateKind
    behavior: BehaviorProtocol | None
    target: str | None  # what the behaviour works on
    dwell: float  # s, least time before a transition other than a failsafe
    transitions: tuple[CompiledTransition, ...] = ()
    entry: tuple[Output, ...] = ()
    exit: tuple[Output, ...] = ()
    violated_to: str | None = None  # where a broken invariant leads
    tolerated: float = 0.0  # s a broken invariant is tolerated
    promise: GuardFunction | None = None  # what the mission demands besides the kind's invariant
    shape: Shape = Shape.ATOMIC
    order: int = 0  # in the document
    parent: str = ROOT_STATE
    ancestors: tuple[str, ...] = ()  # from the parent up to and with the root
    children: tuple[str, ...] = ()
    initial: DefaultEntry = NO_DEFAULT_ENTRY  # of a compound state, or a history's default
    remembered: bool = False  # a history may lead back here


class DirectGuard(NamedTuple):
    """A guard that needs no more than the estimate, and the transition that waits for it."""

    name: str
    check: Callable[[Estimate], Verdict]
    wait: float  # s since the entry of the source
    source: str


class TimedTransition(NamedTuple):
    """A transition and the time since the entry of its source that it needs at least."""

    transition: CompiledTransition
    wait: float  # s


@dataclass(frozen=True, slots=True)
class Configuration:
    """Precomputed data of a configuration, built once for each that occurs."""

    direct: tuple[DirectGuard, ...]  # guards of the package, evaluated directly without containment
    plain: tuple[tuple[GuardFunction, float, str], ...]  # others, with the wait (s) and the source
    timed: tuple[CompiledTransition, ...]  # those whose guard must hold for some time
    timers: tuple[tuple[float, str], ...]  # wait (s) and source of those without a guard
    ways: tuple[
        tuple[TimedTransition, ...], ...
    ]  # without an event, for each atomic state, inner first
    heard: tuple[tuple[TimedTransition, ...], ...]  # with an event
    soonest: float  # s, the least wait of those without an event
    promising: tuple[CompiledState, ...]  # those with an invariant
    pilot: str  # whose behaviour commands; empty if none does
    mode: Mode
    mode_text: str  # what the record says of it
    flying: bool
    safety: int  # 2 landing, 1 returning


@dataclass(frozen=True, slots=True)
class Watch:
    """The requirements of a chart, and the guards that they are made of."""

    requirements: tuple[WatchedRequirement, ...] = ()
    guards: tuple[tuple[str, GuardFunction], ...] = ()  # by the names of their answers
    entries: tuple[tuple[str, str], ...] = ()  # name of the answer, state that is entered
    states: tuple[tuple[str, str], ...] = ()  # name of the answer, state that is active


@dataclass(frozen=True, slots=True)
class Chart:
    """A compiled mission. Immutable but for its memos; shared by any number of flights."""

    initial: str  # the state that commands first
    states: Mapping[str, CompiledState]  # the root too
    failsafes: tuple[CompiledTransition, ...]
    slots: tuple[GuardMemory, ...]
    land: str  # the state an operator's abort leads to
    variables: Mapping[str, Variable]
    watch: Watch
    configurations: dict[tuple[str, ...], Configuration]  # memo of `configuration.configuration`
    moves: dict[Any, Any]  # memo of `entry_exit_sets.move`
