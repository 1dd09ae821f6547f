"""The close-up of `track.png`: the last goal at a target, scaled to the error."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes

from missionkit.messages import Goal
from missionkit.recorder.flight_track import FlightTrack
from missionkit.recorder.palette import INK
from missionkit.recorder.plot_ground import Flown, MapScene, draw_ground
from missionkit.recorder.plot_map import frame
from missionkit.recorder.plot_map_labels import NAME_FONT, dots, label_close_up

LEAST_HALF_HEIGHT, MOST_HALF_HEIGHT = 0.1, 4.0  # m, half the height of the close-up
AROUND = 3.0  # times the error that is seen on either side
ARRIVED_SHARE, ARRIVED_LEAST = 0.1, 1.0
"""Share of the visit in which the vehicle has arrived, at least this, s."""


def last_goal(track: FlightTrack) -> Goal | None:
    """Return the last goal at a target other than home, which deserves a close look."""
    aims = [goal for goal in track.goals if goal.target not in {None, "home"}]
    return aims[-1] if aims and track.times else None


def draw_close_up(axes: Axes, scene: MapScene, goal: Goal) -> None:
    """Draw the map again around `goal`, with a bar that gives the scale.

    Args:
        axes: an empty panel.
        scene: what to draw.
        goal: the middle of the panel.
    """
    axes.set_title(f"Close-up: goal at {goal.target}", pad=10)
    east, north = scene.flown.goal(goal)
    half = reach(scene.flown, goal)
    frame(axes, (east, east), (north - half, north + half))
    axes.ticklabel_format(useOffset=False)
    axes.locator_params(nbins=5)
    draw_ground(axes, scene)
    dots(axes, scene)
    axes.plot(east, north, "x", color=INK, ms=11, mew=2.2, zorder=6)
    _bar(axes)
    label_close_up(axes, scene, (east, north))


def reach(flown: Flown, goal: Goal) -> float:
    """Return half the height (m) of a close-up that shows how near to a goal the vehicle came.

    The visit counts in which the goal was computed last, of that its end.
    """
    visits = flown.track.visits
    visit = next((it for it in visits if it.start <= goal.at <= it.end), visits[-1])
    since = visit.end - max(ARRIVED_SHARE * (visit.end - visit.start), ARRIVED_LEAST)
    late = (flown.times >= since - 1e-6) & (flown.times <= visit.end + 1e-6)
    away = np.hypot(*(flown.path[late] - np.array(flown.goal(goal))).T)
    error = float(np.percentile(away, 90)) if len(away) else MOST_HALF_HEIGHT
    return min(max(AROUND * error, LEAST_HALF_HEIGHT), MOST_HALF_HEIGHT)


def rounded(length: float) -> float:
    """Return the greatest of 1, 2, 5, 10, 20, … that is not greater.

    >>> rounded(0.34), rounded(7.0)
    (0.2, 5.0)
    """
    power = 10.0 ** math.floor(math.log10(length))
    return max(it for it in (power, 2.0 * power, 5.0 * power) if it <= length * (1.0 + 1e-9))


def _bar(axes: Axes) -> None:
    west, east = axes.get_xlim()
    south, north = axes.get_ylim()
    long = rounded(0.28 * (east - west))
    x, y = west + 0.06 * (east - west), south + 0.06 * (north - south)
    axes.plot([x, x + long], [y, y], color=INK, lw=3.0, solid_capstyle="butt", zorder=9)
    axes.annotate(
        f"{100.0 * long:g} cm" if long < 1.0 else f"{long:g} m",
        (x + 0.5 * long, y),
        (0, 5),
        textcoords="offset points",
        ha="center",
        zorder=9,
        **NAME_FONT.keywords,
    )
