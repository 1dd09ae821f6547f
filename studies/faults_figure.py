"""The picture of the faults: the outcome of each, at each moment."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.patches import Patch

from missionkit.recorder.palette import INK
from studies.canvas import page
from studies.flight import Outcome, Run

SHADES = {
    Outcome.FINISHED: "#009E73",
    Outcome.UNFINISHED: "#8FD1BD",
    Outcome.SAFE: "#9FC6E7",
    Outcome.HURT: "#D55E00",
}
PALE = (Outcome.UNFINISHED, Outcome.SAFE)
Cells = Mapping[tuple[str, str], Sequence[Run]]


def draw_faults(path: Path, cells: Cells, subtitle: str) -> None:
    """Draw one bar per fault (rows) and moment (columns) into a PNG 1200 px wide.

    Args:
        path: of the picture.
        cells: flights by fault and by the moment it began.
        subtitle: the result in one line.
    """
    names = list(dict.fromkeys(name for name, _ in cells))
    moments = list(dict.fromkeys(moment for _, moment in cells))
    height = 190 + 50 * len(names)
    with page(path, 1200, height, "Faults that stay", subtitle) as figure:
        axes = figure.add_axes((0.16, 55 / height, 0.81, 1.0 - 195 / height))
        for (name, moment), runs in cells.items():
            _bar(axes, moments.index(moment), names.index(name), runs)
        axes.set_xlim(-0.5, len(moments) - 0.5)
        axes.set_ylim(len(names) - 0.4, -0.6)
        axes.set_xticks(range(len(moments)), moments, color=INK)
        axes.set_yticks(range(len(names)), names, color=INK)
        axes.tick_params(length=0, top=True, labeltop=True, bottom=False, labelbottom=False)
        axes.spines[:].set_visible(False)
        axes.set_xlabel("when the fault begins, and stays to the end", labelpad=10)
        handles = [Patch(color=shade, label=str(outcome)) for outcome, shade in SHADES.items()]
        figure.legend(
            handles=handles,
            loc="upper left",
            bbox_to_anchor=(0.03, 1.0 - 88 / height),
            ncols=4,
            frameon=False,
            borderpad=0.0,
            handlelength=1.0,
            handleheight=1.0,
            fontsize=11.5,
        )


def _bar(axes: Axes, column: int, row: int, runs: Sequence[Run]) -> None:
    left, width = column - 0.45, 0.9 / max(len(runs), 1)
    for outcome, shade in SHADES.items():
        count = sum(run.outcome is outcome for run in runs)
        if not count:
            continue
        axes.barh(row, count * width, 0.68, left, color=shade, edgecolor="white", lw=1.5)
        colour = INK if outcome in PALE else "white"
        middle = left + 0.5 * count * width
        axes.text(
            middle, row, str(count), ha="center", va="center", color=colour, fontweight="bold"
        )
        left += count * width
