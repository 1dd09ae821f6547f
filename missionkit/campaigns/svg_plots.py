"""Plots as SVG elements, drawn without other programs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from html import escape

import numpy as np

from missionkit.campaigns.statistics import ConfidenceInterval, wilson
from missionkit.recorder.palette import INK, MUTED, RULE

GOOD, FAIR, BAD = "#009E73", "#E69F00", "#D55E00"
PLOT_LEFT, PLOT_RIGHT, PLOT_BOTTOM, PLOT_TOP = 46.0, 12.0, 26.0, 10.0
FEWEST_BARS, MOST_BARS = 8, 24  # bars of a histogram


def svg(width: float, height: float, parts: Iterator[str], title: str) -> str:
    """Return an SVG element with an accessible name.

    Args:
        width: px.
        height: px.
        parts: elements, already escaped.
        title: read out by screen readers; escaped here.
    """
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:.0f} {height:.0f}" '
        f'width="{width:.0f}" role="img" aria-label="{escape(title)}">{"".join(parts)}</svg>'
    )


def rates(
    named: Sequence[tuple[str, ConfidenceInterval]], goal: float | None = None, width: float = 640.0
) -> str:
    """Draw success rates with their intervals, one below the other.

    Args:
        named: label and success rate (0 to 1) of each row, from the top.
        goal: 0 to 1, drawn as a dashed line.
        width: px.
    """
    side = min(260.0, 30.0 + 7.0 * max((len(name) for name, _ in named), default=0))
    low = min([interval.low for _, interval in named] + ([] if goal is None else [goal]))
    floor = max(0.0, math.floor(20 * low - 0.5) / 20)

    def x(rate: float) -> float:
        return side + (width - side - 30.0) * (rate - floor) / (1.0 - floor)

    height = 30.0 * len(named) + PLOT_BOTTOM + PLOT_TOP

    def parts() -> Iterator[str]:
        for rate in _ticks(floor, 1.0):
            yield _line(x(rate), PLOT_TOP, x(rate), height - PLOT_BOTTOM, RULE)
            yield _text(x(rate), height - 8, f"{100 * rate:g} %", "middle")
        if goal is not None:
            yield _line(x(goal), PLOT_TOP - 6, x(goal), height - PLOT_BOTTOM, BAD, dash=True)
        for n, (name, it) in enumerate(named):
            y = PLOT_TOP + 30.0 * n + 15.0
            yield _text(side - 10, y + 4, name, "end", INK)
            yield _line(x(it.low), y, x(it.high), y, GOOD, 5.0)
            if math.isfinite(it.value):
                yield f'<circle cx="{x(it.value):.1f}" cy="{y:.1f}" r="6" fill="{GOOD}"/>'

    return svg(width, height, parts(), "success rates")


def running(
    successes: Sequence[bool], goal: float | None = None, size: tuple[float, float] = (640.0, 190.0)
) -> str:
    """Draw how the success rate and its interval settled as runs came in.

    Args:
        successes: of each run, in the order in which they came in.
        goal: 0 to 1, drawn as a dashed line.
        size: width and height, px.
    """
    width, height = size
    n = len(successes)
    counts = np.unique(np.linspace(1, n, min(n, 200)).astype(int)) if n else np.array([], int)
    good = np.cumsum(successes)
    bands = [(int(k), wilson(int(good[k - 1]), int(k))) for k in counts]
    floor = max(0.0, math.floor(10 * min([b.low for _, b in bands[len(bands) // 8 :]] or [0])) / 10)

    def x(k: float) -> float:
        return PLOT_LEFT + (width - PLOT_LEFT - PLOT_RIGHT) * k / max(n, 1)

    def y(rate: float) -> float:
        return PLOT_TOP + (height - PLOT_TOP - PLOT_BOTTOM) * (1.0 - max(rate, floor)) / (
            1.0 - floor
        )

    def parts() -> Iterator[str]:
        for rate in _ticks(floor, 1.0):
            yield _line(PLOT_LEFT, y(rate), width - PLOT_RIGHT, y(rate), RULE)
            yield _text(PLOT_LEFT - 6, y(rate) + 4, f"{100 * rate:g} %", "end")
        for k in _ticks(0, n):
            yield _text(x(k), height - 8, f"{k:g}", "middle")
        upper = [f"{x(k):.1f},{y(b.high):.1f}" for k, b in bands]
        lower = [f"{x(k):.1f},{y(b.low):.1f}" for k, b in reversed(bands)]
        yield f'<polygon points="{" ".join(upper + lower)}" fill="{GOOD}" fill-opacity=".2"/>'
        line = " ".join(f"{x(k):.1f},{y(b.value):.1f}" for k, b in bands)
        yield f'<polyline points="{line}" fill="none" stroke="{GOOD}" stroke-width="2"/>'
        if goal is not None:
            yield _line(PLOT_LEFT, y(goal), width - PLOT_RIGHT, y(goal), BAD, dash=True)

    return svg(width, height, parts(), "success rate as runs came in")


def histogram(
    good: Sequence[float], bad: Sequence[float], title: str, size: tuple[float, float] = (312, 150)
) -> str:
    """Draw how a number is spread; runs without success stand on those with, in another colour.

    Args:
        good: values of the runs with success, in the unit of the axis.
        bad: values of the other runs.
        title: read out by screen readers.
        size: width and height, px.
    """
    width, height = size
    both = np.array([*good, *bad], dtype=float)
    low, high = (float(both.min()), float(both.max())) if len(both) else (0.0, 1.0)
    if high - low < 1e-9:
        low, high = low - 0.5, high + 0.5
    bars = min(MOST_BARS, max(FEWEST_BARS, round(2 * math.sqrt(len(both)))))
    edges = np.linspace(low, high, bars + 1)
    first, second = np.histogram(good, edges)[0], np.histogram(bad, edges)[0]
    tallest = max(1, int((first + second).max()))

    def x(value: float) -> float:
        return PLOT_LEFT - 14 + (width - PLOT_LEFT - PLOT_RIGHT + 4) * (value - low) / (high - low)

    def tall(count: float) -> float:
        return (height - PLOT_TOP - PLOT_BOTTOM) * count / tallest

    def parts() -> Iterator[str]:
        base = height - PLOT_BOTTOM
        yield _line(x(low), base, x(high), base, MUTED)
        yield _text(x(low) - 5, PLOT_TOP + 10, str(tallest), "end")
        for tick in _ticks(low, high, 4):
            yield _text(x(tick), height - 9, f"{tick:g}", "middle")
        for n in range(bars):
            wide = x(edges[n + 1]) - x(edges[n]) - 1.0
            up, more = tall(float(first[n])), tall(float(second[n]))
            yield _bar(x(edges[n]), base - up, wide, up, GOOD)
            yield _bar(x(edges[n]), base - up - more, wide, more, BAD)

    return svg(width, height, parts(), title)


def _bar(x: float, y: float, width: float, height: float, fill: str) -> str:
    if height <= 0.0:
        return ""
    shape = f'x="{x:.1f}" y="{y:.1f}" width="{width:.1f}" height="{height:.1f}"'
    return f'<rect {shape} fill="{fill}"/>'


def _line(
    x: float, y: float, u: float, v: float, stroke: str, wide: float = 1.0, *, dash: bool = False
) -> str:
    ends = f'x1="{x:.1f}" y1="{y:.1f}" x2="{u:.1f}" y2="{v:.1f}"'
    dashes = ' stroke-dasharray="6 4" stroke-width="1.6"' if dash else f' stroke-width="{wide:g}"'
    return f'<line {ends} stroke="{stroke}"{dashes}/>'


def _text(x: float, y: float, words: str, anchor: str, fill: str = MUTED) -> str:
    place = f'x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="12" fill="{fill}"'
    return f"<text {place}>{escape(words)}</text>"


def _ticks(low: float, high: float, most: int = 6) -> list[float]:
    """Return round numbers from `low` to `high`, at most about `most`."""
    if high <= low:
        return [low]
    raw = (high - low) / most
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(s * power for s in (1, 2, 2.5, 5, 10) if s * power >= raw * (1 - 1e-9))
    first = math.ceil(low / step - 1e-9)
    return [round(k * step, 10) for k in range(first, math.floor(high / step + 1e-9) + 1)]
