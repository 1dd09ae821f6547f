"""The pictures of the known map: the paths of both variants, and how clear the flights stayed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator

from missionkit.messages import Occupancy
from missionkit.planning.map_inflation import inflated
from missionkit.planning.route_planning import Route
from missionkit.recorder.palette import INK, MUTED, STATE_COLOURS
from studies.canvas import limit, page
from studies.known_map_flight import Run

SHOWN = 12  # flights drawn
CLEARANCE = 0.5  # m


def draw_paths(
    path: Path, known: Occupancy, margin: float, routes: Mapping[str, Route], runs: Sequence[Run]
) -> None:
    """Draw each variant's path over the map, and where some flights went, into a PNG.

    Args:
        path: of the picture.
        known: the map.
        margin: kept from walls (m).
        routes: by variant.
        runs: flights.
    """
    said = ", ".join(f"{name} {route.length:.1f} m" for name, route in routes.items())
    with page(path, 1500, 720, "Paths over the known map", said) as figure:
        grid = figure.add_gridspec(1, len(routes), left=0.045, right=0.985, top=0.83, bottom=0.08)
        for count, (name, route) in enumerate(routes.items()):
            axes = figure.add_subplot(grid[0, count])
            axes.set_title(f"{name}: {route.length:.2f} m, {len(route.spots)} points", pad=10)
            _ground(axes, known, margin)
            for run in [run for run in runs if run.variant == name][:SHOWN]:
                axes.plot(
                    run.places[:, 1], run.places[:, 0], color=STATE_COLOURS[5], lw=0.9, alpha=0.7
                )
            north, east = np.array(route.spots).T
            axes.plot(east, north, color=STATE_COLOURS[0], lw=2.4)
            axes.plot(east[[0, -1]], north[[0, -1]], "o", color=INK, ms=7)
            axes.set_xlabel("east, m")
            if not count:
                axes.set_ylabel("north, m")


def draw_clearance(path: Path, runs: Sequence[Run]) -> None:
    """Draw how near to a wall each flight came, into a PNG."""
    variants = list(dict.fromkeys(run.variant for run in runs))
    least = min(run.clearance for run in runs)
    flights = sum(run.variant == variants[0] for run in runs)
    said = f"{flights} flights of each variant; the nearest came to {least:.2f} m"
    with page(path, 1200, 560, "Least clearance of a flight", said) as figure:
        axes = figure.add_axes((0.06, 0.12, 0.91, 0.66))
        bins = np.arange(0.3, 1.0, 0.02)
        for count, name in enumerate(variants):
            values = [run.clearance for run in runs if run.variant == name]
            axes.hist(
                np.clip(values, bins[0], bins[-1]),
                list(bins),
                histtype="step",
                lw=2.2,
                color=STATE_COLOURS[count],
                label=name,
            )
        limit(axes, CLEARANCE, "to be kept")
        axes.set_xlabel("from the vehicle's surface to the nearest wall, in truth, m")
        axes.set_ylabel("flights")
        axes.yaxis.set_major_locator(MaxNLocator(integer=True))
        axes.legend(frameon=False)


def _ground(axes: Axes, known: Occupancy, margin: float) -> None:
    wide = np.isinf(inflated(known.costs, margin / known.resolution))
    shade = np.where(np.isinf(known.costs), 1.0, np.where(wide, 0.22, 0.0))
    rows, columns = known.costs.shape
    (south, west), (north, east) = known.spot(0, 0), known.spot(rows, columns)
    axes.imshow(
        shade, cmap="Greys", vmin=0.0, vmax=1.4, origin="lower", extent=(west, east, south, north)
    )
    axes.tick_params(colors=MUTED)
    axes.set_aspect("equal")
    axes.grid(visible=False)
