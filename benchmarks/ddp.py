"""One flight of a point, planned by differential dynamic programming and by others, in one run."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from statistics import median
from typing import NamedTuple

import numpy as np

from benchmarks.measure import Table, installed, seconds, spread, version_of
from missionkit.geometry import Mat
from missionkit.planning.ddp.point_mass import Flight, Horizon
from missionkit.planning.ddp.problem import Trajectory
from missionkit.planning.ddp.solver import Plan, best_of_rollouts, replan, solve

SEED, FLIGHTS, WARM_UP = 41, 300, 3
NOISE = 0.02  # m and m/s, of the state after a step that was planned


class Case(NamedTuple):
    """A flight, where it begins, and where it stands a step of the first plan later."""

    flight: Flight
    state: Mat
    first: Plan
    moved: Mat


class Planned(NamedTuple):
    """What one solver found for one flight."""

    took: float  # s
    cost: float
    violation: float  # m/s or m/s²


Solver = Callable[[Case], Callable[[], Mat]]


def cases(count: int, seed: int) -> Iterable[Case]:
    """Return flights to places 0.5 to 8 m away in any direction, from up to 2 m/s."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        way, velocity = rng.normal(size=(2, 3))
        way *= rng.uniform(0.5, 8.0) / np.linalg.norm(way)
        velocity *= rng.uniform(0.0, 2.0) / np.linalg.norm(velocity)
        flight = Flight(np.concatenate([way, np.zeros(3)]))
        state = np.concatenate([np.zeros(3), velocity])
        first = solve(flight.problem(), state, _still(flight))
        yield Case(flight, state, first, first.states[1] + NOISE * rng.normal(size=6))


def _still(flight: Flight) -> Mat:
    return np.zeros((flight.horizon.steps, 3))


def _cold(case: Case) -> Callable[[], Mat]:
    return lambda: solve(case.flight.problem(), case.state, _still(case.flight)).controls


def _warm(case: Case) -> Callable[[], Mat]:
    return lambda: replan(case.flight.problem(), case.moved, case.first).controls


def _paper(case: Case) -> Callable[[], Mat]:
    return lambda: best_of_rollouts(case.flight.problem(), case.state, _still(case.flight)).controls


def _clarabel(case: Case) -> Callable[[], Mat]:
    return _cone_program(case.flight, case.state)


def _clarabel_moved(case: Case) -> Callable[[], Mat]:
    return _cone_program(case.flight, case.moved)


def _cone_program(flight: Flight, state: Mat) -> Callable[[], Mat]:
    """Return the exact solver: a second-order cone program over states and controls, sparse."""
    import clarabel  # noqa: PLC0415
    from scipy import sparse  # noqa: PLC0415

    steps, target, problem = flight.horizon.steps, flight.target, flight.problem()
    at = Trajectory(np.tile(target, (steps + 1, 1)), _still(flight))
    hessians = problem.cost.expand(at)
    weights = np.diagonal(hessians.xx[1:], axis1=1, axis2=2)
    P = sparse.diags(
        np.concatenate([weights.ravel(), np.diagonal(hessians.uu, axis1=1, axis2=2).ravel()])
    ).tocsc()
    q = np.concatenate([-(weights * target).ravel(), np.zeros(3 * steps)])
    f = problem.dynamics.derivatives(at)
    A, B = f.by_state[0], f.by_control[0]
    each, none = sparse.eye(steps), sparse.csc_matrix
    moves = sparse.hstack(
        [sparse.eye(6 * steps) - sparse.kron(sparse.eye(steps, k=-1), A), -sparse.kron(each, B)]
    )
    speed = np.vstack([np.zeros((1, 6)), np.eye(6)[3:]])
    push = np.vstack([np.zeros((1, 3)), np.eye(3)])
    fast = sparse.hstack([-sparse.kron(each, speed), none((4 * steps, 3 * steps))])
    hard = sparse.hstack([none((4 * steps, 6 * steps)), -sparse.kron(each, push)])
    G = sparse.vstack([moves, fast, hard]).tocsc()
    begun = np.zeros(6 * steps)
    begun[:6] = A @ state
    limits = [np.tile([limit, 0.0, 0.0, 0.0], steps) for limit in flight.limits]
    h = np.concatenate([begun, *limits])
    cones = [clarabel.ZeroConeT(6 * steps), *[clarabel.SecondOrderConeT(4)] * (2 * steps)]
    settings = clarabel.DefaultSettings()
    settings.verbose = False

    def run() -> Mat:
        found = clarabel.DefaultSolver(P, q, G, h, cones, settings).solve()
        return np.array(found.x)[6 * steps :].reshape(steps, 3)

    return run


