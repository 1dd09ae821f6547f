"""`track.png`: a run on one page: map, height, states, guards, and the reasons for transitions.

Drawn with matplotlib's objects and without its global state, so that runs can be drawn side by
side in one process.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from missionkit.recorder.flight_track import FlightTrack
from missionkit.recorder.palette import INK, MUTED, RULE, Style, styles
from missionkit.recorder.plot_close_up import draw_close_up, last_goal
from missionkit.recorder.plot_ground import Flown, MapScene
from missionkit.recorder.plot_guards import draw_guards
from missionkit.recorder.plot_list import draw_list
from missionkit.recorder.plot_map import draw_map, view_of
from missionkit.recorder.plot_page import DPI, PAGE_WIDTH, page_of
from missionkit.recorder.plot_states import draw_states
from missionkit.recorder.plot_text import Font, Ruler
from missionkit.recorder.scenery import Scenery

CROWDED = 40  # transitions above which lines over time hide more than they show
PAGE_MARGIN = 56.0  # px
TITLE, SUBTITLE = Font(20.0, "bold"), Font(11.5)
PLOT_STYLE: Any = {
    "font.family": "DejaVu Sans",
    "font.size": 11,
    "text.color": INK,
    "text.parse_math": False,
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


def draw(path: Path, track: FlightTrack, scenery: Scenery, title: str, subtitle: str = "") -> None:
    """Draw a run into a PNG, 1400 px wide and as high as its states and transitions ask for.

    Args:
        path: of the picture.
        track: as the flight recorder kept it.
        scenery: obstacles, markers, targets and fences; an empty one when unknown.
        title: mission and outcome.
        subtitle: the numbers of the run.
    """
    with mpl.rc_context(PLOT_STYLE):
        picture(track, scenery, title, subtitle).savefig(path, format="png")


def picture(track: FlightTrack, scenery: Scenery, title: str, subtitle: str = "") -> Figure:
    """Return the page that `draw` saves, laid out and not yet rendered.

    Args:
        track: of at least one tick.
        scenery: obstacles, targets and fence.
        title: cut where the page ends.
        subtitle: below it, in as many lines as it takes.
    """
    figure = Figure(dpi=DPI, facecolor="white")
    FigureCanvasAgg(figure)
    flown, goal = Flown.of(track), last_goal(track)
    view = view_of(flown, scenery)
    page = page_of(figure, track, tall=view.tall, close=goal is not None)
    ruler = Ruler(figure)
    _head(figure, ruler, title, subtitle)
    looks = styles(it.state for it in track.visits)
    scene = MapScene(ruler, flown, scenery, looks)
    draw_map(page.map, scene, view)
    if goal is not None and page.close_up is not None:
        draw_close_up(page.close_up, scene, goal)
    _draw_height(page.height, track, looks, over_ground=scenery.over_ground)
    draw_states(page.states, ruler, track, looks)
    draw_guards(page.guards, ruler, track)
    draw_list(page.transitions, ruler, track, looks, page.lines)
    _share_time(track, (page.height, page.states, page.guards))
    return figure


def _head(figure: Figure, ruler: Ruler, title: str, subtitle: str) -> None:
    high = figure.bbox.height
    room = PAGE_WIDTH - 2.0 * PAGE_MARGIN
    title = ruler.cut(title, TITLE, room)
    lines = ruler.lines(subtitle, SUBTITLE, room, 2)
    left = PAGE_MARGIN / PAGE_WIDTH
    figure.text(left, 1.0 - 44.0 / high, title, va="center", **TITLE.keywords)
    below = "\n".join(lines)
    figure.text(left, 1.0 - 66.0 / high, below, va="top", color=MUTED, **SUBTITLE.keywords)


def _draw_height(
    axes: Axes, track: FlightTrack, looks: dict[str, Style], *, over_ground: bool
) -> None:
    """Draw the height, or z, of truth and estimate over time, on a background of states."""
    title = "Height above the take-off point" if over_ground else "z in the mother-ship's frame"
    axes.set_title(title, pad=10)
    sign = -1.0 if over_ground else 1.0
    axes.set_ylabel("m")
    axes.grid(axis="y")
    for visit in track.visits:
        axes.axvspan(visit.start, visit.end, color=looks[visit.state].colour, alpha=0.16, lw=0)
    heights = [sign * z for _, _, z in track.estimated]
    axes.plot(track.times, heights, color=INK, lw=0.8, label="estimate", zorder=3)
    if track.true:
        heights = [sign * z for _, _, z in track.true]
        axes.plot(track.times, heights, color="#0072B2", lw=2.0, label="truth", zorder=2.5)
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, 0.0), high)
    axes.legend(
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        frameon=False,
        ncols=2,
        fontsize=9.5,
        handlelength=1.4,
        borderaxespad=0.2,
    )


def _share_time(track: FlightTrack, panels: Sequence[Axes]) -> None:
    """Put transitions and the same limits of time on every panel over time."""
    for axes in panels:
        for at, _ in track.transitions if len(track.transitions) <= CROWDED else ():
            axes.axvline(at, color=MUTED, lw=0.8, ls=(0, (2, 2)), zorder=1)
        if len(track.times) > 1:
            axes.set_xlim(track.times[0], track.times[-1])
    panels[-1].set_xlabel("mission time, s")
