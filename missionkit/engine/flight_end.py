"""How a flight ends, and when it has."""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple

from missionkit.engine.flight_state import FlightMemory, FlightState
from missionkit.engine.prepared_mission import PreparedMission
from missionkit.engine.run_lifecycle import Lifecycle
from missionkit.engine.tick import Ticked
from missionkit.messages import Action

GROUNDED = 3.0  # s disarmed in a flying state: the flight is over, whatever the chart says
ARMING_TIMEOUT = 30.0  # s without any observation that allows arming
LONGEST_ABORT = 300.0  # s an abort may take, or the wait for arming
LONGEST_SILENCE_LANDING = 120.0
"""s without a heartbeat while landing: nothing more can be learnt or done."""


class FlightEnd(StrEnum):
    """How a flight ended."""

    LANDED = "landed"
    GROUNDED = "on the ground although the chart was still flying"
    NEVER_LEFT = "the vehicle never took off"
    NOT_ARMED = "the vehicle was not armed"
    OUT_OF_TIME = "still in the air when time ran out"
    SILENT = "ordered to land, but the vehicle no longer responds"


AT_REST = frozenset(
    (FlightEnd.LANDED, FlightEnd.GROUNDED, FlightEnd.NEVER_LEFT, FlightEnd.NOT_ARMED)
)
"""Ends at which the vehicle stands on the ground."""


class FlownFlight(NamedTuple):
    """Result of the flight loop."""

    end: FlightEnd
    aborted: bool
    duration: float  # s, mission time
    ticks: int
    memory: FlightMemory
    why: str = ""  # it stayed on the ground

    @property
    def says(self) -> str:
        """How it ended, in words."""
        more = "; --anyway overrides this" if self.end is FlightEnd.NOT_ARMED else ""
        return f"{self.end}: {self.why}{more}" if self.why else str(self.end)


class FlightWatch:
    """Notices when the flight is over.

    Args:
        time_limit: s, mission time after which the flight is aborted.
        since: the flight that begins or resumes.
    """

    def __init__(self, time_limit: float, since: FlightState) -> None:
        self.flown = since.flown
        self.grounded_since = since.grounded_since
        self.time_limit = time_limit
        self.refused_since: float | None = None
        self.returning = False  # the chart has ordered the autopilot home
        self.why = ""

    def over(self, plan: PreparedMission, done: Ticked) -> FlightEnd | None:
        """Return how the flight has ended with a tick, None while it goes on.

        Args:
            plan: that is flown.
            done: result of the tick.
        """
        now, status = done.memory.now, done.record.estimate.status
        state = plan.chart.states[done.record.state]
        ended = done.memory.chart.ended and status is not None and not status.in_air
        if ended or (state.kind.name == "land" and done.memory.acting.done):
            return FlightEnd.LANDED if self.flown else FlightEnd.NEVER_LEFT
        if (
            state.kind.name == "land"
            and now - (0.0 if status is None else status.at) > LONGEST_SILENCE_LANDING
        ):
            return FlightEnd.SILENT
        if status is not None:
            self.flown = self.flown or status.in_air
        self.why = done.grounded or done.record.step_note
        if not self.flown and now >= LONGEST_ABORT and (status is None or not status.armed):
            return FlightEnd.NEVER_LEFT
        if self._refused(done):
            return FlightEnd.NOT_ARMED
        command = done.record.command
        self.returning = command.setpoint is None and (
            self.returning or command.action is Action.RETURN
        )
        down = self.flown and status is not None and not status.armed and not status.in_air
        self.grounded_since = (self.grounded_since or now) if down else None
        if self.grounded_since is not None and now - self.grounded_since >= GROUNDED:
            return FlightEnd.LANDED if self.returning else FlightEnd.GROUNDED
        return FlightEnd.OUT_OF_TIME if now >= self.time_limit + LONGEST_ABORT else None

    def _refused(self, done: Ticked) -> bool:
        """Say whether arming has been refused for too long; one tick without refusal resets it."""
        if not done.grounded or self.flown:
            self.refused_since = None
            return False
        now = done.memory.now
        self.refused_since = now if self.refused_since is None else self.refused_since
        return now - self.refused_since >= ARMING_TIMEOUT

    def course(self, memory: FlightMemory, life: Lifecycle) -> FlightState:
        """Return the flight in progress, fit to be saved.

        Args:
            memory: as the tick left it.
            life: of the run.
        """
        return FlightState(memory, self.flown, self.grounded_since, life.state == "aborting")
