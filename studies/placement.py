"""Where to start and where to put the anchors (P3, V-D): `python -m studies.placement`."""

from __future__ import annotations

import argparse
import itertools
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from string import Template
from typing import NamedTuple

import numpy as np

from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import builtin
from missionkit.docking_geometry import NORMALS
from missionkit.geometry import Mat, conjugate, exp, multiply, norm, rotate, vec
from missionkit.rehearsal.stage import world_of
from missionkit.sim.free_flyer.world import FreeFlyerWorld
from studies.markdown import table
from studies.placement_figure import draw
from studies.placement_model import (
    Grid,
    Layout,
    Outlook,
    grid_of,
    largest_sd,
    outlook,
    worst_sd,
)

MISSION = Path(__file__).parents[1] / "missions" / "docking.yaml"
TEMPLATE = Path(__file__).with_name("placement.md")
BOX = ((-1.0, 0.0, 1.0), (-0.2, 0.0, 0.2), (-0.5, 0.0, 0.5))  # m, where anchors may be
WIDER = 2.0  # the same box, larger
SEED = 13
POSES = 400
ROUNDS = 4  # of the search


class Pose(NamedTuple):
    """A start."""

    place: Mat  # (3,), m
    q: float  # |q_e| against the attitude of a docked vehicle


class Layouts(NamedTuple):
    """Layouts of four anchors by name, and their grids."""

    anchors: Mapping[str, Layout]
    grids: Mapping[str, Grid]


def world() -> FreeFlyerWorld:
    """Return the world of the docking mission."""
    found = world_of(load(MISSION, builtin()), MISSION.parent)
    assert isinstance(found, FreeFlyerWorld)  # noqa: S101 - the mission is that of a free flyer
    return found


def poses(many: int, setting: FreeFlyerWorld) -> list[Pose]:
    """Return random starts: over the anchors' rectangle, 0.6 to 1.2 m high, at any attitude."""
    rng = np.random.default_rng(SEED)
    found = []
    for _ in range(many):
        place = rng.uniform((-1.0, 0.6, -0.5), (1.0, 1.2, 0.5))
        axis = rng.normal(size=3)
        turn = exp(rng.uniform(0.0, np.pi) / norm(axis) * axis)
        q = norm(multiply(conjugate(setting.berth.pose.rotation), turn)[1:])
        found.append(Pose(place, q))
    return found


def corners(scale: float = 1.0) -> list[tuple[float, float, float]]:
    """Return where an anchor may be: corners, edges and middles of the box, times a scale."""
    return [(scale * x, scale * y, scale * z) for x, y, z in itertools.product(*BOX)]


def searched(places: Mat, scale: float) -> Layout:
    """Return the four spots of the box with the least standard deviation, all heard and one lost.

    That is the sum of both means over the places. By exchange: from a random four, each anchor in
    turn moves to the best spot, until none does; the best of several beginnings.
    """
    spots, rng = corners(scale), np.random.default_rng(SEED)

    def worth(chosen: Sequence[int]) -> float:
        anchors = np.array([spots[n] for n in chosen])
        return float((largest_sd(places, anchors) + worst_sd(places, anchors)).mean())

    found = []
    for _ in range(ROUNDS):
        chosen = rng.choice(len(spots), 4, replace=False).tolist()
        best, before = worth(chosen), np.inf
        while best < before:
            before = best
            for k in range(4):
                free = [n for n in range(len(spots)) if n not in chosen or n == chosen[k]]
                tried = {n: worth([*chosen[:k], n, *chosen[k + 1 :]]) for n in free}
                chosen[k] = min(tried, key=tried.__getitem__)
                best = tried[chosen[k]]
        found.append((best, sorted(chosen)))
    return [spots[n] for n in min(found)[1]]


