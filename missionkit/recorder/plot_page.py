"""Where the panels of `track.png` go: a flight along north gets a tall map beside the others."""

from __future__ import annotations

import math
from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from missionkit.recorder import plot_guards, plot_states
from missionkit.recorder.flight_track import FlightTrack
from missionkit.recorder.plot_list import list_height

DPI = 100
PAGE_WIDTH, LEAST_PAGE_HEIGHT = 1400.0, 1290.0
"""px: width of the page, least height of what is beside a tall map."""
TALL = 1.25  # times as long as wide: the map stands beside the other panels
PAGE_TOP, PAGE_BOTTOM, PAGE_RIGHT = 150.0, 60.0, 32.0  # px, margins of the page
PANEL_GAP, BELOW_MAP = 76.0, 96.0  # px between panels one below the other
HEIGHT_PANEL, CLOSE_UP_PANEL = 200.0, 360.0  # px


class Page(NamedTuple):
    """The panels of the picture."""

    map: Axes
    close_up: Axes | None
    height: Axes
    states: Axes
    guards: Axes
    transitions: Axes
    lines: int  # that the reason of a transition may take


class Area(NamedTuple):
    """A part of the page (px, from its left upper corner)."""

    left: float
    top: float
    width: float
    height: float


def page_of(figure: Figure, track: FlightTrack, *, tall: float, close: bool) -> Page:
    """Make the figure as high as it has to be, and its panels.

    Args:
        figure: an empty one.
        track: what is to be shown.
        tall: of the map, how much longer it is along north than along east.
        close: whether there is a close-up.
    """
    if tall > TALL:
        return _beside(figure, track, close=close)
    return _above(figure, track, close=close)


def _beside(figure: Figure, track: FlightTrack, *, close: bool) -> Page:
    left, wide = 76.0, 460.0
    high = max(sum(_heights(track, 2)) + 3.0 * PANEL_GAP, LEAST_PAGE_HEIGHT)
    _resize(figure, PAGE_TOP + high + PAGE_BOTTOM)
    top = high - (CLOSE_UP_PANEL + BELOW_MAP if close else 0.0)
    place = _panel(figure, Area(left, PAGE_TOP, wide, top))
    near = Area(left, PAGE_TOP + top + BELOW_MAP, wide, CLOSE_UP_PANEL)
    close_up = _panel(figure, near) if close else None
    heights = _heights(track, 2, high)
    return Page(place, close_up, *_column(figure, heights, PAGE_TOP, 840.0, 620.0), lines=2)


def _above(figure: Figure, track: FlightTrack, *, close: bool) -> Page:
    left, high, beside = 76.0, 680.0, 440.0
    heights = _heights(track, 1)
    top = PAGE_TOP + high + BELOW_MAP
    _resize(figure, top + sum(heights) + 3.0 * PANEL_GAP + PAGE_BOTTOM)
    wide = PAGE_WIDTH - left - PAGE_RIGHT - (beside + 80.0 if close else 0.0)
    place = _panel(figure, Area(left, PAGE_TOP, wide, high))
    near = Area(PAGE_WIDTH - PAGE_RIGHT - beside, PAGE_TOP, beside, high)
    close_up = _panel(figure, near) if close else None
    return Page(place, close_up, *_column(figure, heights, top, 290.0, 56.0), lines=1)


def _heights(track: FlightTrack, lines: int, room: float = 0.0) -> list[float]:
    """Return how high (px) height, states, guards and list are; the first takes what is spare."""
    states = plot_states.STATE_ROW * plot_states.state_rows(track) + 6.0
    guards = plot_guards.GUARD_ROW * plot_guards.guard_rows(track) + 6.0
    heights = [HEIGHT_PANEL, states, guards, list_height(track, lines)]
    spare = room - sum(heights) - 3.0 * PANEL_GAP
    return [HEIGHT_PANEL + min(max(spare, 0.0), HEIGHT_PANEL), *heights[1:]]


def _column(
    figure: Figure, heights: list[float], top: float, over_time: float, left: float
) -> tuple[Axes, Axes, Axes, Axes]:
    """Return height, states, guards and list, one below the other."""
    panels = []
    for edge, high in zip((over_time, over_time, over_time, left), heights, strict=True):
        panels.append(_panel(figure, Area(edge, top, PAGE_WIDTH - PAGE_RIGHT - edge, high)))
        top += high + PANEL_GAP
    height, states, guards, transitions = panels
    return height, states, guards, transitions


def _resize(figure: Figure, high: float) -> None:
    figure.set_size_inches(PAGE_WIDTH / DPI, math.ceil(high) / DPI)


def _panel(figure: Figure, area: Area) -> Axes:
    high = figure.bbox.height
    return figure.add_axes(
        (
            area.left / PAGE_WIDTH,
            1.0 - (area.top + area.height) / high,
            area.width / PAGE_WIDTH,
            area.height / high,
        )
    )
