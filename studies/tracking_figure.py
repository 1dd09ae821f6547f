"""The picture of P4's Fig. 5: heading, mode and place in the image, by IMM and by MMAE."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from missionkit.estimation.target_tracking.multiple_models import Estimator
from missionkit.recorder.palette import INK
from studies.canvas import LIMIT, page
from studies.tracking_flight import SPINS_AT, TURNS, UPRIGHT, Followed
from studies.tracking_scene import ROBOT

COLOURS: Mapping[Estimator, str] = {"imm": "#0072B2", "mmae": "#E69F00"}
NAMES = {"imm": "IMM", "mmae": "MMAE, as P4"}


def draw(path: Path, runs: Mapping[Estimator, Followed], subtitle: str) -> None:
    """Draw a PNG of 1200 x 1100 px.

    Args:
        path: of the picture.
        runs: by estimator.
        subtitle: the result in one line.
    """
    with page(path, 1200, 1100, "One robot, followed as in P4's Fig. 5", subtitle) as figure:
        grid = figure.add_gridspec(4, 1, hspace=0.28, left=0.08, right=0.97, top=0.9, bottom=0.06)
        panels = [figure.add_subplot(grid[row, 0]) for row in range(4)]
        for axes in panels:
            _shade(axes)
            axes.set_xlim(0.0, 60.0)
            axes.grid(visible=True)
        heading, spin, error, pixels = panels
        first = next(iter(runs.values()))
        heading.plot(first.times, np.degrees(first.heading), color=INK, lw=3.0, label="truth")
        for name, run in runs.items():
            colour, label = COLOURS[name], NAMES[name]
            near = run.heading + _wrapped(run.estimate - run.heading)
            heading.plot(run.times, np.degrees(near), color=colour, lw=1.5, label=label)
            spin.plot(run.times, run.spin, color=colour, lw=1.5, label=label)
            error.plot(run.times, 100.0 * run.error, color=colour, lw=1.2, label=label)
            pixels.plot(run.times, np.hypot(*run.pixels.T), color=colour, lw=1.5, label=label)
        heading.set_ylabel("heading, deg")
        spin.set_ylabel("probability of a spin")
        error.set_ylabel("position error, cm")
        error.set_ylim(0.0, 20.0)
        pixels.set_ylabel("robot from the middle, px")
        pixels.axhline(UPRIGHT, color=LIMIT, lw=1.6)
        pixels.set_ylim(0.0, 130.0)
        pixels.set_xlabel("time, s; found at 5 s; grey: turns and the spin")
        heading.legend(frameon=False, loc="upper left", ncols=3)


def _wrapped(angles: np.ndarray) -> np.ndarray:
    return np.asarray((angles + np.pi) % (2.0 * np.pi) - np.pi)


def _shade(axes: Axes) -> None:
    for start, end, _ in (*TURNS, (SPINS_AT, SPINS_AT + ROBOT.spin_time, 0.0)):
        axes.axvspan(start, end, color="0.9", zorder=0)
