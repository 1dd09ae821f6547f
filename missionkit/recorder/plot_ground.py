"""Draws the map and its close-up: obstacles, fences, paths, goals, targets, markers."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from missionkit.messages import Goal
from missionkit.recorder.flight_track import FlightTrack, Place
from missionkit.recorder.palette import (
    FENCE_COLOUR,
    FENCE_DASHES,
    HOME_COLOUR,
    INK,
    MUTED,
    WOOD,
    WOOD_EDGE,
    Style,
)
from missionkit.recorder.plot_text import Ruler
from missionkit.recorder.scenery import Ground, Scenery

EastNorth = tuple[float, float]  # m, east and north

ROBOT_DASHES = {"target": "solid", "obstacle": (0, (1.0, 1.5))}
ROBOT_COLOURS = {"home": HOME_COLOUR, "lost": FENCE_COLOUR, "": MUTED}

REACHED = 1.0  # m, horizontally, within which a goal counts as reached
ARROW = 22.0  # px, how far a marker's arrow points out


class Goals(NamedTuple):
    """Where the behaviours were going, and whether the vehicle came there."""

    reached: list[EastNorth]
    left: list[EastNorth]


class Flown(NamedTuple):
    """A flight seen from above."""

    track: FlightTrack
    times: npt.NDArray[np.float64]  # (N,), s
    path: Ground  # (N, 2), m, east and north: the truth where it is known, else the estimate
    estimated: Ground  # (N, 2), m, east and north

    @classmethod
    def of(cls, track: FlightTrack) -> Flown:
        """Return a track seen from above."""
        estimated = _from_above(track.estimated)
        path = _from_above(track.true) if track.true else estimated
        return cls(track, np.array(track.times), path, estimated)

    def tick(self, at: float) -> int:
        """Return the number of the tick at a time (s)."""
        return min(int(np.searchsorted(self.times, at - 1e-6)), len(self.path) - 1)

    def place(self, at: float) -> EastNorth:
        """Return where the vehicle was at a time (s): east, north, m."""
        east, north = self.path[self.tick(at)].tolist()
        return east, north

    def goal(self, goal: Goal) -> EastNorth:
        """Return east and north (m) of a goal as it lay from the vehicle when it was last computed.

        A goal is a place in the estimate's frame: where the truth is known, it is moved by as much
        as the estimate was wrong at that moment.
        """
        north, east = goal.position[:2].tolist()
        if len(self.path):
            off_east, off_north = (self.path - self.estimated)[self.tick(goal.at)].tolist()
            north, east = north + off_north, east + off_east
        return east, north


def _from_above(places: Sequence[Place]) -> Ground:
    return np.array(places, dtype=float).reshape(-1, 3)[:, 1::-1]


class MapScene(NamedTuple):
    """Contents of a map, and the ruler that measures its labels."""

    ruler: Ruler
    flown: Flown
    scenery: Scenery
    looks: dict[str, Style]  # of each state


def draw_ground(axes: Axes, scene: MapScene) -> None:
    """Draw obstacles, fences, paths, home, targets and markers.

    Args:
        axes: a panel whose limits are set.
        scene: what to draw.
    """
    names = ("east, m", "north, m") if scene.scenery.over_ground else ("y, m", "x, m")
    axes.set_xlabel(names[0])
    axes.set_ylabel(names[1])
    axes.grid(visible=True)
    for obstacle in scene.scenery.obstacles:
        outline = obstacle.footprint()[:, ::-1]
        axes.add_patch(Polygon(outline, facecolor=WOOD, edgecolor=WOOD_EDGE, lw=1.0, zorder=2))
    for fence in scene.scenery.fences:
        for corners in (fence.corners, *fence.holes):
            shape = Polygon(
                np.array(corners)[:, ::-1], fill=False, edgecolor=FENCE_COLOUR, zorder=2
            )
            shape.set(lw=1.4, ls=FENCE_DASHES)
            axes.add_patch(shape)
    _draw_arena(axes, scene.scenery)
    _draw_paths(axes, scene.flown, scene.looks)
    _draw_places(axes, scene.flown, scene.scenery)


def draw_goals(axes: Axes, flown: Flown) -> Goals:
    """Draw where the behaviours were going: pale where the vehicle never came."""
    goals = Goals([], [])
    for goal in flown.track.goals:
        place = flown.goal(goal)
        away = np.hypot(*(flown.path - np.array(place)).T)
        near = len(away) and away.min() <= REACHED
        (goals.reached if near else goals.left).append(place)
    for places, colour, width in ((goals.reached, INK, 2.0), (goals.left, MUTED, 1.2)):
        if places:
            axes.plot(*np.array(places).T, "x", color=colour, ms=9, mew=width, zorder=6)
    return goals


def _draw_arena(axes: Axes, scenery: Scenery) -> None:
    """Draw the arena with its goal, where its robots drove, and how that ended."""
    if scenery.arena is not None:
        outline, goal = scenery.arena.outline[:, ::-1], scenery.arena.goal[:, ::-1]
        axes.add_patch(Polygon(outline, fill=False, edgecolor=MUTED, lw=1.0, zorder=2))
        axes.plot(*goal.T, color=HOME_COLOUR, lw=3.5, zorder=2)
    for path in scenery.paths:
        places = path.places[:, ::-1]
        colour = WOOD_EDGE if path.kind == "obstacle" else MUTED
        axes.plot(*places.T, color=colour, lw=0.7, ls=ROBOT_DASHES[path.kind], zorder=3)
        end = colour if path.kind == "obstacle" else ROBOT_COLOURS[path.end]
        axes.plot(*places[-1], "o", ms=6, mfc=end, mec="white", mew=0.8, zorder=5)


def _draw_paths(axes: Axes, flown: Flown, looks: dict[str, Style]) -> None:
    """Draw the truth in the styles of the states and the estimate as a thin line over it."""
    order = {state: number for number, state in enumerate(looks)}
    by_state = sorted(flown.track.visits, key=lambda visit: order[visit.state])
    for state, visits in groupby(by_state, key=lambda visit: visit.state):
        parts = []
        for visit in visits:
            first, last = np.searchsorted(flown.times, (visit.start, visit.end))
            parts += [flown.path[first : last + 1], np.full((1, 2), np.nan)]
        axes.plot(
            *np.vstack(parts).T,
            lw=3.0,
            markersize=5.5,
            markevery=0.06,
            zorder=4,
            gid=f"path of {state}",
            **looks[state].line,
        )
    if flown.track.true:
        axes.plot(*flown.estimated.T, color=INK, lw=0.7, alpha=0.75, zorder=5)


def _draw_places(axes: Axes, flown: Flown, scenery: Scenery) -> None:
    """Draw home, targets, and the markers with the way they face."""
    if scenery.over_ground and len(flown.path) and axes.viewLim.contains(0.0, 0.0):
        axes.plot(0.0, 0.0, "o", ms=13, mfc="white", mec=INK, mew=1.8, zorder=6)
        axes.text(0.0, 0.0, "H", ha="center", va="center", fontsize=8.5, zorder=7, clip_on=True)
    for target in scenery.targets:
        axes.plot(*target.at[::-1], "D", ms=7, mfc="none", mec=INK, mew=1.4, zorder=6)
    for marker in scenery.markers:
        north, east, _ = marker.position
        out = ARROW * marker.normal
        axes.plot(east, north, "s", ms=5, mfc=INK, mec="white", zorder=6)
        axes.annotate(
            "",
            (east, north),
            (out[1], out[0]),
            textcoords="offset pixels",
            arrowprops={"arrowstyle": "<-", "color": INK, "lw": 1.4, "shrinkA": 0, "shrinkB": 0},
            zorder=6,
        )
