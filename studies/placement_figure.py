"""The picture of the placement study: how well a place is known, and where Algorithm 1 switches."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from missionkit.recorder.palette import INK
from missionkit.sim.free_flyer.world import FreeFlyerWorld
from studies.canvas import page
from studies.placement_model import Grid, outlook

SHOWN = ("P3's", "P3's, twice as wide", "best in a box twice as wide")
HEIGHT = 1.0  # m, y of the starts that are drawn
Q = 0.866  # |q_e| of P3's start
ROWS = ("largest sd at the start, mm", "r1 by Algorithm 1, m")


def draw(path: Path, grids: Mapping[str, Grid], world: FreeFlyerWorld) -> None:
    """Draw maps over the start's x and z, at y = 1 m, of some layouts."""
    x, z = np.linspace(-1.0, 1.0, 61), np.linspace(-0.5, 0.5, 31)
    places = np.stack(np.meshgrid(x, [HEIGHT], z, indexing="ij"), axis=-1)[:, 0]
    target = np.array(world.target.position)
    maps = (
        [1e3 * grids[name].best(places) for name in SHOWN],
        [_switches(grids[name], places, target, world) for name in SHOWN],
    )
    subtitle = f"starts at y = {HEIGHT:g} m, turned as P3's; white: P3's start"
    with page(path, 1500, 720, "Placement: starts and anchors", subtitle) as figure:
        for row, (name, values) in enumerate(zip(ROWS, maps, strict=True)):
            low, high = np.min(values), np.max(values)
            for column, (layout, each) in enumerate(zip(SHOWN, values, strict=True)):
                box = (0.055 + 0.3 * column, 0.52 - 0.43 * row, 0.26, 0.31)
                axes = figure.add_axes(box)
                drawn = axes.pcolormesh(
                    x, z, each.T, vmin=low, vmax=high, cmap="viridis", shading="gouraud"
                )
                axes.plot(0.0, 0.0, "o", mfc="white", mec=INK, ms=7)
                axes.set_title(f"{layout}: {name}", fontsize=11, pad=6)
                axes.set_xticks(np.linspace(-1.0, 1.0, 5))
                axes.set_xlabel("x, m")
                if column == 0:
                    axes.set_ylabel("z, m")
            bar = figure.add_axes((0.94, 0.52 - 0.43 * row, 0.012, 0.31))
            figure.colorbar(drawn, cax=bar)


def _switches(
    grid: Grid, places: np.ndarray, target: np.ndarray, world: FreeFlyerWorld
) -> np.ndarray:
    """Return r1 (m) of each start."""
    flat = [
        outlook(grid.best, it, Q, target, world.berth.normal).r1 for it in places.reshape(-1, 3)
    ]
    return np.array(flat).reshape(places.shape[:-1])
