"""Memory of a chart between ticks, and its decisions at each tick."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple

from missionkit.chart.model.variables import Values
from missionkit.chart.semantics import entry_exit_sets
from missionkit.chart.semantics.compiled_chart import Chart
from missionkit.chart.semantics.configuration import configuration
from missionkit.chart.semantics.requirement_monitor import MonitorMemory
from missionkit.messages import Action, Fired, Verdict

EMPTY_MEMORY: Mapping[Any, Any] = {}


class DelayedEvent(NamedTuple):
    """An event that the chart has raised and that is yet to come."""

    due: float  # s, mission time
    event: str


class ChartMemory(NamedTuple):
    """Where the chart stands. Immutable, and fit to be saved."""

    active: tuple[str, ...]  # the configuration, in document order
    entered: Mapping[str, float]  # state -> when it was entered, s
    windows: tuple[Any, ...]  # what the guards remember
    variables: Values
    pilot: str  # the state whose behaviour commands, empty if none does
    history: entry_exit_sets.History = EMPTY_MEMORY
    held: Mapping[int, float] = EMPTY_MEMORY  # transition -> since when its guard has held, s
    violated: Mapping[str, float] = EMPTY_MEMORY  # state -> since when its invariant is broken, s
    started: bool = False  # the initial states' entry was carried out
    ended: bool = False  # a final state of the whole chart is active
    delayed: tuple[DelayedEvent, ...] = ()  # the next first
    monitors: tuple[MonitorMemory, ...] = ()  # of the requirements, in the order of the file

    @property
    def state(self) -> str:
        """The state that commands; the innermost one if none does."""
        return self.pilot or self.active[-1]

    @property
    def entered_at(self) -> float:
        """When that state was entered (s)."""
        return self.entered[self.state]


class Decision(NamedTuple):
    """Decisions of one tick."""

    answers: Mapping[str, Verdict]  # of every guard that was evaluated, in that order
    fired: tuple[Fired, ...] = ()  # in the order they were taken
    moves: tuple[entry_exit_sets.Move, ...] = ()  # one for each microstep
    entered: bool = False  # the state that commands was entered at this tick
    orders: tuple[Action, ...] = ()  # for the autopilot
    problems: tuple[str, ...] = ()


def begin(chart: Chart, now: float) -> ChartMemory:
    """Return the memory before the first tick."""
    windows = tuple(slot.begin() for slot in chart.slots)
    active = entry_exit_sets.beginning(chart).active
    variables = {name: each.initial for name, each in chart.variables.items()}
    pilot = configuration(chart, active).pilot
    monitors = tuple(MonitorMemory() for _ in chart.watch.requirements)
    entered = dict.fromkeys(active, now)
    return ChartMemory(active, entered, windows, variables, pilot, monitors=monitors)
