"""Whether a flight was a success: the mission's conditions, and what no success survives."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from missionkit.chart.model.mission_sections import Success
from missionkit.engine.flight_history import FlightHistory
from missionkit.number_text import beside
from missionkit.states.multicopter import MULTICOPTER
from missionkit.states.vehicle_kind import VehicleKind

FENCE_LIMIT = 0.0  # m, outside a fence of the mission's failsafes


class Condition(NamedTuple):
    """One condition of success, and what came of it."""

    says: str
    met: bool | None  # None: needs the ground truth, which is unknown
    figure: str
    never: str = ""  # the state that was never entered


class TruthSummary(NamedTuple):
    """The ground truth that the conditions of success need."""

    visits: Mapping[str, tuple[float, float | None] | None]  # state -> m, deg on entry
    clearance: float  # m
    touched_at: float | None = None  # s, the ground outside landing and take-off
    estimate_error: float = 0.0  # m, largest in flight
    outside_fence: float = 0.0  # m
    landing_error: float | None = None  # m, from where it meant to land
    docked: bool = False  # a free flyer, at the end
    docking_error: tuple[float, float] | None = None  # m, deg, from the docked pose at the end
    robots_home: int | None = None  # of an arena; None: it has no robots


def conditions(
    wanted: tuple[Success, ...], passage: FlightHistory, truth: TruthSummary | None
) -> tuple[Condition, ...]:
    """Return every condition of a mission with its figure.

    Args:
        wanted: the mission's `success`.
        passage: what the flight went through.
        truth: of a simulated flight; None: unknown.
    """
    return tuple(found for one in wanted for found in _conditions(one, passage, truth))


def flaws(
    wanted: tuple[Success, ...],
    passage: FlightHistory,
    truth: TruthSummary | None,
    vehicle: VehicleKind = MULTICOPTER,
) -> tuple[str, ...]:
    """Return what makes a flight no success, whatever its conditions say.

    Args:
        wanted: the mission's `success`.
        passage: what the flight went through.
        truth: of a simulated flight; None: unknown.
        vehicle: sets how far estimate and end may be off.
    """
    found = [] if truth is None else list(_by_truth(truth, vehicle))
    if passage.lost:
        found.append(f"did not know its position when it began to land: {passage.lost}")
    ended = passage.ended_by
    if ended is not None and ended.default:
        found.append(f"a default failsafe ended it at {ended.at:.1f} s: {ended.label}")
    elif ended is not None and not wanted:
        found.append(
            f"{ended.label} ended it at {ended.at:.1f} s, and the mission does not define success"
        )
    return tuple(found)


def _by_truth(truth: TruthSummary, vehicle: VehicleKind) -> Iterator[str]:
    if truth.touched_at is not None:
        yield f"touched the ground at {truth.touched_at:.1f} s, outside landing and take-off"
    if truth.outside_fence > FENCE_LIMIT:
        shown, _ = beside(truth.outside_fence, FENCE_LIMIT, 1)
        yield f"left its fence by {shown} m (ground truth)"
    if truth.estimate_error > vehicle.estimate_limit:
        shown, limit = beside(truth.estimate_error, vehicle.estimate_limit, 1)
        yield f"the estimate was up to {shown} m off, more than {limit} m"
    if truth.landing_error is not None and truth.landing_error > vehicle.ending_limit:
        shown, limit = beside(truth.landing_error, vehicle.ending_limit, 1)
        how = "landed" if vehicle.over_ground else "ended"
        yield f"{how} {shown} m from where it meant to, more than {limit} m"


def _conditions(
    one: Success, passage: FlightHistory, truth: TruthSummary | None
) -> Iterator[Condition]:
    if one.visit is not None:
        yield _visit(one, one.visit, passage, truth)
    if one.done is not None:
        at = passage.finished.get(one.done)
        figure = "never" if at is None else f"at {at:.1f} s"
        yield Condition(f"{one.done} finished", at is not None, figure)
    if one.docked is not None:
        yield _docked(one, truth)
    if one.clearance is not None:
        says = f"{one.clearance:g} m clear of obstacles"
        if truth is None:
            yield Condition(says, None, "known only in simulation")
        else:
            shown, _ = beside(truth.clearance, one.clearance, 2)
            yield Condition(says, truth.clearance >= one.clearance, f"{shown} m")
    if one.failsafes is not None:
        count = len(passage.failsafes)
        says = f"at most {one.failsafes} failsafes taken"
        yield Condition(says, count <= one.failsafes, str(count))
    if one.robots_home is not None:
        yield _robots_home(one.robots_home, truth)


def _robots_home(least: int, truth: TruthSummary | None) -> Condition:
    says = f"at least {least} robots home"
    if truth is None:
        return Condition(says, None, "known only in simulation")
    if truth.robots_home is None:
        return Condition(says, met=False, figure="no robots in the world")
    return Condition(says, truth.robots_home >= least, str(truth.robots_home))


def _docked(one: Success, truth: TruthSummary | None) -> Condition:
    says = f"docked to {one.docked}, within {one.position:g} m and {one.attitude_deg:g} deg"
    if truth is None:
        return Condition(says, None, "known only in simulation")
    if not truth.docked or truth.docking_error is None:
        return Condition(says, met=False, figure="not docked")
    error, turned = truth.docking_error
    near = error <= one.position and turned <= one.attitude_deg
    away, _ = beside(100.0 * error, 100.0 * one.position, 2)
    angle, _ = beside(turned, one.attitude_deg, 2)
    return Condition(says, near, f"{away} cm, {angle} deg")


def _visit(
    one: Success, state: str, passage: FlightHistory, truth: TruthSummary | None
) -> Condition:
    span = passage.spans.get(state)
    says = f"{state} visited"
    if one.target is not None:
        says += f", within {one.position:g} m and {one.yaw_deg:g} deg of {one.target}"
    if span is None:
        return Condition(says, met=False, figure="never", never=state)
    at = f"at {span[0]:.1f} s"
    if one.target is None or truth is None:
        return Condition(says, met=True, figure=at)
    missed = truth.visits.get(state)
    if missed is None:
        return Condition(says, met=False, figure=f"no marker of {one.target} in the world")
    error, turned = missed
    near = error <= one.position and (turned is None or turned <= one.yaw_deg)
    measured = f"{at}, {beside(error, one.position, 3)[0]} m"
    if turned is not None:
        measured += f", {beside(turned, one.yaw_deg, 1)[0]} deg"
    return Condition(says, near, measured)
