"""`track.png`: a run on one page: the map, the height, what each guard said, why it switched.

Drawn with matplotlib's objects and without its global state, so that runs can be drawn side by
side in one process.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.gridspec import GridSpecFromSubplotSpec

from missionkit.messages import Goal
from missionkit.recorder.palette import INK, MUTED, RULE, colours
from missionkit.recorder.plot_guards import draw_guards
from missionkit.recorder.plot_list import draw_list
from missionkit.recorder.plot_map import draw_close_up, draw_map, seen_from_above
from missionkit.recorder.scenery import Scenery
from missionkit.recorder.track import Track, Visit

LETTER = 8.5  # px, width of a bold one
STYLE: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 11,
    "text.color": INK,
    "axes.edgecolor": "#B8C0CA",
    "axes.labelcolor": MUTED,
    "axes.titlesize": 13,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "grid.color": RULE,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
}


class Page(NamedTuple):
    """The panels of the picture."""

    map: Axes
    close_up: Axes | None
    height: Axes
    guards: Axes
    transitions: Axes
    letters: int  # of a transition's reason that fit into a line


def draw(path: Path, track: Track, scenery: Scenery, title: str, subtitle: str = "") -> None:
    """Draw a run into a PNG of 1400 x 1600 px.

    Args:
        path: of the picture.
        track: as the flight recorder kept it.
        scenery: obstacles and markers; an empty one when unknown.
        title: mission and outcome.
        subtitle: the numbers of the run in one line.
    """
    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(14.0, 16.0), dpi=100, facecolor="white")
        FigureCanvasAgg(figure)
        figure.text(0.04, 0.968, title, fontsize=22, fontweight="bold", va="center")
        figure.text(0.04, 0.942, subtitle, fontsize=12.5, color=MUTED, va="center")
        goal = _last_target(track)
        page = _page(figure, track, close=goal is not None)
        shades = colours(it.state for it in track.visits)
        draw_map(page.map, track, scenery, shades)
        if goal is not None and page.close_up is not None:
            draw_close_up(page.close_up, track, scenery, shades, goal)
        _draw_height(page.height, track, shades)
        draw_guards(page.guards, track)
        draw_list(page.transitions, track, shades, page.letters)
        _share_time(track, (page.height, page.guards))
        figure.savefig(path, format="png")


def _page(figure: Figure, track: Track, *, close: bool) -> Page:
    """Lay out the panels: a flight along north gets a tall map on the left, others a wide one."""
    ground = seen_from_above(track.true or track.estimated)
    east, north = np.ptp(ground, axis=0) if len(ground) else (1.0, 1.0)
    if north > 1.5 * east:
        columns = figure.add_gridspec(
            1, 2, width_ratios=[5, 7], wspace=0.32, left=0.06, right=0.97, top=0.9, bottom=0.045
        )
        shares = [7, 3] if close else [1]
        left = _stack(
            figure, columns[0].subgridspec(len(shares), 1, hspace=0.16, height_ratios=shares)
        )
        right = _stack(figure, columns[1].subgridspec(3, 1, hspace=0.24, height_ratios=[4, 5, 5]))
        return Page(left[0], left[1] if close else None, right[0], right[1], right[2], 50)
    rows = figure.add_gridspec(
        4,
        1,
        height_ratios=[10, 3.4, 4.6, 4],
        hspace=0.42,
        left=0.13,
        right=0.97,
        top=0.9,
        bottom=0.03,
    )
    shares = [7, 4] if close else [1]
    top = _stack(figure, rows[0].subgridspec(1, len(shares), wspace=0.2, width_ratios=shares))
    below = [figure.add_subplot(rows[row]) for row in (1, 2, 3)]
    return Page(top[0], top[1] if close else None, below[0], below[1], below[2], 112)


def _stack(figure: Figure, grid: GridSpecFromSubplotSpec) -> list[Axes]:
    """Fill a grid of one row or one column with panels."""
    return [figure.add_subplot(grid[cell]) for cell in range(grid.nrows * grid.ncols)]


def _last_target(track: Track) -> Goal | None:
    """Return the last goal at a target other than home, which deserves a close look."""
    aims = [goal for goal in track.goals if goal.target not in {None, "home"}]
    return aims[-1] if aims else None


def _draw_height(axes: Axes, track: Track, shades: dict[str, str]) -> None:
    """Draw the height of truth and estimate over time, on a background of states."""
    axes.set_title("Height above the take-off point", pad=26)
    axes.set_ylabel("m")
    axes.grid(axis="y")
    for visit in track.visits:
        axes.axvspan(visit.start, visit.end, color=shades[visit.state], alpha=0.16, lw=0)
    _name_states(axes, track.visits, shades)
    heights = [-down for _, _, down in track.estimated]
    axes.plot(track.times, heights, color=INK, lw=0.8, label="estimate", zorder=3)
    if track.true:
        heights = [-down for _, _, down in track.true]
        axes.plot(track.times, heights, color="#0072B2", lw=2.0, label="truth", zorder=2.5)
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, 0.0), high + 0.1 * (high - low))
    axes.legend(loc="lower center", framealpha=0.85, edgecolor=RULE, ncols=2, fontsize=10)


def _name_states(axes: Axes, visits: Sequence[Visit], shades: dict[str, str]) -> None:
    """Write each state above its stretch of time if it fits."""
    letters = axes.get_window_extent().width / LETTER
    whole = max(visits[-1].end - visits[0].start, 1e-9) if visits else 1.0
    for visit in visits:
        if letters * (visit.end - visit.start) / whole < len(visit.state):
            continue
        axes.text(
            0.5 * (visit.start + visit.end),
            1.02,
            visit.state,
            transform=axes.get_xaxis_transform(),
            ha="center",
            va="bottom",
            color=shades[visit.state],
            fontweight="bold",
            fontsize=10,
        )


def _share_time(track: Track, panels: Sequence[Axes]) -> None:
    """Put transitions and the same limits of time on every panel over time."""
    for axes in panels:
        for at, _ in track.transitions:
            axes.axvline(at, color=MUTED, lw=0.8, ls=(0, (2, 2)), zorder=1)
        if len(track.times) > 1:
            axes.set_xlim(track.times[0], track.times[-1])
    panels[-1].set_xlabel("mission time, s")
