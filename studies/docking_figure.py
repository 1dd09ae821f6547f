"""The pictures of the docking study: P3's figures 5 (paths) and 6 (switching distances)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from missionkit.docking_geometry import Berth
from missionkit.recorder.palette import INK, STATE_COLOURS
from missionkit.sim.free_flyer.world import FreeFlyerWorld
from studies.canvas import empty, limit, page
from studies.docking_flight import RULES, Docking

COLOURS = dict(
    zip(
        RULES, (STATE_COLOURS[1], STATE_COLOURS[4], STATE_COLOURS[2], STATE_COLOURS[0]), strict=True
    )
)
NAMES = {
    "fixed": "fixed distances",
    "markov_printed": "Algorithm 1 as printed",
    "markov_safe": "Algorithm 1, kept out",
    "ours": "ours",
}
SHOWN = 40  # paths of each rule at most
NEAR = 0.9  # m, in front of the target, that is drawn


def draw_paths(path: Path, runs: Sequence[Docking], world: FreeFlyerWorld) -> None:
    """Draw how each rule flies, over the distance along and from the docking axis (figure 5)."""
    counted = min(SHOWN, *(sum(run.order.rule == rule for run in runs) for rule in RULES))
    subtitle = (
        f"the last metre of {counted} flights a rule, the same seeds; the spheres touch within the "
        "dashed line"
    )
    with page(path, 1500, 520, "Docking: the paths", subtitle) as figure:
        for n, rule in enumerate(RULES):
            axes = figure.add_axes((0.05 + 0.24 * n, 0.13, 0.215, 0.63))
            axes.set_title(NAMES[rule], pad=8)
            _target(axes, world)
            mine = [run for run in runs if run.order.rule == rule]
            for run in mine[:SHOWN]:
                beside, ahead = _seen(run, world.berth, np.array(world.target.position))
                axes.plot(beside, ahead, color=COLOURS[rule], lw=0.9, alpha=0.5)
            axes.set_xlim(-0.12, NEAR)
            axes.set_ylim(-0.12, NEAR)
            axes.set_aspect("equal")
            axes.set_xlabel("from the docking axis, m")
            if n == 0:
                axes.set_ylabel("before the target's centre, m")


def _seen(run: Docking, berth: Berth, target: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return distances from the docking axis and along it, (N,) each, m."""
    away = np.array(run.path) - target
    along = away @ berth.normal
    return np.linalg.norm(away - np.outer(along, berth.normal), axis=1), along


def _target(axes: Axes, world: FreeFlyerWorld) -> None:
    half, cone = 0.5 * world.target.size, world.cone
    axes.fill([-half, half, half, -half], [-half, -half, half, half], color=INK, alpha=0.25)
    axes.add_patch(Circle((0.0, 0.0), world.touching, fill=False, ls="--", lw=1.2, color=INK))
    dock = half + 0.5 * world.vehicle.size
    far = dock + cone.length
    wide = cone.radius + cone.slope * cone.length
    axes.plot([cone.radius, wide], [dock, far], color=INK, lw=0.9, ls=":")


def draw_distances(path: Path, runs: Sequence[Docking], touching: float) -> None:
    """Draw the distances at which Algorithm 1 switched (figure 6)."""
    subtitle = (
        "true distance from the target's centre as it began to turn (r2) and to come round (r1)"
    )
    with page(path, 1500, 480, "Docking: the switching distances of Algorithm 1", subtitle) as it:
        left = it.add_axes((0.05, 0.15, 0.43, 0.6))
        right = it.add_axes((0.545, 0.15, 0.43, 0.6))
        _histogram(left, runs, "aligned", "r1, m", (0.1, 0.32))
        limit(left, touching, "spheres touch", ha="left")
        _histogram(right, runs, "turned", "r2, m: both of Algorithm 1 alike", (0.55, 0.85))
        right.legend(frameon=False, loc="upper left")


def _histogram(
    axes: Axes, runs: Sequence[Docking], what: str, name: str, span: tuple[float, float]
) -> None:
    bins = np.linspace(*span, 56)
    drawn = False
    for rule in ("fixed", "markov_safe", "markov_printed"):
        values = [getattr(run, what) for run in runs if run.order.rule == rule]
        values = [value for value in values if not math.isnan(value)]
        if values:
            drawn = True
            axes.hist(
                np.clip(values, *span), bins, color=COLOURS[rule], alpha=0.65, label=NAMES[rule]
            )
    if not drawn:
        empty(axes, "no flights")
        return
    axes.set_xlabel(name)
    axes.set_ylabel("flights")
    axes.set_xlim(*span)
