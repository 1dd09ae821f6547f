"""The map of `track.png`: north up, east to the right."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from missionkit.recorder.palette import FENCE_COLOUR, FENCE_DASHES, INK, MUTED
from missionkit.recorder.plot_ground import (
    ROBOT_COLOURS,
    Flown,
    Goals,
    MapScene,
    draw_goals,
    draw_ground,
)
from missionkit.recorder.plot_map_labels import dots, label_map
from missionkit.recorder.scenery import Fence, Ground, Scenery

SHRUNK = 1.8  # how much smaller all may be drawn for a fence to be seen whole


class MapView(NamedTuple):
    """Limits of a map (m)."""

    west: float
    east: float
    south: float
    north: float
    hidden: tuple[Fence, ...] = ()  # that go beyond these limits

    @property
    def tall(self) -> float:
        """How much longer it is along north than along east."""
        return (self.north - self.south) / (self.east - self.west)


def view_of(flown: Flown, scenery: Scenery) -> MapView:
    """Return what the map shows: the flight, what stands there, and fences not too far off."""
    places = [flown.path, np.zeros((1, 2)), *(it.footprint()[:, ::-1] for it in scenery.obstacles)]
    places += [np.array([it.position[1::-1]]) for it in scenery.markers]
    places += [np.array([it.at[::-1]]) for it in scenery.targets]
    places += [] if scenery.arena is None else [scenery.arena.outline[:, ::-1]]
    low, high = _limits(np.vstack(places))
    hidden = []
    for fence in scenery.fences:
        wider = _limits(np.vstack([low, high, fence.outline()[:, ::-1]]), share=0.03)
        if max(wider[1] - wider[0]) > SHRUNK * max(high - low):
            hidden.append(fence)
        else:
            low, high = wider
    return MapView(low[0], high[0], low[1], high[1], tuple(hidden))


def draw_map(axes: Axes, scene: MapScene, view: MapView) -> None:
    """Draw the ground seen from above: what stands there, where it flew, where it switched.

    Args:
        axes: an empty panel.
        scene: what to draw.
        view: limits.
    """
    axes.set_title("Map", pad=10)
    frame(axes, (view.west, view.east), (view.south, view.north))
    draw_ground(axes, scene)
    dots(axes, scene)
    goals = draw_goals(axes, scene.flown)
    _key(axes, scene, goals)
    _tell_hidden(axes, view.hidden)
    label_map(axes, scene, [*goals.reached, *goals.left])


def frame(axes: Axes, across: tuple[float, float], along: tuple[float, float]) -> None:
    """Show at least these limits (m), with a metre as long across as along.

    Args:
        axes: laid out already, for the shape of the panel decides.
        across: from west to east, m.
        along: from south to north, m.
    """
    panel = axes.get_window_extent()
    span = max((across[1] - across[0]) / panel.width, (along[1] - along[0]) / panel.height)
    middle, centre = 0.5 * sum(across), 0.5 * sum(along)
    axes.set_xlim(middle - 0.5 * span * panel.width, middle + 0.5 * span * panel.width)
    axes.set_ylim(centre - 0.5 * span * panel.height, centre + 0.5 * span * panel.height)


def _limits(places: Ground, share: float = 0.06) -> tuple[Ground, Ground]:
    """Return the least and the greatest east and north (m), with some room around."""
    low, high = places.min(axis=0), places.max(axis=0)
    room = max(share * float(np.max(high - low)), 1.0)
    return low - room, high + room


def _key(axes: Axes, scene: MapScene, goals: Goals) -> None:
    lines = []
    if scene.flown.track.true:
        lines.append(Line2D([], [], color=INK, lw=0.9, label="estimate"))
    if goals.reached:
        lines.append(Line2D([], [], color=INK, marker="x", mew=2.0, lw=0, label="goal"))
    if goals.left:
        lines.append(
            Line2D([], [], color=MUTED, marker="x", mew=1.2, lw=0, label="goal, not reached")
        )
    if scene.scenery.fences:
        lines.append(Line2D([], [], color=FENCE_COLOUR, lw=1.4, ls=FENCE_DASHES, label="fence"))
    ends: list[str] = [it.end for it in scene.scenery.paths if it.kind == "target"]
    for end, name in (("", "in play"), ("home", "home"), ("lost", "lost")):
        if count := ends.count(end):
            label = f"{count} {name}"
            lines.append(Line2D([], [], color=ROBOT_COLOURS[end], marker="o", lw=0, label=label))
    if lines:
        axes.legend(
            handles=lines,
            loc="lower right",
            bbox_to_anchor=(1.0, 1.0),
            ncols=len(lines),
            frameon=False,
            fontsize=9.5,
            handlelength=1.4,
            columnspacing=1.1,
            handletextpad=0.5,
            borderaxespad=0.2,
        )


def _tell_hidden(axes: Axes, fences: tuple[Fence, ...]) -> None:
    """Write the limits of fences that are not seen whole."""
    for number, fence in enumerate(fences):
        (south, west), (north, east) = np.min(fence.corners, axis=0), np.max(fence.corners, axis=0)
        axes.annotate(
            f"fence: north {south:g} to {north:g} m, east {west:g} to {east:g} m",
            (1.0, 0.0),
            (-6, 6 + 14 * number),
            xycoords="axes fraction",
            textcoords="offset points",
            ha="right",
            color=FENCE_COLOUR,
            fontsize=9.5,
        )
