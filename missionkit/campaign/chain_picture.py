"""The chart as it was flown: how often each way was taken, drawn as SVG."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from itertools import pairwise
from typing import NamedTuple

from missionkit.campaign.chain import Chain
from missionkit.campaign.plots import BAD, GOOD, INK, MUTED, svg
from missionkit.chart.drawing.layout import Box, Layout, Link, Point, layout

STATE, LABEL = Box(118.0, 46.0), Box(86.0, 34.0)
PAD = 16.0
TIP = (
    '<defs><marker id="flown" viewBox="0 0 10 10" refX="9.5" refY="5" markerWidth="9" '
    f'markerHeight="9" orient="auto" markerUnits="userSpaceOnUse">'
    f'<path d="M0 0L10 5L0 10z" fill="{MUTED}"/></marker></defs>'
)


class _Flow(NamedTuple):
    """An arrow: how many times it was taken, and of the visits to its source which share."""

    source: int
    target: int
    times: int
    share: float


def picture(chain: Chain) -> str:
    """Draw states with the mean time of a visit, endings, and every move that was made."""
    n = len(chain.states)
    flows = list(_flows(chain))
    nodes = [STATE] * (n + len(chain.endings))
    links = [Link(flow.source, flow.target, LABEL) for flow in flows]
    initial = max(range(n), key=lambda state: chain.starts[state])
    placed = layout(nodes, links, initial, range(n, len(nodes)))

    def parts() -> Iterator[str]:
        yield TIP
        yield f'<g transform="translate({PAD} {PAD})">'
        yield from _arrows(placed, flows, int(chain.starts.sum()))
        yield from _states(placed, chain)
        yield "</g>"

    size = placed.width + 2 * PAD, placed.height + 2 * PAD
    return svg(*size, parts(), "the chart as it was flown")


def _flows(chain: Chain) -> Iterator[_Flow]:
    n = len(chain.states)
    for counts, shares, first in (
        (chain.moves, chain.inner, 0),
        (chain.ends, chain.outer, n),
    ):
        for source, row in enumerate(counts.tolist()):
            for target, count in enumerate(row):
                if count > 0:
                    share = float(shares[source, target])
                    yield _Flow(source, first + target, int(count), share)


def _arrows(placed: Layout, flows: list[_Flow], flights: int) -> Iterator[str]:
    for route, flow in zip(placed.routes, flows, strict=True):
        wide = 1.2 + 5.0 * min(1.0, flow.times / max(flights, 1))
        yield (
            f'<path d="{_curve(route)}" fill="none" stroke="{MUTED}" stroke-opacity=".75" '
            f'stroke-width="{wide:.1f}" marker-end="url(#flown)"/>'
        )
    for (x, y), flow in zip(placed.labels, flows, strict=True):
        yield _box(x, y, LABEL, "#fff", "none", 4)
        yield _text(x, y - 2, f"{100 * flow.share:.3g} %", 13)
        yield _text(x, y + 12, f"{flow.times} times", 11, MUTED)


def _states(placed: Layout, chain: Chain) -> Iterator[str]:
    n = len(chain.states)
    for (x, y), name, dwell in zip(placed.states, chain.states, chain.dwell.tolist(), strict=False):
        yield _box(x, y, STATE, "#EEF2F6", MUTED, 10)
        yield _text(x, y - 3, name, 14, bold=True)
        yield _text(x, y + 14, f"{dwell:.1f} s a visit", 11, MUTED)
    for (x, y), (outcome, state) in zip(placed.states[n:], chain.endings, strict=True):
        good = outcome == "success"
        yield _box(x, y, STATE, "#E2F4EE" if good else "#FBEAE0", GOOD if good else BAD, 22)
        yield _text(x, y - 3, outcome.replace("_", " "), 14, bold=True)
        yield _text(x, y + 14, f"in {state}", 11, MUTED)


def _curve(points: tuple[Point, ...]) -> str:
    path = f"M{points[0][0]:.1f} {points[0][1]:.1f}"
    for (x, y), (u, v) in pairwise(points):
        middle = (y + v) / 2
        path += f"C{x:.1f} {middle:.1f} {u:.1f} {middle:.1f} {u:.1f} {v:.1f}"
    return path


def _box(x: float, y: float, size: Box, fill: str, stroke: str, radius: float) -> str:
    place = f'x="{x - size.width / 2:.1f}" y="{y - size.height / 2:.1f}"'
    shape = f'width="{size.width:.0f}" height="{size.height:.0f}" rx="{radius:g}"'
    return f'<rect {place} {shape} fill="{fill}" fill-opacity=".94" stroke="{stroke}"/>'


def _text(x: float, y: float, words: str, size: int, fill: str = INK, *, bold: bool = False) -> str:
    weight = ' font-weight="bold"' if bold else ""
    place = f'x="{x:.1f}" y="{y:.1f}" text-anchor="middle" font-size="{size}"{weight}'
    return f'<text {place} fill="{fill}">{escape(words)}</text>'
