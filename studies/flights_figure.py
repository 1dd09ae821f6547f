"""The picture of the flights: how exact, how clear of obstacles, how long."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, MaxNLocator, NullLocator

from missionkit.recorder.palette import INK, MUTED
from studies.canvas import empty, limit, page
from studies.flight import Run
from studies.losses import Loss, losses_of
from studies.statistics import spread

COLOURS = ("#0072B2", "#E69F00")
STYLES: tuple[dict[str, Any], ...] = (
    {"alpha": 0.55, "zorder": 2},
    {"histtype": "step", "lw": 2.2, "zorder": 3},
)
PHASES = ("gps", "visual", "search", "task", "return")


class Scale(NamedTuple):
    """The axis of a histogram: its edges, its label, and the limit that matters."""

    bins: list[float]
    label: str
    limit: float
    text: str
    side: str = "right"  # of the text, as `ha`


def draw_flights(path: Path, groups: Mapping[str, Sequence[Run]], subtitle: str) -> None:
    """Draw two groups of flights into a PNG of 1200 x 1000 px.

    Args:
        path: of the picture.
        groups: flights by what they have in common; the last group lost the marker on the way.
        subtitle: the result in one line.
    """
    with page(path, 1200, 1000, "Precision task", subtitle) as figure:
        grid = figure.add_gridspec(
            3, 2, hspace=0.52, wspace=0.16, left=0.06, right=0.97, top=0.845, bottom=0.065
        )
        panels = [figure.add_subplot(grid[row, column]) for row in range(3) for column in (0, 1)]
        titles = ("Position error on entry", "Heading error on entry", "Least clearance on the way")
        for axes, title, scale, values in zip(
            panels, titles, _scales(groups), _measures(groups), strict=False
        ):
            axes.set_title(title, pad=10)
            _histogram(axes, values, scale)
        _draw_stays(panels[3], groups)
        lost = [loss for runs in groups.values() for loss in losses_of(runs)]
        _draw_losses(panels[4:], lost)
        _legend(figure, groups)


def _measures(groups: Mapping[str, Sequence[Run]]) -> list[list[list[float]]]:
    """Return position error (cm), heading error (deg), clearance on the way (m), each by group."""
    visits = [[run.grade.visit for run in runs] for runs in groups.values()]
    return [
        [[100.0 * v.position_error for v in group if v is not None] for group in visits],
        [
            [math.degrees(v.yaw_error) for v in group if v is not None and v.yaw_error is not None]
            for group in visits
        ],
        [[run.passed for run in runs] for runs in groups.values()],
    ]


def _scales(groups: Mapping[str, Sequence[Run]]) -> tuple[Scale, Scale, Scale]:
    clearest = max([1.0, *(run.passed for runs in groups.values() for run in runs)])
    angles = np.geomspace(0.01, 10.0, 31).tolist()
    return (
        Scale(_bins(0.0, 12.0, 0.5), "cm from the true goal", 10.0, "10 cm allowed"),
        Scale(angles, "deg from the true heading", 5.0, "5° allowed"),
        Scale(_bins(-0.1, clearest, 0.1), "m to the nearest surface", 0.0, "touch", "left"),
    )


def _bins(first: float, last: float, width: float) -> list[float]:
    return np.arange(first, last + width, width).tolist()


def _histogram(axes: Axes, values: Sequence[Sequence[float]], scale: Scale) -> None:
    """Draw each group as a share of its own flights, so that groups of any size compare."""
    first, last = scale.bins[0], scale.bins[-1]
    for group, colour, style in zip(values, COLOURS, STYLES, strict=False):
        shares = np.full(len(group), 100.0 / max(len(group), 1))
        inside = np.clip(group, first, last)
        axes.hist(inside, scale.bins, weights=shares, color=colour, **style)
        if len(group):
            middle = spread(group).p50
            axes.plot(middle, 0.0, "^", color=colour, ms=9, mec="white", clip_on=False, zorder=6)
    if first > 0.0:
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
    axes.set_xlim(first, last)
    axes.set_xlabel(scale.label)
    axes.set_ylabel("% of flights")
    axes.yaxis.set_major_locator(MaxNLocator(5, integer=True))
    axes.grid(axis="y")
    limit(axes, scale.limit, scale.text, ha=scale.side)


def _draw_stays(axes: Axes, groups: Mapping[str, Sequence[Run]]) -> None:
    """Draw the length of every stay in each state as a dot, and the median as a bar."""
    axes.set_title("Time in each state", pad=10)
    rng = np.random.default_rng(0)
    for index, (runs, colour) in enumerate(zip(groups.values(), COLOURS, strict=False)):
        for row, state in enumerate(PHASES):
            stays = [stay for run in runs for stay in run.stays(state)]
            if not stays:
                continue
            middle = row + 0.19 * (2 * index - len(groups) + 1)
            heights = middle + rng.uniform(-0.12, 0.12, len(stays))
            axes.scatter(stays, heights, s=13, color=colour, alpha=0.5, lw=0, zorder=2)
            p50 = spread(stays).p50
            axes.plot([p50, p50], [middle - 0.17, middle + 0.17], color=INK, lw=2.2, zorder=3)
    axes.set_yticks(range(len(PHASES)), PHASES, color=INK)
    axes.set_ylim(len(PHASES) - 0.45, -0.55)
    axes.set_xlim(left=0.0)
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel("s, each dot a stay, bars the medians")
    axes.grid(axis="x")


def _draw_losses(panels: Sequence[Axes], losses: Sequence[Loss]) -> None:
    if not losses:
        for axes in panels:
            empty(axes, "no flight lost its marker")
        return
    found = [loss.found for loss in losses if loss.found is not None]
    _strip(
        panels[0],
        "From the last sighting to the search",
        [loss.lost for loss in losses],
        2.0,
        "2.0 s asked for",
    )
    _strip(panels[1], "From the marker's return to the lock", found, None, "")


def _strip(axes: Axes, title: str, times: Sequence[float], asked: float | None, text: str) -> None:
    axes.set_title(title, pad=10)
    top = max([3.0, *times]) * 1.08
    axes.hist(times, _bins(0.0, top, 0.1), color=COLOURS[1], edgecolor="white", zorder=2)
    axes.set_xlim(0.0, top)
    axes.set_xlabel("s")
    axes.set_ylabel("flights")
    axes.yaxis.set_major_locator(MaxNLocator(4, integer=True))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.grid(axis="y")
    if asked is not None:
        limit(axes, asked, text)


def _legend(figure: Figure, groups: Mapping[str, Sequence[Run]]) -> None:
    at = 0.0335
    for (name, runs), colour in zip(groups.items(), COLOURS, strict=False):
        text = figure.text(at, 0.901, "■", color=colour, fontsize=14, va="center")
        label = f"{name}, {len(runs)} flights"
        text = figure.text(at + 0.018, 0.9015, label, color=INK, fontsize=11.5, va="center")
        box = text.get_window_extent().transformed(figure.transFigure.inverted())
        at = box.x1 + 0.025
    figure.text(0.97, 0.9015, "▲ median", color=MUTED, fontsize=11.5, va="center", ha="right")
