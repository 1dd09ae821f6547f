"""Differential dynamic programming (P4, IV): `python -m studies.ddp`."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterable, Iterator
from pathlib import Path
from statistics import median
from typing import NamedTuple

import numpy as np

from benchmarks import ddp as benchmark
from missionkit.behaviors.receding_horizon import Course, renewed
from missionkit.planning.ddp.flight_plan import kept, plan_flight
from missionkit.planning.ddp.point_mass import Flight, Obstacle
from missionkit.planning.ddp.solver import SETTINGS, Plan, best_of_rollouts, solve
from studies.ddp_figure import draw
from studies.markdown import table
from studies.statistics import wilson

AHEAD = np.array([5.0, 0.0, -1.0, 0.0, 0.0, 0.0])
COUNTS = (1, 2, 3, 5)  # obstacles of a field
HEADER = (
    *("obstacles", "straight", "with swerves", "p50, ms", "p90, ms", "p99, ms"),
    "longest tick, ms",
)
PAGE = """# Study: receding-horizon differential dynamic programming (P4, IV)

P4 plans landings by differential dynamic programming (DDP): a vehicle with position, velocity and
commanded acceleration, limits of 2.13 m/s and 3.05 m/s² kept by an exterior quadratic penalty, a
fixed rate of 0.8 and the best of 40 rollouts. `missionkit/planning/ddp` has the same with a line
search, regularisation of Q_uu and a penalty that grows from 1 to 1e4, for any dynamics, cost and
penalty; and the paper's form beside it.

    {command}

## Beside others

{benchmark}

{note}

crocoddyl's models in C++ know boxes and no balls, so its problem is an easier one and its cost
lower; its time is what compares.

## The penalty

{flights} flights of the same kind, seed {first}, without obstacles. Cost: against the
continued penalty's, median and most. Steps: backward passes, median and most.

{penalty}

A stiff penalty from a cold start does not stall with a line search, it crawls. The paper's form has
no line search: some trajectories of its 40 are good, and where the limits matter most none is.

## Obstacles

{fields} fields each of so many obstacles of 0.4 to 0.7 m radius, which move at some 0.2 m/s and
begin 1.2 to 4 m ahead, within 1.2 m to either side; in one field of four one is straight ahead.
Target 5 m ahead, from rest. A plan counts that keeps all distances and limits to 0.03. Straight:
the search begins at rest only; with swerves: as `plan_flight` does. Processor time of the latter.
Longest tick: in flight one attempt is made at each tick, up to 7 for a first plan.
{obstacles}

![plans](ddp.png)

A whole search in a crowded field can take longer than a tick of 50 ms. In flight its attempts are
spread over ticks, and what is left of the last plan is flown meanwhile if it is clear for a second.

Left: a plan past two obstacles that move, and the plans that followed, one every 0.5 s; circles
show where the obstacles are then. Right: how the cost falls in the flight of seed {seed}.

