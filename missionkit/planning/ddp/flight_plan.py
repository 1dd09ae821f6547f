"""From a flight and a state to a plan that keeps its distances, at every step of a horizon.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math

import numpy as np

from missionkit.geometry import Mat
from missionkit.planning.ddp.point_mass import Flight
from missionkit.planning.ddp.solver import SETTINGS, Plan, Settings, replan, solve

ASIDE = 0.5  # of the acceleration, in a swerve
STIFFER = (0, 2, 3)  # weights that are left out, so that the penalty does not undo a swerve
KEPT = 0.03  # m and m/s, violation that a penalty may leave


def plan_flight(
    flight: Flight,
    state: Mat,
    last: Plan | None = None,
    flown: int = 0,
    settings: Settings = SETTINGS,
) -> Plan:
    """Return a plan that keeps the limits and the distances, if the search finds one (`kept`).

    It begins with the last plan, if there is one, or else at rest. Round obstacles an optimum
    depends on the side from which the search begins, and straight at the middle of one there may be
    none: if something is violated, it also begins with a swerve to either side, and then with
    swerves that a light penalty cannot undo. The best of all that were tried is returned.

    Args:
        flight: target, limits, obstacles.
        state: (6,), m and m/s.
        last: the plan before, of the same horizon.
        flown: steps of it that have been flown.
        settings: of the solver.

    Raises:
        ValueError: of the flight's numbers; `NoPlanError` if the state is not finite.
    """
    if last is not None:
        plan = replan(flight.problem(), state, last, flown, settings)
        if kept(plan):
            return plan
    found = [attempted(flight, state, 0, settings)]
    for attempt in range(1, attempts(flight), 2):
        if any(map(kept, found)):
            break
        found += (attempted(flight, state, each, settings) for each in (attempt, attempt + 1))
    return min(found, key=lambda plan: (not kept(plan), plan.cost))


def attempts(flight: Flight) -> int:
    """Return how many attempts a search for a plan has; without obstacles one is enough."""
    return 1 + 2 * len(STIFFER) if flight.obstacles else 1


def attempted(flight: Flight, state: Mat, attempt: int, settings: Settings = SETTINGS) -> Plan:
    """Return what one attempt of a search finds, which may keep the distances or not.

    Args:
        flight: target, limits, obstacles.
        state: (6,), m and m/s.
        attempt: 0 begins at rest, the others with swerves to either side.
        settings: of the solver.

    Raises:
        ValueError: of the flight's numbers; `NoPlanError` if the state is not finite.
    """
    if attempt == 0:
        return solve(flight.problem(), state, np.zeros((flight.horizon.steps, 3)), settings)
    skipped = STIFFER[(attempt - 1) // 2]
    how = settings._replace(weights=settings.weights[skipped:] or settings.weights)
    guess = swerve(flight, state, 1.0 if attempt % 2 else -1.0)
    return solve(flight.problem(), state, guess, how)


def kept(plan: Plan) -> bool:
    """Say whether a plan keeps the limits and distances, but for what a penalty leaves."""
    return plan.violation <= KEPT


def swerve(flight: Flight, state: Mat, side: float) -> Mat:
    """Return controls (N, 3) that lead off the straight way to the target and back to it.

    Args:
        flight: whose target is straight ahead.
        state: (6,), m and m/s.
        side: 1 to the right, -1 to the left.
    """
    north, east = (np.atleast_2d(flight.target)[-1] - state)[:2].tolist()
    gap, steps = math.hypot(north, east), flight.horizon.steps
    across = (-east / gap, north / gap) if gap > 0.0 else (0.0, 1.0)
    quarter = (4 * np.arange(steps)) // steps
    sign = np.where((quarter == 0) | (quarter == 3), side, -side)
    controls = np.zeros((steps, 3))
    controls[:, :2] = ASIDE * flight.limits.acceleration * sign[:, None] * np.array(across)
    return controls
