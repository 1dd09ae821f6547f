"""Page, colours and limits that the pictures of the studies share."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from missionkit.recorder.palette import INK, MUTED
from missionkit.recorder.plot import PLOT_STYLE

DPI = 100
LIMIT = "#B3261E"
HALO: Any = {"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 1.5}


@contextmanager
def page(path: Path, width: int, height: int, title: str, subtitle: str) -> Iterator[Figure]:
    """Open a picture of `width` x `height` px with a heading; save it at the end."""
    with mpl.rc_context(PLOT_STYLE):
        figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI, facecolor="white")
        FigureCanvasAgg(figure)
        left, line = 40.0 / width, 1.0 / height
        figure.text(left, 1.0 - 38.0 * line, title, fontsize=20, fontweight="bold", va="center")
        figure.text(left, 1.0 - 68.0 * line, subtitle, fontsize=12, color=MUTED, va="center")
        yield figure
        figure.savefig(path, format="png", pil_kwargs={"optimize": True})


def limit(axes: Axes, at: float, text: str, *, ha: str = "right") -> None:
    """Draw an upright line that must not be crossed, named near its upper end."""
    axes.axvline(at, color=LIMIT, lw=1.6, zorder=4)
    side = -5.0 if ha == "right" else 5.0
    axes.annotate(
        text,
        (at, 0.97),
        (side, 0.0),
        xycoords=axes.get_xaxis_transform(),
        textcoords="offset points",
        ha=ha,
        va="top",
        color=LIMIT,
        fontsize=10,
        bbox=HALO,
        zorder=5,
    )


def empty(axes: Axes, text: str) -> None:
    """Say why a panel shows nothing."""
    axes.set_axis_off()
    axes.text(0.5, 0.5, text, ha="center", va="center", color=INK, transform=axes.transAxes)