def _crocoddyl(case: Case) -> Callable[[], Mat]:
    from benchmarks.peers.crocoddyl_flight import prepared  # noqa: PLC0415

    return prepared(case.flight, case.state)


class Entry(NamedTuple):
    """One solver, what it is compared with, and how it works."""

    name: str
    package: str
    prepare: Solver
    moved: bool  # it begins where the first plan leads
    how: str


ENTRIES = (
    Entry("missionkit, cold", "missionkit", _cold, moved=False, how="weights 1 to 1e4, from rest"),
    Entry(
        "missionkit, warm", "missionkit", _warm, moved=True, how="one step later, weights from 10"
    ),
    Entry(
        "the paper's form",
        "missionkit",
        _paper,
        moved=False,
        how="rate 0.8, best of 40, weight 1e4",
    ),
    Entry("clarabel", "clarabel", _clarabel, moved=False, how="exact cone program, matrices ready"),
    Entry(
        "clarabel, moved", "clarabel", _clarabel_moved, moved=True, how="the same one step later"
    ),
    Entry(
        "crocoddyl",
        "crocoddyl",
        _crocoddyl,
        moved=False,
        how="`SolverFDDP`, models in C++, boxes for balls: easier; one thread",
    ),
)


def tables() -> list[Table]:
    """Plan the same flights with everything that is installed, in turns."""
    entries = [entry for entry in ENTRIES if installed(entry.name, entry.package)]
    found: dict[str, list[Planned]] = {entry.name: [] for entry in entries}
    for case in cases(FLIGHTS + WARM_UP, SEED):
        for entry in entries:
            found[entry.name].append(_planned(entry, case))
    kept = {name: plans[WARM_UP:] for name, plans in found.items()}
    exact = {moved: kept.get("clarabel, moved" if moved else "clarabel") for moved in (False, True)}
    rows = [_row(entry, kept, exact[entry.moved]) for entry in entries]
    how = "\n".join(f"- {entry.name}{version_of(entry.package)}: {entry.how}." for entry in entries)
    horizon = Horizon()
    note = (
        f"{FLIGHTS} flights, seed {SEED}: targets 0.5 to 8 m away in any direction, starts at up "
        f"to 2 m/s; {horizon.steps} steps of {horizon.dt} s, 2.13 m/s, 3.05 m/s². Processor time, "
        "all in turns. x: medians, in times missionkit's cold one. Cost: against clarabel's for "
        "the same start. Violation: of a limit, m/s or m/s², by the controls rolled out.\n\n" + how
    )
    header = ("solver", "p50, ms", "p99, ms", "x", "cost, median", "cost, worst", "violation, most")
    return [Table("Flight by differential dynamic programming", header, rows, note)]


def _planned(entry: Entry, case: Case) -> Planned:
    work, controls = entry.prepare(case), []
    took = seconds(lambda: controls.append(work()))
    problem = case.flight.problem()
    at = problem.start(case.moved if entry.moved else case.state, np.ascontiguousarray(controls[0]))
    return Planned(took, problem.cost.value(at), problem.violation(at))


def _row(
    entry: Entry, found: dict[str, list[Planned]], exact: list[Planned] | None
) -> tuple[str, ...]:
    plans = found[entry.name]
    times = [plan.took for plan in plans]
    own = median(plan.took for plan in found[ENTRIES[0].name])
    against = ("", "")  # without clarabel
    if exact is not None:
        more = [plan.cost / best.cost - 1.0 for plan, best in zip(plans, exact, strict=True)]
        median_more, most_more = (100.0 * part for part in (median(more), max(more, key=abs)))
        against = (f"{median_more:+.2f} %", f"{most_more:+.2f} %")
    return (
        entry.name,
        *spread(times, 1e3, 2),
        f"{median(times) / own:.2f}",
        *against,
        f"{max(plan.violation for plan in plans):.4f}",
    )
