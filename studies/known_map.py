"""P2's flight past two walls, its paths and clearances: `python -m studies.known_map`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from string import Template
from typing import cast

import numpy as np
from rich.progress import track

from missionkit.behaviors.follow_path import FollowPath
from missionkit.messages import Occupancy
from missionkit.planning.map_inflation import margin
from missionkit.planning.route_planning import Route, Way, plan
from studies.known_map_figure import CLEARANCE, SHOWN, draw_clearance, draw_paths
from studies.known_map_flight import STATE, VARIANTS, Run, fly_all, mission_of
from studies.markdown import table
from studies.statistics import spread, wilson

TEMPLATE = Path(__file__).with_name("known_map.md")


def planned() -> tuple[Occupancy, float, dict[str, Route]]:
    """Return the map, the margin (m), and each variant's path from the take-off point."""
    routes: dict[str, Route] = {}
    for variant in VARIANTS:
        mission = mission_of(variant)
        use = mission.by_name()[STATE].state.behavior
        if use is None or mission.known is None:
            raise ValueError(f"{STATE!r} of {mission.name} follows no path on a map")
        how = cast(FollowPath, use.plugin)
        wide = margin(how.body + how.clearance, how.map_sd, 0.0, how.sigmas)
        way = Way(wide, how.neighbours, how.heuristic, how.smooth)
        goal = mission.targets["goal"].position
        routes[variant] = plan(mission.known, (0.0, 0.0), (goal[0], goal[1]), way)
    return mission.known, wide, routes


def verdict(routes: Mapping[str, Route], runs: Sequence[Run]) -> str:
    """Return the results in a few lines."""
    lengths = ", ".join(f"{name} {route.length:.2f} m" for name, route in routes.items())
    good = sum(run.succeeded for run in runs)
    clear = sum(run.clearance >= CLEARANCE for run in runs)
    low, high = wilson(clear, len(runs))
    least = min(run.clearance for run in runs)
    return "\n".join(
        (
            f"- Paths: {lengths}.",
            f"- {good} of {len(runs)} flights reached what they took for the goal and landed.",
            f"- {clear} of {len(runs)} kept {CLEARANCE:g} m of every wall in truth "
            f"({100 * low:.1f} to {100 * high:.1f} %); the nearest came to {least:.2f} m.",
        )
    )


def page(
    known: Occupancy, wide: float, routes: Mapping[str, Route], runs: Sequence[Run], command: str
) -> str:
    """Return the page."""
    rows, columns = known.costs.shape
    size = f"{rows * known.resolution:g} m by {columns * known.resolution:g} m"
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        command=command,
        verdict=verdict(routes, runs),
        margin=f"{wide:.2f}",
        shown=min(SHOWN, len(runs) // len(VARIANTS)),
        paths=table(("variant", "length, m", "cost, m", "points"), _paths(routes)),
        flights=table(
            (
                *("variant", "succeeded", "flown, m", "time, s", "plans"),
                *("least clearance, m", "off, m", "missed, m"),
            ),
            _flights(runs),
        ),
        room=size,
    )


def _paths(routes: Mapping[str, Route]) -> Iterator[tuple[str, ...]]:
    for name, route in routes.items():
        yield name, f"{route.length:.2f}", f"{route.cost:.2f}", str(len(route.spots))


def _flights(runs: Sequence[Run]) -> Iterator[tuple[str, ...]]:
    for variant in VARIANTS:
        mine = [run for run in runs if run.variant == variant]
        good = sum(run.succeeded for run in mine)
        most = [_most([getattr(run, key) for run in mine]) for key in ("length", "duration")]
        plans = _most([float(run.plans) for run in mine], 0)
        clear = spread([run.clearance for run in mine])
        last = [_most([getattr(run, key) for run in mine], 2) for key in ("drift", "missed")]
        near = f"{clear.p50:.2f}, {clear.least:.2f}"
        yield variant, f"{good} of {len(mine)}", *most, plans, near, *last


def _most(values: Sequence[float], digits: int = 1) -> str:
    """Say the median and the largest."""
    return f"{np.median(values):.{digits}f}, {max(values):.{digits}f}"


def main(arguments: Sequence[str] | None = None) -> None:
    """Plan with every variant, fly over many seeds, and write up the results."""
    parser = argparse.ArgumentParser(prog="python -m studies.known_map", description=main.__doc__)
    parser.add_argument("--seeds", type=int, default=100, help="of each variant")
    parser.add_argument("--first", type=int, default=0, metavar="SEED")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    chosen = parser.parse_args(arguments)
    seeds = range(chosen.first, chosen.first + chosen.seeds)
    flights = fly_all(seeds, chosen.workers)
    many = chosen.seeds * len(VARIANTS)
    runs = list(track(flights, "flying", many, disable=not sys.stderr.isatty()))
    known, wide, routes = planned()
    command = f"python -m studies.known_map --seeds {chosen.seeds} --first {chosen.first}"
    write(known, wide, routes, runs, chosen.out, command)
    print(verdict(routes, runs))  # noqa: T201


def write(
    known: Occupancy,
    wide: float,
    routes: Mapping[str, Route],
    runs: Sequence[Run],
    out: Path,
    command: str,
) -> None:
    """Write the page and its pictures into the folder `out`."""
    out.mkdir(parents=True, exist_ok=True)
    draw_paths(out / "known_map_paths.png", known, wide, routes, runs)
    draw_clearance(out / "known_map_clearance.png", runs)
    text = page(known, wide, routes, runs, command)
    (out / "known_map.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