def layouts(setting: FreeFlyerWorld, starts: Sequence[Pose]) -> Layouts:
    """Return the layouts that are compared."""
    paper = [(x, y, z) for x, y, z in setting.anchors.values()]
    target = np.array(setting.target.position)
    way = [pose.place + s * (target - pose.place) for pose in starts[::40] for s in (0.0, 0.5, 0.9)]
    places = np.array(way)
    anchors: dict[str, Layout] = {
        "P3's": paper,
        "other corners of P3's box": [
            (1, -0.2, 0.5),
            (1, 0.2, -0.5),
            (-1, 0.2, 0.5),
            (-1, -0.2, -0.5),
        ],
        "best in P3's box": searched(places, 1.0),
        "P3's, twice as wide": [(WIDER * x, WIDER * y, WIDER * z) for x, y, z in paper],
        "best in a box twice as wide": searched(places, WIDER),
    }
    return Layouts(anchors, {name: grid_of(it) for name, it in anchors.items()})


def outlooks(
    grid: Grid, starts: Sequence[Pose], setting: FreeFlyerWorld
) -> list[tuple[Outlook, Outlook]]:
    """Return the outlook of each start, with all anchors heard and with the worst one lost."""
    target = np.array(setting.target.position)
    axis = rotate(setting.target.pose.rotation, vec(*NORMALS[setting.target.face]))
    return [
        (
            outlook(grid.best, pose.place, pose.q, target, axis),
            outlook(grid.worst, pose.place, pose.q, target, axis),
        )
        for pose in starts
    ]


def measured(grid: Grid, starts: Sequence[Pose], setting: FreeFlyerWorld) -> float:
    """Return how long one outlook takes (ms of processor time), the median of some hundred."""
    target, times = np.array(setting.target.position), []
    for pose in starts:
        began = time.process_time()
        outlook(grid.best, pose.place, pose.q, target, setting.berth.normal)
        times.append(1e3 * (time.process_time() - began))
    return float(np.median(times))


def page(found: Layouts, starts: Sequence[Pose], setting: FreeFlyerWorld, took: float) -> str:
    """Return the page."""
    heads = (
        "layout",
        "sd at the start, mm",
        "sd at r1, mm",
        "one lost, mm",
        "r1, m",
        "one lost, m",
    )
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        took=f"{took:.2f}",
        poses=len(starts),
        layouts=table((*heads, "π at r1", "in view at r1"), _layouts(found, starts, setting)),
        anchors=table(("layout", "anchors, m"), _anchors(found)),
    )


def _layouts(
    found: Layouts, starts: Sequence[Pose], setting: FreeFlyerWorld
) -> Iterator[tuple[str, ...]]:
    places = np.array([pose.place for pose in starts])
    for name, grid in found.grids.items():
        best, worst = zip(*outlooks(grid, starts, setting), strict=True)
        yield (
            name,
            _spread([1e3 * sd for sd in grid.best(places)], 1),
            _spread([1e3 * it.sd for it in best], 1),
            _spread([1e3 * it.sd for it in worst], 1),
            _spread([it.r1 for it in best], 2),
            _spread([it.r1 for it in worst], 2),
            _spread([it.probability for it in best], 2),
            f"{100.0 * np.mean([it.in_view for it in best]):.0f} %",
        )


def _spread(values: Sequence[float], digits: int) -> str:
    low, middle, high = np.percentile(values, (5, 50, 95))
    return f"{middle:.{digits}f} ({low:.{digits}f} to {high:.{digits}f})"


def _anchors(found: Layouts) -> Iterator[tuple[str, str]]:
    for name, anchors in found.anchors.items():
        spots = ", ".join(f"({x:g}, {y:g}, {z:g})" for x, y, z in anchors)
        yield name, spots


def main(arguments: Sequence[str] | None = None) -> None:
    """Compute what Algorithm 1 would do from many starts with several layouts of anchors."""
    parser = argparse.ArgumentParser(prog="python -m studies.placement", description=main.__doc__)
    parser.add_argument("--poses", type=int, default=POSES)
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    given = parser.parse_args(arguments)
    setting = world()
    starts = poses(given.poses, setting)
    found = layouts(setting, starts)
    took = measured(found.grids["P3's"], starts, setting)
    given.out.mkdir(parents=True, exist_ok=True)
    draw(given.out / "placement.png", found.grids, setting)
    text = page(found, starts, setting, took)
    (given.out / "placement.md").write_text(text, encoding="utf-8")
    print(f"{took:.2f} ms a pose")  # noqa: T201


if __name__ == "__main__":
    main()
