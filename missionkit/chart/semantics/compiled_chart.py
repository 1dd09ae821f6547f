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


class AskedGuard(NamedTuple):
    """A guard as the quick step asks it.

    One of the package that needs no more than the estimate has a `check`; one that compares a
    number or reads a truth value is measured, and checked only if that gives anything else.
    """

    ask: GuardFunction  # if there is no check
    unknown_takes: bool = False  # unknown counts as holding
    name: str = ""  # of its answer, if there is a check
    check: Callable[[Estimate], Verdict] | None = None
    measure: Callable[[Estimate], object] = lambda _: None
    rising: bool = False  # it holds above the threshold
    strict: bool = False  # it does not hold at the threshold
    threshold: float = 0.0
    why: str = ""  # what a verdict says of its value


GuardRow = tuple[Any, ...]  # an `AskedGuard` as a plain tuple


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
    guard: AskedGuard | None = None  # the same as `ask`, for the quick step
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
    given_by: tuple[str, ...] = ()  # variables that give parameters of the behaviour
    with_values: Callable[[tuple[Value, ...]], BehaviorProtocol] | None = None


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


# a transition: itself, its guard, the name of the answer if the guard is asked
# directly, the wait (s), the source, the time (s) that the guard must have held
Lead = tuple["CompiledTransition", "GuardFunction | None", str, float, str, float]
# the transitions that wait for an event, and whether one of them has no guard
Hearing = tuple[tuple[Lead, ...], bool]
# where a transition leads that does nothing else: the move, the configuration there, the target and
# the outputs as the record has them, whether the guards there must be asked too
Crossing = tuple[Any, "Configuration", str, tuple[str, ...], bool]


@dataclass(frozen=True, slots=True)
class Configuration:
    """Precomputed data of a configuration, built once for each that occurs."""

    direct: tuple[DirectGuard, ...]  # guards of the package, evaluated directly without containment
    plain: tuple[tuple[GuardFunction, float, str], ...]  # others, with the wait (s) and the source
    timed: tuple[CompiledTransition, ...]  # those whose guard must hold for some time
    timers: tuple[tuple[float, str], ...]  # wait (s) and source of those without a guard
    guards: tuple[GuardRow, ...]  # of the transitions, each once, in the order of the record
    danger: tuple[GuardRow, ...]  # of the failsafes
    alarms: frozenset[str]  # their names
    pure: bool  # `guards` need no more than the estimate
    simple: tuple[GuardRow, ...] | None  # all that is asked; None: that needs more
    simple_in_air: tuple[GuardRow, ...] | None  # the same where failsafes act
    crossings: dict[int, Crossing]  # memo of `quick_step`: where transitions lead
    hears: dict[str, Hearing]  # memo of `heard_events.hearing`
    ways: tuple[
        tuple[TimedTransition, ...], ...
    ]  # without an event, for each atomic state, inner first
    heard: tuple[tuple[TimedTransition, ...], ...]  # with an event
    leads: tuple[Lead, ...]  # `ways` of all regions in one row
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
    home: str  # the state an operator's return leads to; "": it has none
    variables: Mapping[str, Variable]
    watch: Watch
    configurations: dict[tuple[str, ...], Configuration]  # memo of `configuration.configuration`
    moves: dict[Any, Any]  # memo of `entry_exit_sets.move`
