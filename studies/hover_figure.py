"""The picture of the hovers: how position errors grow, and where they end."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Ellipse

from missionkit.geometry import Mat
from missionkit.recorder.palette import INK, MUTED
from studies.canvas import HALO, page
from studies.hover_flight import ALONE, BIASED, EVERY, P2, PERIOD, WHOLE, Hover

SHOWN = {
    ALONE: ("flow alone", "#D55E00"),
    P2: ("P2's filter", "#E69F00"),
    BIASED: ("gyroscope's bias estimated", "#0072B2"),
    WHOLE: ("EKF with flow", "#009E73"),
}
AXES = ("x (north)", "y (east)")


def draw(
    path: Path, hovers: Sequence[Hover], table: tuple[float, float], floor: Mat, subtitle: str
) -> None:
    """Draw a PNG of 1200 x 980 px.

    Args:
        path: of the picture.
        hovers: the flights.
        table: P2's Table I (m), x and y.
        floor: (samples, 2), m, what the flow's white noise alone comes to.
        subtitle: the result in one line.
    """
    errors: Mat = np.array([it.errors for it in hovers])  # (flights, methods, samples, 2)
    times: Mat = EVERY * PERIOD * np.arange(errors.shape[2], dtype=np.float64)
    title = "Position after a hover of five minutes"
    with page(path, 1200, 980, title, subtitle) as figure:
        grid = figure.add_gridspec(
            2, 2, hspace=0.32, wspace=0.18, left=0.07, right=0.97, top=0.87, bottom=0.07
        )
        for axis in (0, 1):
            axes = figure.add_subplot(grid[0, axis])
            axes.set_title(f"Spread along {AXES[axis]}", pad=10)
            _grow(axes, times, errors[..., axis], floor[:, axis], table[axis])
        wide, near = figure.add_subplot(grid[1, 0]), figure.add_subplot(grid[1, 1])
        ends = errors[:, :, -1]
        _scatter(wide, ends, (ALONE, P2, BIASED), "Where the flights end", 4.5)
        _scatter(near, ends, (P2, BIASED, WHOLE), "The same, closer", 2.2)


def _grow(axes: Axes, times: Mat, errors: Mat, floor: Mat, paper: float) -> None:
    for method, (name, colour) in SHOWN.items():
        spread = errors[:, method].std(axis=0, ddof=1)
        axes.plot(times, spread, color=colour, lw=2.0, label=name)
    axes.plot(times, floor, color=INK, lw=1.2, ls=":", label="white noise of the flow alone")
    axes.plot([times[-1]], [paper], "D", color=INK, ms=8, label="P2, Table I", zorder=5)
    axes.set_xlabel("time in hover, s")
    axes.set_ylabel("standard deviation over the flights, m")
    axes.set_xlim(0.0, 1.03 * times[-1])
    axes.set_ylim(0.0, None)
    axes.grid(visible=True)
    axes.legend(frameon=False, loc="upper left", fontsize=10)


def _scatter(axes: Axes, ends: Mat, methods: Sequence[int], title: str, reach: float) -> None:
    axes.set_title(title, pad=10)
    for method in methods:
        name, colour = SHOWN[method]
        east, north = ends[:, method, 1], ends[:, method, 0]
        axes.plot(east, north, ".", color=colour, ms=5, alpha=0.55, mec="none", label=name)
        axes.add_patch(_ellipse(east, north, colour))
    limits = (reach, 1.6 * reach)  # north, east
    outside = int((np.abs(ends[:, methods]) > limits).any(axis=(1, 2)).sum())
    if outside:
        note = f"{outside} flights with an end outside"
        axes.text(0.98, 0.02, note, transform=axes.transAxes, ha="right", color=MUTED, bbox=HALO)
    axes.set_aspect("equal", adjustable="box")
    axes.set_xlim(-limits[1], limits[1])
    axes.set_ylim(-reach, reach)
    axes.set_xlabel("error east, m; ellipses: 1 sigma")
    axes.set_ylabel("error north, m")
    axes.grid(visible=True)
    axes.legend(frameon=True, framealpha=0.85, edgecolor="none", loc="upper left", markerscale=2.0)


def _ellipse(east: Mat, north: Mat, colour: str) -> Ellipse:
    """Return the ellipse of one standard deviation about the mean."""
    values, vectors = np.linalg.eigh(np.cov(east, north))
    angle = float(np.degrees(np.arctan2(vectors[1, 1], vectors[0, 1])))
    width, height = (2.0 * np.sqrt(values[::-1])).tolist()
    centre = (float(east.mean()), float(north.mean()))
    return Ellipse(centre, width, height, angle=angle, fill=False, ec=colour, lw=2.2, zorder=4)
