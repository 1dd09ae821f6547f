"""The labels of the map: names of targets, markers and states, numbers of transitions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes

from missionkit.recorder.palette import INK, MUTED, OTHER_STYLE, darker, disc, letters_on
from missionkit.recorder.plot_ground import ARROW, EastNorth, MapScene
from missionkit.recorder.plot_labels import (
    Boxes,
    Pixels,
    Room,
    Wanted,
    boxes,
    grouped,
    numbers_text,
    placed,
)
from missionkit.recorder.plot_text import Font

LABEL_BOX = {"boxstyle": "square,pad=0.08", "facecolor": "white", "edgecolor": "none", "alpha": 0.8}
NAME_FONT, NUMBER_FONT, STATE_FONT = Font(10.0, "bold"), Font(9.0, "bold"), Font(9.5)
SHARED_LABEL_DISTANCE = 15.0  # px: transitions nearer than that share a label
LONG = 70.0  # px that a state's path is long if its name stands beside it
MOST_STATES_NAMED = 12
"""States; the names of more would hide the map, and stand beside their rows below."""
POINTS = 400  # of the path, that labels keep off
HIGH = 14.0  # px, a line of text
DISC = (10.0, 17.0)  # px, what a number's disc is wider than it, and its height
HOME_SIZE, CROSS_SIZE, DIAMOND_SIZE, DOT_SIZE = 18.0, 11.0, 11.0, 6.0
"""px, sizes of what no label may cover."""
LEADER_DISTANCE = 10.0  # px between a label and its anchor from which a line joins them


class Label(NamedTuple):
    """A text with its anchor, east and north (m)."""

    text: str
    at: EastNorth
    font: Font
    colour: str = INK
    face: str = ""  # of the disc behind it, if it has one
    needed: bool = True


def label_map(axes: Axes, scene: MapScene, goals: Sequence[EastNorth]) -> None:
    """Write all labels of a map whose limits are set.

    Args:
        axes: the map.
        scene: what it shows.
        goals: east and north (m), which are kept free.
    """
    _write(axes, scene, [*_names(scene), *_transitions(axes, scene), *_states(axes, scene)], goals)


def label_close_up(axes: Axes, scene: MapScene, goal: EastNorth) -> None:
    """Write the labels of a close-up: those of the map without the names of states.

    Args:
        axes: with the flight drawn and the limits set.
        scene: what is drawn.
        goal: marked as the goal.
    """
    _write(axes, scene, [*_names(scene), *_transitions(axes, scene)], [goal])


def dots(axes: Axes, scene: MapScene) -> None:
    """Dot the places where the chart switched, in the colour of the state it switched to."""
    transitions = scene.flown.track.transitions
    if len(scene.flown.path) and transitions:
        places = np.array([scene.flown.place(at) for at, _ in transitions])
        shades = _shades(scene)
        east, north = places.T
        axes.scatter(east, north, 26, shades, edgecolors="white", linewidths=0.8, zorder=7)


def _write(
    axes: Axes, scene: MapScene, labels: Sequence[Label], goals: Sequence[EastNorth]
) -> None:
    """Write labels beside their anchors, none over another, the most important first."""
    panel = axes.get_window_extent()
    seen = [it for it in labels if panel.contains(*_pixel(axes, it.at))]
    wanted = [_wanted(axes, scene, it) for it in seen]
    room = Room(panel.extents, _icons(axes, scene, goals), _path(axes, scene))
    for label, want, centre in zip(seen, wanted, placed(wanted, room), strict=True):
        if centre is None:
            continue
        _lead(axes, want, centre)
        axes.annotate(
            label.text,
            centre,
            xycoords="figure pixels",
            ha="center",
            va="center",
            color=label.colour,
            bbox=disc(label.face) if label.face else LABEL_BOX,
            zorder=9,
            **label.font.keywords,
        )


def _transitions(axes: Axes, scene: MapScene) -> list[Label]:
    """Return the numbers of the transitions, those of places near to each other together."""
    transitions = scene.flown.track.transitions
    if not len(scene.flown.path) or not transitions:
        return []
    places = [scene.flown.place(at) for at, _ in transitions]
    pixels, shades = np.asarray(axes.transData.transform(places)), _shades(scene)
    found = []
    for group in grouped(pixels, SHARED_LABEL_DISTANCE):
        face = shades[group[0]] if len({shades[it] for it in group}) == 1 else INK
        text = numbers_text(it + 1 for it in group)
        found.append(Label(text, places[group[0]], NUMBER_FONT, letters_on(face), face))
    return found


def _shades(scene: MapScene) -> list[str]:
    """Return the colour of the state that each transition leads to."""
    transitions = scene.flown.track.transitions
    return [scene.looks.get(fired.to, OTHER_STYLE).colour for _, fired in transitions]


def _names(scene: MapScene) -> list[Label]:
    targets = [Label(it.name, (it.at[1], it.at[0]), NAME_FONT) for it in scene.scenery.targets]
    markers = [
        Label(it.name, (float(it.position[1]), float(it.position[0])), STATE_FONT, MUTED)
        for it in scene.scenery.markers
    ]
    return targets + markers


def _states(axes: Axes, scene: MapScene) -> list[Label]:
    """Return the name of each state, beside the middle of its longest stretch if that is long."""
    path, times = scene.flown.path, scene.flown.times
    if not len(path) or len(scene.looks) > MOST_STATES_NAMED:
        return []
    steps = np.diff(np.asarray(axes.transData.transform(path)), axis=0)
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*steps.T))])
    longest: dict[str, tuple[float, int]] = {}
    for visit in scene.flown.track.visits:
        first, last = np.searchsorted(times, (visit.start, visit.end)).clip(max=len(path) - 1)
        length = float(along[last] - along[first])
        middle = int(np.searchsorted(along, 0.5 * (along[first] + along[last])))
        longest[visit.state] = max(longest.get(visit.state, (0.0, 0)), (length, middle))
    found = []
    for state, (length, tick) in longest.items():
        if length >= LONG:
            east, north = path[min(tick, len(path) - 1)].tolist()
            colour = darker(scene.looks[state].colour)
            found.append(Label(state, (east, north), STATE_FONT, colour, needed=False))
    return found


def _wanted(axes: Axes, scene: MapScene, label: Label) -> Wanted:
    wide, high = scene.ruler.width(label.text, label.font), HIGH
    if label.face:
        wide, high = max(wide + DISC[0], DISC[1]), DISC[1]
    return Wanted(_pixel(axes, label.at), wide, high, label.needed)


def _pixel(axes: Axes, at: EastNorth) -> tuple[float, float]:
    x, y = axes.transData.transform(at).tolist()
    return x, y


def _path(axes: Axes, scene: MapScene) -> Pixels:
    path = scene.flown.path[:: max(len(scene.flown.path) // POINTS, 1)]
    return np.asarray(axes.transData.transform(path)).reshape(-1, 2)


def _icons(axes: Axes, scene: MapScene, goals: Sequence[EastNorth]) -> Boxes:
    """Return what no label may cover: home, goals, transitions, targets, markers with arrows."""
    targets = [(it.at[1], it.at[0]) for it in scene.scenery.targets]
    switched = [scene.flown.place(at) for at, _ in scene.flown.track.transitions]
    found = [_square(axes, targets, DIAMOND_SIZE), _square(axes, goals, CROSS_SIZE)]
    if len(scene.flown.path):
        found += [_square(axes, [(0.0, 0.0)], HOME_SIZE), _square(axes, switched, DOT_SIZE)]
    for marker in scene.scenery.markers:
        x, y = _pixel(axes, (float(marker.position[1]), float(marker.position[0])))
        u, v = x + ARROW * marker.normal[1], y + ARROW * marker.normal[0]
        found.append(np.array([[min(x, u) - 4, min(y, v) - 4, max(x, u) + 4, max(y, v) + 4]]))
    return np.vstack(found)


def _square(axes: Axes, places: Sequence[EastNorth], size: float) -> Boxes:
    centres = np.asarray(axes.transData.transform(np.array(places).reshape(-1, 2)))
    return boxes(centres.reshape(-1, 2), size, size)


def _lead(axes: Axes, want: Wanted, centre: tuple[float, float]) -> None:
    """Draw a line from a label that stands away from its anchor."""
    (x, y), (u, v) = want.anchor, centre
    near = (
        min(max(x, u - 0.5 * want.width), u + 0.5 * want.width),
        min(max(y, v - 0.5 * want.height), v + 0.5 * want.height),
    )
    if np.hypot(near[0] - x, near[1] - y) > LEADER_DISTANCE:
        axes.annotate(
            "",
            (x, y),
            near,
            xycoords="figure pixels",
            textcoords="figure pixels",
            arrowprops={"arrowstyle": "-", "color": MUTED, "lw": 0.8, "shrinkA": 0, "shrinkB": 0},
            zorder=6,
        )
