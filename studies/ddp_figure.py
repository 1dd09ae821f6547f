"""The picture of the plans: past obstacles that move, and how the costs fall."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from benchmarks.ddp import cases
from missionkit.planning.ddp.flight_plan import plan_flight
from missionkit.planning.ddp.point_mass import Flight, Obstacle
from missionkit.planning.ddp.problem import Problem, Trajectory
from missionkit.planning.ddp.solver import SETTINGS, Descent, begun, descend, policy_around
from missionkit.recorder.palette import INK, STATE_COLOURS
from studies.canvas import page

OBSTACLES = (Obstacle((2.0, -0.6), (0.0, 0.35), 0.6), Obstacle((4.2, 1.0), (0.0, -0.3), 0.6))
TARGET = np.array([6.5, 0.3, -1.0, 0.0, 0.0, 0.0])
WEIGHT = SETTINGS.weights[-1]


def draw(path: Path, seed: int) -> None:
    """Draw plans and costs into a PNG."""
    says = "40 steps of 0.1 s, 2.13 m/s, 3.05 m/s²"
    with page(path, 1500, 640, "Plans by differential dynamic programming", says) as figure:
        _plans(figure.add_axes((0.045, 0.12, 0.5, 0.68)))
        _costs(figure.add_axes((0.62, 0.12, 0.365, 0.68)), seed)


def _plans(axes: Axes) -> None:
    axes.set_title("plans past two obstacles that move, seen from above", pad=10)
    state, obstacles, plan = np.zeros(6), OBSTACLES, None
    for turn in range(6):
        flight = Flight(TARGET, obstacles=obstacles)
        plan = plan_flight(flight, state, plan, 5)
        colour, ahead = STATE_COLOURS[turn % len(STATE_COLOURS)], plan.states
        axes.plot(ahead[:, 0], ahead[:, 1], color=colour, lw=1.4, label=f"{0.5 * turn:g} s")
        axes.plot(ahead[0, 0], ahead[0, 1], "o", color=colour, ms=5)
        for it in obstacles:
            axes.add_patch(Circle(it.place, it.radius, fill=False, color=colour, lw=1.0))
        state = plan.states[5]
        obstacles = tuple(
            it._replace(place=(it.place[0], it.place[1] + 0.5 * it.velocity[1])) for it in obstacles
        )
    axes.plot(TARGET[0], TARGET[1], "x", color=INK, ms=9)
    axes.set_aspect("equal")
    axes.set_xlim(-0.3, 7.2)
    axes.set_ylim(-1.8, 2.6)
    axes.set_xlabel("north, m")
    axes.set_ylabel("east, m")
    axes.legend(loc="upper left", frameon=False, title="planned at", ncols=2)


def _costs(axes: Axes, seed: int) -> None:
    axes.set_title("cost at weight 1e4, by backward passes", pad=10)
    case = next(iter(cases(1, seed)))
    problem, still = case.flight.problem(), np.zeros((40, 3))
    start = begun(problem, case.state, still)
    lines = {
        "weights 1 to 1e4": _continued(problem, start, SETTINGS.weights),
        "weight 1e4 alone": _continued(problem, start, (WEIGHT,)),
        "the paper's fixed rate": _fixed(problem, start),
    }
    least = min(min(costs) for costs in lines.values())
    for (name, costs), colour in zip(
        lines.items(), (STATE_COLOURS[0], STATE_COLOURS[1], STATE_COLOURS[4]), strict=True
    ):
        axes.semilogy(np.array(costs) - least + 1e-4, color=colour, lw=1.6, label=name)
    axes.set_xlabel("backward passes")
    axes.set_ylabel("cost less the least, +1e-4")
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.legend(loc="upper right", frameon=False)


def _continued(problem: Problem, start: Trajectory, weights: tuple[float, ...]) -> list[float]:
    """Return the cost at the last weight after each step of Newton."""
    at, costs = start, [problem.value(start, WEIGHT)]
    for weight in weights:
        tolerance = SETTINGS.tolerance if weight == WEIGHT else SETTINGS.coarse
        found = Descent(at, 0.0)
        while not found.converged and len(costs) < SETTINGS.iterations:
            found = descend(problem, found.at, weight, tolerance, 1)
            costs.append(problem.value(found.at, WEIGHT))
        at = found.at
    return costs


def _fixed(problem: Problem, start: Trajectory) -> list[float]:
    at, costs = start, [problem.value(start, WEIGHT)]
    for _ in range(40):
        policy, _, _ = policy_around(problem, at, WEIGHT, 0.0)
        at = problem.dynamics.roll_out(at, policy, 0.8)
        costs.append(problem.value(at, WEIGHT))
    return costs
