"""Draw `docs/images/patterns.png`: where each behaviour with a pattern flies."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from missionkit.behaviors.area_search import ExpandingSquare, Sector
from missionkit.behaviors.orbit import Orbit
from missionkit.behaviors.survey import Corridor, Survey
from missionkit.behaviors.waypoints import Waypoints
from missionkit.planning.route_following import Triple
from missionkit.planning.spiral_search import SpiralPath
from missionkit.recorder.palette import INK, MUTED, RULE

IMAGE = Path(__file__).parent / "images" / "patterns.png"
START: Triple = (0.0, 0.0, -10.0)
BLUE, AMBER = "#0072B2", "#E69F00"
FIELD = ((10.0, 5.0), (62.0, 0.0), (70.0, 45.0), (42.0, 30.0), (18.0, 52.0))
ROAD = ((10.0, 5.0), (40.0, 5.0), (62.0, 25.0), (62.0, 50.0))


def main() -> None:
    """Write the picture."""
    figure = Figure(figsize=(11.2, 6.4), dpi=100, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    panels = figure.subplots(2, 4).flat
    places = Waypoints(places=((10, 0), (40, 8), (52, 30), (20, 42)), height=10)
    _flown(next(panels), "waypoints", places.way(START, {}), dots=True)
    survey = Survey(polygon=FIELD, height=20, spacing=8)
    _flown(next(panels), "survey", survey.way(START, {}), outline=FIELD)
    corridor = Corridor(line=ROAD, breadth=14, height=20, spacing=5)
    _flown(next(panels), "corridor", corridor.way(START, {}), middle=ROAD)
    orbit = Orbit(target="tower", radius=18, turns=1)
    circle = orbit.way((8.0, 0.0, -10.0), {"tower": (32.0, 26.0, -10.0)})
    _flown(next(panels), "orbit", circle, middle=((32.0, 26.0),))
    square = ExpandingSquare(spacing=6, outer=24)
    _flown(next(panels), "expanding_square", square.way((0, 0, -10), {}), middle=((0.0, 0.0),))
    sector = Sector(radius=24)
    _flown(next(panels), "sector", sector.way((0, 0, -10), {}), middle=((0.0, 0.0),))
    for inner in (0.0, 8.0):
        _flown(next(panels), f"spiral, inner: {inner:g}", _spiral(inner), middle=((0.0, 0.0),))
    figure.savefig(IMAGE)


def _spiral(inner: float) -> list[Triple]:
    curve = SpiralPath.steady(2.0, 6.0, 24.0, inner)
    times = np.linspace(0.0, curve.duration, 300)
    spots = [curve.at(float(t)).position for t in times]
    return [(float(n), float(e), -10.0) for n, e, _ in spots]


def _flown(
    axes: Axes,
    name: str,
    way: Sequence[Triple],
    *,
    outline: Sequence[tuple[float, float]] = (),
    middle: Sequence[tuple[float, float]] = (),
    dots: bool = False,
) -> None:
    """Draw one pattern, north up."""
    axes.set_title(name, fontfamily="monospace", fontsize=11, color=INK)
    axes.set_aspect("equal")
    axes.margins(0.08)
    axes.tick_params(labelsize=8, colors=MUTED)
    axes.grid(color=RULE)
    for spine in axes.spines.values():
        spine.set_visible(False)
    if outline:
        north, east = zip(*outline, strict=True)
        axes.fill(east, north, facecolor=AMBER, alpha=0.15, edgecolor=AMBER)
    if middle:
        north, east = zip(*middle, strict=True)
        axes.plot(east, north, color=AMBER, marker="o", ms=5, lw=3, alpha=0.6)
    north, east, _ = zip(*way, strict=True)
    axes.plot(east, north, color=BLUE, lw=1.4, marker="o" if dots else "", ms=4)
    axes.plot(east[0], north[0], color=INK, marker="o", ms=5)


if __name__ == "__main__":
    main()
