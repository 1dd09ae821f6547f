"""The picture of the precision landing: the paths of every rule in one case, and energies."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from matplotlib.axes import Axes

from missionkit.recorder.palette import INK, STATE_COLOURS
from studies.canvas import page
from studies.precision_landing_flight import CASES, RULES, Landing

COLOURS = dict(
    zip(
        RULES, (STATE_COLOURS[0], STATE_COLOURS[1], STATE_COLOURS[4], STATE_COLOURS[2]), strict=True
    )
)
SHOWN = (10.0, 5.0)  # the case whose paths are drawn
WIDTH = 0.18  # of a box


def draw(path: Path, runs: Sequence[Landing], subtitle: str) -> None:
    """Draw paths and energies into a PNG."""
    with page(path, 1500, 640, "Precision landing by four rules", subtitle) as figure:
        left = figure.add_axes((0.045, 0.12, 0.43, 0.68))
        _paths(left, [run for run in runs if run.order.case == SHOWN and run.order.wind == 0.0])
        right = figure.add_axes((0.54, 0.12, 0.445, 0.68))
        _energies(right, runs)


def _paths(axes: Axes, runs: Sequence[Landing]) -> None:
    distance, height = SHOWN
    axes.set_title(f"paths from {distance:g} m away and {height:g} m up, calm air", pad=10)
    for rule, colour in COLOURS.items():
        mine = [run for run in runs if run.order.rule == rule]
        for count, run in enumerate(mine):
            label = rule if count == 0 else None
            axes.plot(*run.path.T, color=colour, lw=1.3, alpha=0.75, label=label)
    axes.plot([-0.3, 0.3], [0.0, 0.0], color=INK, lw=5, solid_capstyle="butt")
    axes.set_xlim(distance + 1.0, -0.6)
    axes.set_ylim(-0.1, height + 0.6)
    axes.set_xlabel("level distance from the pad, m")
    axes.set_ylabel("height, m")
    axes.legend(loc="lower left", frameon=False)


def _energies(axes: Axes, runs: Sequence[Landing]) -> None:
    axes.set_title("energy from the start to touch-down, kJ, calm and in wind", pad=10)
    for place, case in enumerate(CASES):
        for count, (rule, colour) in enumerate(COLOURS.items()):
            energies = [
                1e-3 * run.energy
                for run in runs
                if (run.order.rule, run.order.case) == (rule, case)
            ]
            if not energies:
                continue
            at = place + (count - 1.5) * 1.15 * WIDTH
            axes.boxplot(
                energies,
                positions=[at],
                widths=WIDTH,
                patch_artist=True,
                boxprops={"facecolor": colour, "alpha": 0.7, "edgecolor": INK},
                medianprops={"color": INK},
                flierprops={"marker": ".", "markersize": 4},
            )
    axes.set_xticks(range(len(CASES)), [f"{away:g} m, {up:g} m up" for away, up in CASES])
    axes.set_xlim(-0.6, len(CASES) - 0.4)
    axes.set_ylim(0.0, None)
    axes.grid(visible=True, axis="y", alpha=0.4)
