"""Decisions of one tick."""

from __future__ import annotations

from typing import NamedTuple

from missionkit.messages.command import Command, Mode
from missionkit.messages.estimate import Estimate
from missionkit.messages.observation import NO_CYCLE, Cycle
from missionkit.messages.operator import OperatorAction
from missionkit.messages.verdict import Verdict

LOG_PREFIX = "log "  # begins an output that a `log:` action wrote


class Fired(NamedTuple):
    """A transition that was taken, and why."""

    source: str
    to: str
    reason: str  # "failsafe battery", "when converged for 1.0 s", "after 120 s", "operator: land"
    verdicts: tuple[tuple[str, Verdict], ...]  # the guards that decided, by name
    outputs: tuple[str, ...]  # Mealy, control mode first: "mode visual", "log ..."

    @property
    def logged(self) -> tuple[str, ...]:
        """The texts of its `log:` actions."""
        return tuple(
            it.removeprefix(LOG_PREFIX) for it in self.outputs if it.startswith(LOG_PREFIX)
        )


class Record(NamedTuple):
    """Everything that one tick decided."""

    now: float
    state: str  # that commands
    active: tuple[str, ...]  # the whole configuration, outer states first
    mode: Mode
    verdicts: tuple[tuple[str, Verdict], ...]  # every guard that was evaluated this tick
    fired: tuple[Fired, ...]  # in the order they were taken
    command: Command
    step_note: str
    problems: tuple[str, ...]  # invariant violations, contained plug-in errors
    estimate: Estimate
    done: bool = False  # the behaviour of `state` says that it has finished
    paused: bool = False  # by the operator
    actions: tuple[OperatorAction, ...] = ()  # of people at the page, since the last tick
    cycle: Cycle = NO_CYCLE  # wall time of this tick, as the shell measured it