What a plan does not know: what happens between two steps (a distance may be s²/(8 r) less, 1.4 cm
at 2.13 m/s and 0.4 m), and that a vehicle lags behind its plan; `ddp_go_to` keeps 0.1 m more for
that.
"""


class Field(NamedTuple):
    """What the searches found in one field."""

    straight: bool
    swerving: bool
    took: float  # s
    longest: float  # s, of one attempt, which is what a behaviour does in a tick


def penalty(flights: int, first: int) -> str:
    """Return the table of ways to keep the limits."""
    ways = {
        "weights 1 to 1e4": [],
        "weight 1e4 alone": [],
        "the paper's form, weight 1e4": [],
        "the paper's form, weight 100": [],
    }
    stiff = SETTINGS._replace(weights=SETTINGS.weights[-1:])
    for case in benchmark.cases(flights, first):
        problem, state, still = case.flight.problem(), case.state, np.zeros((40, 3))
        found = (
            case.first,
            solve(problem, state, still, stiff),
            best_of_rollouts(problem, state, still),
            best_of_rollouts(problem, state, still, weight=100.0),
        )
        for plans, plan in zip(ways.values(), found, strict=True):
            plans.append(plan)
    own = ways["weights 1 to 1e4"]
    return table(
        ("penalty", "cost, median", "cost, most", "violation, most", "steps"),
        [(name, *_summary(plans, own)) for name, plans in ways.items()],
    )


def _summary(plans: list[Plan], own: list[Plan]) -> tuple[str, ...]:
    more = [100.0 * (plan.cost / best.cost - 1.0) for plan, best in zip(plans, own, strict=True)]
    steps = [plan.iterations for plan in plans]
    return (
        f"{median(more):+.2f} %",
        f"{max(more):+.2f} %",
        f"{max(plan.violation for plan in plans):.4f}",
        f"{median(steps):.0f}, {max(steps)}",
    )


def obstacles(fields: int, first: int) -> str:
    """Return the table of random fields."""
    rows = []
    for count in COUNTS:
        rng = np.random.default_rng((first, count))
        found = [_searched(field(rng, count, turn)) for turn in range(fields)]
        times = np.array([1e3 * each.took for each in found])
        parts = []
        for hits in (sum(it.straight for it in found), sum(it.swerving for it in found)):
            low, high = (100.0 * share for share in wilson(hits, fields))
            parts.append(f"{hits} of {fields} ({low:.1f} to {high:.1f} %)")
        tick = f"{1e3 * max(it.longest for it in found):.1f}"
        quantiles = (f"{np.percentile(times, q):.1f}" for q in (50, 90, 99))
        rows.append((str(count), *parts, *quantiles, tick))
    return table(HEADER, rows)


def field(rng: np.random.Generator, count: int, turn: int) -> Flight:
    """Return a flight among random obstacles."""
    places = rng.uniform((1.2, -1.2), (4.0, 1.2), (count, 2))
    if turn % 4 == 0:
        places[0, 1] = 0.0
    speeds, radii = 0.2 * rng.normal(size=(count, 2)), rng.uniform(0.4, 0.7, count)
    return Flight(
        AHEAD,
        obstacles=tuple(
            Obstacle((p[0], p[1]), (v[0], v[1]), r)
            for p, v, r in zip(places.tolist(), speeds.tolist(), radii.tolist(), strict=True)
        ),
    )


def _searched(flight: Flight) -> Field:
    straight = solve(flight.problem(), np.zeros(6), np.zeros((40, 3)))
    began = time.process_time()
    plan = plan_flight(flight, np.zeros(6))
    took = time.process_time() - began
    return Field(kept(straight), kept(plan), took, max(_ticks(flight)))


def _ticks(flight: Flight) -> Iterator[float]:
    """Yield how long (s) each tick of a first plan takes in flight."""
    course = Course()
    while course.plan is None and not course.failed:
        began = time.process_time()
        course = renewed(course, 0.0, flight, np.zeros(6), 0)
        yield time.process_time() - began


def main(arguments: Iterable[str] | None = None) -> None:
    """Plan all flights, and write the page and its picture."""
    parser = argparse.ArgumentParser(prog="python -m studies.ddp", description=main.__doc__)
    parser.add_argument("--flights", type=int, default=300)
    parser.add_argument("--fields", type=int, default=200)
    parser.add_argument("--first", type=int, default=700, help="seed")
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    options = parser.parse_args(None if arguments is None else list(arguments))
    (measured,) = benchmark.tables()
    settings = f"--flights {options.flights} --fields {options.fields} --first {options.first}"
    text = PAGE.format(
        command=f"python -m studies.ddp {settings}",
        benchmark=table(measured.header, measured.rows),
        note=measured.note,
        flights=options.flights,
        first=options.first,
        penalty=penalty(options.flights, options.first),
        fields=options.fields,
        obstacles=obstacles(options.fields, options.first),
        seed=options.first,
    )
    options.out.mkdir(parents=True, exist_ok=True)
    (options.out / "ddp.md").write_text(text, encoding="utf-8")
    draw(options.out / "ddp.png", options.first)
    sys.stdout.write(text)


if __name__ == "__main__":
    main()
