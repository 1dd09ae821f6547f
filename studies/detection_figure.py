"""The picture of the study of detection: curves, groups, and what is found in some pictures."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle

from missionkit.messages import Frame
from missionkit.perception.haar.detector import Haar
from missionkit.plugin_protocols import Prior
from missionkit.sim.detector_samples import sample_of
from missionkit.sim.robot_views import RobotView, robot_views
from studies.canvas import LIMIT, page
from studies.detection_runs import GROUPS, Answers

COLOURS = {"haar": "#0072B2", "template": "#E69F00", "fused": "#009E73"}
LEAST, GOAL, FALSE = 0.2, 0.95, 0.1
FOUND, MISSED = "#3ddc84", "#ff5c4d"
EXAMPLES = 4


def draw(path: Path, results: Mapping[str, Mapping[str, Answers]], seed: int) -> None:
    """Draw a PNG of 1200 x 1000 px.

    Args:
        path: of the picture.
        results: by group and detector.
        seed: of the pictures that are shown.
    """
    it = results["other floors"]["haar"]
    subtitle = (
        f"320 x 240 px, 1.5 to 3 m; floors never seen: {100 * it.recall(LEAST):.1f} % of "
        f"{it.robots} robots by Haar, {it.false(LEAST):.3f} false; green found, red missed"
    )
    with page(path, 1200, 1000, "Ground robots found from above", subtitle) as figure:
        grid = figure.add_gridspec(
            2, 1, height_ratios=(1.9, 1), left=0.07, right=0.98, top=0.88, bottom=0.02, hspace=0.22
        )
        upper = grid[0].subgridspec(1, 2, wspace=0.5)
        _curves(figure.add_subplot(upper[0]), results)
        _groups(figure.add_subplot(upper[1]), results)
        lower = grid[1].subgridspec(1, EXAMPLES, wspace=0.04)
        names = ("as trained", "other floors", "other light", "all at once")[:EXAMPLES]
        for number, (cell, name) in enumerate(zip(lower, names, strict=True)):
            (view,) = robot_views(GROUPS[name], 1, seed + number)
            _example(figure.add_subplot(cell), name, view)


def _curves(axes: Axes, results: Mapping[str, Mapping[str, Answers]]) -> None:
    for name, style in (("as trained", "-"), ("other floors", "--")):
        for detector, colour in reversed(COLOURS.items()):
            it = results[name][detector]
            scores = np.unique(np.concatenate([it.wrong, it.right, [0.0]]))
            false = np.array([it.false(least) for least in scores])
            recall = np.array([it.recall(least) for least in scores])
            label = f"{detector}, {'floors as trained' if style == '-' else 'other floors'}"
            wide = 4.0 if detector == "fused" else 1.8  # where both run, Haar lies on top
            axes.plot(np.maximum(false, 2e-3), recall, style, color=colour, lw=wide, label=label)
    axes.axvline(FALSE, color=LIMIT, lw=1.2)
    axes.axhline(GOAL, color=LIMIT, lw=1.2)
    axes.set_xscale("log")
    axes.set_xlim(2e-3, 5.0)
    ticks = (0.01, 0.1, 1.0)
    axes.set_xticks(ticks, [f"{it:g}" for it in ticks])
    axes.set_ylim(0.0, 1.02)
    axes.set_xlabel("false a picture (left edge: none); red: the goal, 95 % at 0.1")
    axes.set_ylabel("robots found")
    axes.grid(visible=True)
    axes.legend(frameon=False, fontsize=9, loc="lower right")


def _groups(axes: Axes, results: Mapping[str, Mapping[str, Answers]]) -> None:
    names, at = list(results), np.arange(len(results))
    for shift, detector in enumerate(("haar", "fused")):
        recall = [100.0 * results[name][detector].recall(LEAST) for name in names]
        axes.barh(at + 0.36 * shift, recall, 0.34, color=COLOURS[detector], label=detector)
        for y, value, name in zip(at + 0.36 * shift, recall, names, strict=True):
            false = results[name][detector].false(LEAST)
            axes.text(value - 1.0, y, f"{value:.1f} %, {false:.2f} false", va="center", ha="right",
                      color="white", fontsize=9)  # fmt: skip
    axes.axvline(100.0 * GOAL, color=LIMIT, lw=1.2)
    axes.set_yticks(at + 0.18, names)
    axes.invert_yaxis()
    axes.set_xlim(0.0, 100.0)
    axes.set_xlabel(f"robots found with a score of {LEAST:g}, %")
    axes.legend(frameon=False, fontsize=9, ncols=2, loc="upper left", bbox_to_anchor=(0, 1.1))


def _example(axes: Axes, name: str, view: RobotView) -> None:
    """Draw a picture: green what is found, red what is missed."""
    axes.imshow(view.image, cmap="gray", vmin=0, vmax=float(np.percentile(view.image, 99.5)))
    axes.set_title(name, fontsize=10)
    boxes = Haar().boxes(Frame(0.0, view.image), view.camera, Prior(view.body, None))
    for box in boxes:
        corner = box.centre - 0.5 * np.array(box.size)
        axes.add_patch(Rectangle(tuple(corner), *box.size, fill=False, ec=FOUND, lw=2.0))
        axes.text(*(corner - 2.0), f"{box.score:.2f}", color=FOUND, fontsize=9, va="bottom")
    sample = sample_of(view)
    for place in () if sample is None else sample.places:
        if all(np.hypot(*(place - box.centre)) > 0.5 * box.size[0] for box in boxes):
            axes.plot(*place, "x", color=MISSED, ms=14, mew=3)
    axes.set_axis_off()
