"""Pictures of the herding study: how many come home, as P4's Fig. 7, and a run in six moments."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from missionkit.planning.herding import robot_forecast as fc
from missionkit.plugin_protocols import HerdingPolicyProtocol
from missionkit.recorder.palette import INK, MUTED
from missionkit.sim import ground_robots as gr
from studies import herding_kernels as hk
from studies.canvas import LIMIT, page
from studies.herding_kernels import Facts, Scene
from studies.herding_run import LENGTH, TARGETS, Run, run

FATES = {"home": "#0072B2", "removed": "#D55E00", "remained": "#999999"}
MOMENTS = (20.0, 80.0, 160.0, 260.0, 400.0, 600.0)  # s
TRAIL = 20.0  # s
VEHICLE = "#0072B2"


def draw(path: Path, rows: Mapping[str, Sequence[Run]]) -> None:
    """Draw a PNG of 1200 x 800 px: a panel for each row.

    Args:
        path: of the picture.
        rows: runs by the name of their row.
    """
    subtitle = "Runs of ten minutes, ten robots; seven home are a success"
    with page(path, 1200, 800, "Robots home, removed and remained", subtitle) as figure:
        grid = figure.add_gridspec(
            2, 2, hspace=0.35, wspace=0.15, left=0.06, right=0.97, top=0.84, bottom=0.09
        )
        for i, (name, runs) in enumerate(rows.items()):
            axes = figure.add_subplot(grid[i // 2, i % 2])
            for k, (fate, colour) in enumerate(FATES.items()):
                counts = np.bincount([getattr(it, fate) for it in runs], minlength=11) / len(runs)
                axes.bar(np.arange(11) + 0.28 * (k - 1), counts, 0.28, color=colour, label=fate)
            axes.axvline(6.5, color=LIMIT, lw=1.2, ls="--")
            axes.set_xticks(range(11))
            axes.set_ylim(0.0, 1.0)
            axes.set_title(f"{name}: {len(runs)} runs", loc="left", fontsize=12)
            if i == 0:
                axes.legend(frameon=False)
            if i % 2 == 0:
                axes.set_ylabel("share of runs")
            if i // 2 == 1:
                axes.set_xlabel("robots")


class Moment(NamedTuple):
    """A picture of a run."""

    now: float  # s
    vehicle: np.ndarray
    robots: np.ndarray
    fate: np.ndarray


def draw_run(path: Path, seed: int, policy: HerdingPolicyProtocol, facts: Facts) -> None:
    """Draw a PNG of 1200 x 880 px: six moments of a run with a limited sight.

    Args:
        path: of the picture.
        seed: of the run.
        policy: that chooses.
        facts: of vehicle and arena.
    """
    moments: list[Moment] = []

    def watch(now: float, scene: Scene) -> None:
        moments.append(Moment(now, scene.vehicle.copy(), scene.truth.copy(), scene.fate.copy()))

    end = run(seed, policy, facts, watch=watch)
    subtitle = f"seed {seed}: {end.home} home, {end.removed} removed, {end.remained} remained"
    with page(path, 1200, 880, "Ten minutes of herding", subtitle) as figure:
        grid = figure.add_gridspec(
            2, 3, hspace=0.12, wspace=0.05, left=0.02, right=0.98, top=0.86, bottom=0.02
        )
        for i, at in enumerate(MOMENTS):
            axes = figure.add_subplot(grid[i // 3, i % 3])
            now = min(moments, key=lambda it: abs(it.now - min(at, LENGTH)))
            _panel(axes, now, [it for it in moments if now.now - TRAIL < it.now <= now.now], facts)


def _panel(axes: Axes, now: Moment, before: Sequence[Moment], facts: Facts) -> None:
    half = facts.half
    axes.set_xlim(-half - 1.0, half + 1.0)
    axes.set_ylim(-half - 1.0, half + 1.0)
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.plot([-half, -half, half, half], [half, -half, -half, half], color=MUTED, lw=1.0)
    axes.plot([-half, half], [half, half], color="#009E73", lw=3.0)
    home = int((now.fate[:TARGETS] == fc.HOME).sum())
    axes.set_title(f"{now.now:.0f} s: {home} home", fontsize=11, loc="left")
    for i, it in enumerate(now.robots):
        if now.fate[i] != fc.INSIDE:
            continue
        colour = LIMIT if it[gr.OBSTACLE] else INK
        n, e, heading = it[gr.NORTH], it[gr.EAST], it[gr.HEADING]
        trail = np.array([[past.robots[i, gr.EAST], past.robots[i, gr.NORTH]] for past in before])
        axes.plot(*trail.T, color=colour, lw=0.7, alpha=0.4)
        axes.add_patch(Circle((e, n), 0.25, color=colour))
        axes.plot([e, e + 0.9 * math.sin(heading)], [n, n + 0.9 * math.cos(heading)], color=colour)
    path = np.array([[past.vehicle[hk.PY], past.vehicle[hk.PX]] for past in before])
    axes.plot(*path.T, color=VEHICLE, lw=1.2)
    spot = (now.vehicle[hk.PY], now.vehicle[hk.PX])
    axes.add_patch(Circle(spot, min(facts.sight, 2.0 * half), color=VEHICLE, alpha=0.15))
    axes.plot(*spot, marker="x", color=VEHICLE, ms=8, mew=2)
