"""Numerical stability of the U D Uᵀ filter: `python -m studies.ud_filter`."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterable
from pathlib import Path
from statistics import median

import numba
import numpy as np

from missionkit.geometry import Mat
from studies.markdown import table
from studies.ud_filter_runs import (
    FILTERS,
    RANGED,
    SEEN,
    Filter,
    dyer_mcreynolds,
    exact_covariance,
    flight,
    positions,
)

DELTAS = (1e-2, 1e-3, 3.45e-4, 1e-4, 3e-5, 1e-5)
PRIORS = (1.0, 10.0, 100.0)  # m
SIZES = (27, 45, 75)  # states
REPEATS = 30
PAGE = """# Study: a Kalman filter in single precision (P4, II-B)

P4's navigation filter holds its covariance as P = U D Uᵀ (Bierman's update, Thornton's
prediction) instead of P itself, "to achieve greater numerical stability".
`missionkit/estimation/ud_filter` has the kernels; in double precision they equal the
conventional filter to 1e-9 (`tests/estimation/test_ud_filter.py`). Here they run in single
precision beside P - KHP and Joseph's form (I - KH) P (I - KH)ᵀ + K R Kᵀ.

    {command}

## Two rows that are nearly equal

The example of Dyer and McReynolds: P = I, then h = (1, 1, 1) and (1, 1, 1 + delta), each with
noise delta². Against the covariance in exact fractions: relative error (Frobenius), and the
smallest eigenvalue where it is negative, so that P is no covariance any more.

{nearly}

At delta = 3.45e-4 delta² is just lost beside 1 in single precision.

## A wide prior

{flights} flights of {steps} steps of 0.05 s over six features whose places are known to so many
metres at first: 27 states (position, velocity, bias of the accelerometer, features), {seen} cm
noise on each number of a feature's place and {ranged} cm on the height. The largest distance (cm)
between the position in single and in double precision: median and most of the flights.

{wide}

Joseph's form holds here as well as the factors: what is lost is lost in the subtraction P - KHP.

## What it costs

One prediction and {rows} numbers taken in, microseconds, single precision, all compiled by numba,
medians of {repeats} in turns; x: times P - KHP. Joseph's form multiplies whole matrices, as it is
written.

{costs}

The navigator's whole cycle (`python -m benchmarks features`: 20 features, 75 states, double
precision) takes 0.8 to 1.0 ms of processor time in the median on a busy machine (load 10 to 16),
0.6 ms at best.
"""


def nearly() -> str:
    """Return the table of Dyer and McReynolds' example."""
    rows = []
    for delta in DELTAS:
        exact, cells = exact_covariance(delta), []
        for how in FILTERS.values():
            P = dyer_mcreynolds(how, delta)
            least = np.linalg.eigvalsh(0.5 * (P + P.T)).min()
            error = np.linalg.norm(P - exact) / np.linalg.norm(exact)
            cells.append(f"{error:.1e}" + (f", eigenvalue {least:.1e}" if least < 0.0 else ""))
        rows.append((f"{delta:g}", *cells))
    return table(("delta", *FILTERS), rows)


def wide(flights: int, first: int, steps: int) -> str:
    """Return the table of flights with wide priors."""
    rows = []
    for prior in PRIORS:
        off: dict[str, list[float]] = {name: [] for name in FILTERS}
        for seed in range(first, first + flights):
            flown = flight(seed, steps)
            exact = positions(FILTERS["Joseph"], np.float64, flown, prior)
            for name, how in FILTERS.items():
                gaps = np.linalg.norm(positions(how, np.float32, flown, prior) - exact, axis=1)
                off[name].append(100.0 * float(gaps.max()))
        cells = [f"{median(worst):.2g}, {max(worst):.2g}" for worst in off.values()]
        rows.append((f"{prior:g} m", *cells))
    return table(("prior", *FILTERS), rows)


def fast_update(x: Mat, P: Mat, _: Mat, h: Mat, residual: float, variance: float) -> float:
    """Do what `plain_update` does by numpy's products: faster, and other roundings elsewhere."""
    Ph = np.dot(P, h)
    innovation = np.dot(h, Ph) + variance
    K = Ph / innovation
    x += K * residual
    P -= K.reshape(-1, 1) * Ph
    return innovation


TIMED = {**FILTERS, "P - KHP": FILTERS["P - KHP"]._replace(update=fast_update)}


def costs(rows: int) -> str:
    """Return the table of times."""
    header = ("states", *(f"{name}, us" for name in FILTERS), "U D Uᵀ, x", "Joseph, x")
    return table(header, (_timed(size, rows) for size in SIZES))


def _timed(size: int, rows: int) -> tuple[str, ...]:
    rng = np.random.default_rng(size)
    F = np.eye(size) + np.eye(size, k=3) * 0.05
    G, q = np.eye(size)[:, :9], np.full(9, 1e-4)
    H = np.zeros((rows, size))
    H[:, :3], H[range(rows), rng.integers(9, size, rows)] = -1.0, 1.0
    F, G, q, H = (np.ascontiguousarray(part, np.float32) for part in (F, G, q, H))
    works = {name: _cycle(how, F, G, q, H) for name, how in TIMED.items()}
    times: dict[str, list[float]] = {name: [] for name in FILTERS}
    for _ in range(REPEATS):
        for name, work in works.items():
            began = time.process_time_ns()
            work()
            times[name].append(1e-3 * (time.process_time_ns() - began))
    took = [median(each) for each in times.values()]
    relative = (took[0] / took[1], took[2] / took[1])
    return (str(size), *(f"{each:.0f}" for each in took), *(f"{each:.1f}" for each in relative))


def _cycle(how: Filter, F: Mat, G: Mat, q: Mat, H: Mat):  # noqa: ANN202 - a closure
    one, other = how.begin(np.eye(len(F), dtype=np.float32))
    predict, update = (each if hasattr(each, "py_func") else numba.njit(each) for each in how[1:])
    x, zero, variance = np.zeros(len(F), np.float32), np.float32(0.1), np.float32(1e-4)

    def work() -> None:
        predict(one, other, F, G, q)
        for h in H:
            update(x, one, other, h, zero, variance)

    work()
    return work


def main(arguments: Iterable[str] | None = None) -> None:
    """Run all and write the page."""
    parser = argparse.ArgumentParser(prog="python -m studies.ud_filter", description=main.__doc__)
    parser.add_argument("--flights", type=int, default=20)
    parser.add_argument("--first", type=int, default=100, help="first seed")
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    options = parser.parse_args(None if arguments is None else list(arguments))
    settings = f"--flights {options.flights} --first {options.first} --steps {options.steps}"
    text = PAGE.format(
        command=f"python -m studies.ud_filter {settings}",
        nearly=nearly(),
        flights=options.flights,
        steps=options.steps,
        seen=f"{100 * SEEN:g}",
        ranged=f"{100 * RANGED:g}",
        wide=wide(options.flights, options.first, options.steps),
        rows=40,
        repeats=REPEATS,
        costs=costs(40),
    )
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "ud_filter.md").write_text(text, encoding="utf-8")
    sys.stdout.write(text)


if __name__ == "__main__":
    main()
