"""Outcome of a flight over MAVLink by the vehicle's own account; there is no ground truth."""

from __future__ import annotations

from collections.abc import Sequence

from missionkit.chart.model.mission_sections import Success
from missionkit.chart.semantics.compiled_chart import Chart
from missionkit.engine.flight_end import FlightEnd, FlownFlight
from missionkit.engine.flight_history import FlightHistory, after, passed
from missionkit.engine.flight_loop import Observer
from missionkit.engine.mission_success import conditions, flaws
from missionkit.messages import Observation, Record
from missionkit.outcome import aborted, missing, succeeded
from missionkit.recorder.flight_track import FlightTrack
from missionkit.recorder.run_summary import Outcome
from missionkit.vehicle.adapter import MavsdkVehicle


class FlightLog:
    """Keeps what a flight went through: an observer of `fly`.

    Args:
        chart: that is flown.
        past: the track of the parts before, of a flight that was resumed.
    """

    def __init__(self, chart: Chart, past: FlightTrack | None = None) -> None:
        visits = () if past is None else past.visits
        self.passage = FlightHistory({it.state: (it.start, it.end) for it in reversed(visits)})
        for at, fired in () if past is None else past.transitions:
            self.passage = after(self.passage, fired, at, chart)
        self._chart = chart

    def __call__(self, record: Record, _: Observation) -> None:
        """Take in one tick."""
        self.passage = passed(self.passage, record, self._chart)


def with_remarks(observers: Sequence[Observer], vehicle: MavsdkVehicle) -> Observer:
    """Return one observer that adds what is wrong with camera and link to each record's problems.

    Args:
        observers: called with the records.
        vehicle: that is flown.
    """

    def relay(record: Record, seen: Observation) -> None:
        more = tuple(f"vehicle: {remark}" for remark in vehicle.take_remarks())
        if wrong := vehicle.camera_problem:
            more += (f"camera: {wrong}",)
        if more:
            record = record._replace(problems=record.problems + more)
        for observer in observers:
            observer(record, seen)

    return relay


def outcome_of(flown: FlownFlight, passage: FlightHistory, wanted: tuple[Success, ...]) -> Outcome:
    """Return how a flight ended, as reported by the vehicle.

    Args:
        flown: result of the flight loop.
        passage: what happened in flight.
        wanted: conditions of success.
    """
    if flown.end in {FlightEnd.SILENT, FlightEnd.OUT_OF_TIME}:
        return "crash"
    return "ended_safely" if _missed(flown, passage, wanted, landing_requested=False) else "success"


def reason_of(
    flown: FlownFlight,
    passage: FlightHistory,
    wanted: tuple[Success, ...],
    *,
    landing_requested: bool,
) -> str:
    """Return the reason of the outcome in a sentence.

    Args:
        flown: result of the flight loop.
        passage: what happened in flight.
        wanted: conditions of success.
        landing_requested: the operator requested a landing.
    """
    missed = _missed(flown, passage, wanted, landing_requested=landing_requested)
    return missed or f"{succeeded(passage)}, as reported by the vehicle"


def _missed(
    flown: FlownFlight,
    passage: FlightHistory,
    wanted: tuple[Success, ...],
    *,
    landing_requested: bool,
) -> str:
    """Say what success lacks; how near the goal was, only a simulator's truth can tell."""
    if flown.end is not FlightEnd.LANDED:
        return flown.says
    if flown.aborted:
        return aborted(landing_requested=landing_requested)
    wrong = flaws(wanted, passage, None)
    if wrong:
        return f"not a success: {wrong[0]}"
    return missing(conditions(wanted, passage, None))
