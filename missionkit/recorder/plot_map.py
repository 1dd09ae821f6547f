"""The map of `track.png`: north up, east to the right."""

from __future__ import annotations

from collections.abc import Sequence

import matplotlib.patheffects as effects
import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Polygon

from missionkit.messages import Goal
from missionkit.recorder.palette import INK, MUTED, WOOD, WOOD_EDGE
from missionkit.recorder.scenery import Ground, Marker, Scenery
from missionkit.recorder.track import Place, Track

HALO = [effects.withStroke(linewidth=3.0, foreground="white")]


CLOSE = 4.0  # m, half the height of the close-up


def draw_map(axes: Axes, track: Track, scenery: Scenery, shades: dict[str, str]) -> None:
    """Draw the ground seen from above: what stands there, where it flew, where it switched."""
    axes.set_title("Map", pad=10)
    _draw_ground(axes, track, scenery, shades)
    axes.autoscale_view()
    (west, east), (south, north) = axes.get_xlim(), axes.get_ylim()
    room = 2.0 + 0.03 * max(east - west, north - south)
    _frame(axes, (west - room, east + room), (south - room, north + room))
    _legend(axes, track, shades)


def draw_close_up(
    axes: Axes, track: Track, scenery: Scenery, shades: dict[str, str], goal: Goal
) -> None:
    """Draw the map again, a few metres around `goal`."""
    axes.set_title(f"Close-up of {goal.target}", pad=10)
    _draw_ground(axes, track, scenery, shades)
    north, east, _ = goal.position.tolist()
    _frame(axes, (east, east), (north - CLOSE, north + CLOSE))


def _draw_ground(axes: Axes, track: Track, scenery: Scenery, shades: dict[str, str]) -> None:
    axes.set_xlabel("east, m")
    axes.set_ylabel("north, m")
    axes.grid(visible=True)
    for obstacle in scenery.obstacles:
        outline = obstacle.footprint()[:, ::-1]
        axes.add_patch(Polygon(outline, facecolor=WOOD, edgecolor=WOOD_EDGE, lw=1.0, zorder=2))
        axes.update_datalim(outline)
    _draw_paths(axes, track, shades)
    _draw_places(axes, track, scenery.markers)
    _draw_transitions(axes, track, shades)


def _frame(axes: Axes, across: tuple[float, float], along: tuple[float, float]) -> None:
    """Show at least these limits (m), with a metre as long across as along."""
    panel = axes.get_window_extent()
    span = max((across[1] - across[0]) / panel.width, (along[1] - along[0]) / panel.height)
    middle, centre = 0.5 * sum(across), 0.5 * sum(along)
    axes.set_xlim(middle - 0.5 * span * panel.width, middle + 0.5 * span * panel.width)
    axes.set_ylim(centre - 0.5 * span * panel.height, centre + 0.5 * span * panel.height)


def number(axes: Axes, at: tuple[float, float], index: int, shade: str) -> None:
    """Write a numbered disc at `at` (data coordinates), as map and list of transitions share."""
    axes.annotate(
        str(index),
        at,
        ha="center",
        va="center",
        fontsize=9.5,
        fontweight="bold",
        color="white",
        bbox={"boxstyle": "circle,pad=0.25", "facecolor": shade, "edgecolor": "white", "lw": 1.2},
        zorder=8,
        annotation_clip=True,
    )


def seen_from_above(places: Sequence[Place]) -> Ground:
    """Return (N, 2), m, east and north of positions in NED."""
    return np.array(places).reshape(-1, 3)[:, 1::-1]


def _draw_paths(axes: Axes, track: Track, shades: dict[str, str]) -> None:
    """Draw the truth in the colours of the states and the estimate as a thin line over it."""
    estimated = seen_from_above(track.estimated)
    path = seen_from_above(track.true) if track.true else estimated
    times = np.array(track.times)
    for visit in track.visits:
        first, last = np.searchsorted(times, (visit.start, visit.end))
        part = path[first : last + 1]
        axes.plot(*part.T, color=shades[visit.state], lw=3.2, solid_capstyle="round", zorder=4)
    if track.true:
        axes.plot(*estimated.T, color=INK, lw=0.7, alpha=0.75, zorder=5)


def _draw_places(axes: Axes, track: Track, markers: Sequence[Marker]) -> None:
    """Draw home, goals, and the markers with the way they face."""
    if track.estimated:
        axes.plot(0.0, 0.0, "o", ms=13, mfc="white", mec=INK, mew=1.8, zorder=6)
        axes.text(0.0, 0.0, "H", ha="center", va="center", fontsize=8.5, zorder=7, clip_on=True)
    for goal in track.goals:
        axes.plot(goal.position[1], goal.position[0], "x", color=INK, ms=9, mew=2.0, zorder=6)
    for marker in markers:
        north, east, _ = marker.position
        out = 26.0 * marker.normal
        axes.plot(east, north, "s", ms=6, mfc=INK, mec="white", zorder=6)
        axes.annotate(
            "",
            (east, north),
            (out[1], out[0]),
            textcoords="offset points",
            arrowprops={"arrowstyle": "<-", "color": INK, "lw": 1.6, "shrinkA": 0, "shrinkB": 0},
            zorder=6,
        )
        axes.annotate(
            marker.name,
            (east, north),
            (8, 8),
            textcoords="offset points",
            fontsize=10,
            path_effects=HALO,
            zorder=7,
            annotation_clip=True,
        )


def _draw_transitions(axes: Axes, track: Track, shades: dict[str, str]) -> None:
    """Number the places where the chart switched."""
    path = seen_from_above(track.true or track.estimated)
    for index, (at, fired) in enumerate(track.transitions, 1):
        tick = min(int(np.searchsorted(track.times, at)), len(path) - 1)
        east, north = path[tick]
        number(axes, (float(east), float(north)), index, shades.get(fired.to, MUTED))


def _legend(axes: Axes, track: Track, shades: dict[str, str]) -> None:
    lines = [Line2D([], [], color=shade, lw=3.2, label=name) for name, shade in shades.items()]
    if track.true:
        lines.append(Line2D([], [], color=INK, lw=0.9, label="estimate"))
    lines.append(Line2D([], [], color=INK, marker="x", mew=2.0, lw=0, label="goal"))
    axes.legend(handles=lines, loc="best", framealpha=0.92, edgecolor="#E4E7EB", fontsize=10.5)
