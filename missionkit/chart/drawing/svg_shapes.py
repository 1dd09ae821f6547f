"""The elements of a picture as SVG text, and how large words are."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape
from itertools import pairwise
from textwrap import wrap

from missionkit.chart.drawing.layered_layout import Point
from missionkit.chart.drawing.nested_layout import Rectangle

PICTURE_MARGIN = 24.0
LINE = 15.0
LIST_WIDTH = 110  # characters
RED, ARROW_INK, PALE = "#c81e1e", "#4b5563", "#b6bdc8"
HEAVIEST = 4.0  # px that a weight of 1 adds to an arrow
TIPS = {"arrow": (ARROW_INK, 8), "heavy": (ARROW_INK, 13), "red": (RED, 8), "pale": (PALE, 8)}
STYLE_SHEET = (
    "text{font-family:Helvetica,Arial,'DejaVu Sans',sans-serif;fill:#1f2937}",
    ".title{font-size:19px;font-weight:bold}",
    ".name{font-size:15px;font-weight:bold}",
    ".small{font-size:12px}",
    ".note{font-size:12px;font-weight:bold}",
    f".box{{stroke:{ARROW_INK};stroke-width:1.4}}",
    ".around{fill-opacity:.35}",
    ".region{stroke-dasharray:6 4}",
    f".box.pale{{stroke:{PALE};fill-opacity:.25}}",
    ".good{fill:#d9f2e6;stroke:#007a59}",
    ".fair{fill:#fdf1cf;stroke:#9a6b00}",
    ".bad{fill:#fbdcd3;stroke:#b34d00}",
    f".arrow{{fill:none;stroke:{ARROW_INK};stroke-width:1.4}}",
    f".arrow.pale{{stroke:{PALE}}}",
    ".arrow.dashed{stroke-dasharray:7 5}",
    ".strip{fill:#fdf2f2;stroke:#d08a8a}",
    ".strip.notes{fill:#f5f7f9;stroke:#b6bdc8}",
    ".label{fill:#fff;fill-opacity:.92}",
    f".marked{{stroke:{RED};stroke-width:2.6}}",
    f"text.marked{{fill:{RED};stroke:none}}",
    "text.pale{fill:#7b8594}",
)


def preamble(key: str) -> str:
    """Return the style of a picture, which holds inside it alone, and the tips of its arrows."""
    style = "".join(f".chart {rule}" for rule in STYLE_SHEET)
    return f"<style>{style}</style><defs>{''.join(_tip(key, name) for name in TIPS)}</defs>"


def _tip(key: str, name: str) -> str:
    fill, size = TIPS[name]
    return (
        f'<marker id="{key}{name}" viewBox="0 0 10 10" refX="9.5" refY="5" markerWidth="{size}" '
        f'markerHeight="{size}" orient="auto" markerUnits="userSpaceOnUse">'
        f'<path d="M0 0L10 5L0 10z" fill="{fill}"/></marker>'
    )


def arrow(route: Sequence[Point], style: str, key: str, weight: float) -> str:
    """Return an arrow along a route; `style` says how it looks, `weight` (0 to 1) how strong.

    Args:
        route: px, from the border of one box to that of another.
        style: CSS classes; `marked` and `pale` have tips of their own.
        key: prefix of the ids of the tips, one for each picture of a page.
        weight: 0 to 1, how much wider than the thinnest line.
    """
    kind = next((name for mark, name in (("marked", "red"), ("pale", "pale")) if mark in style), "")
    tip = kind or ("heavy" if weight > 0 else "arrow")
    wide = f' style="stroke-width:{1.4 + HEAVIEST * weight:.1f}"' if weight > 0 else ""
    return f'<path class="{style}"{wide} d="{_curve(route)}" marker-end="url(#{key}{tip})"/>'


def _curve(points: Sequence[Point]) -> str:
    """Return a smooth path that leaves and meets every layer vertically."""
    path = f"M{points[0][0]:.1f} {points[0][1]:.1f}"
    for (x, y), (u, v) in pairwise(points):
        middle = (y + v) / 2
        path += f"C{x:.1f} {middle:.1f} {u:.1f} {middle:.1f} {u:.1f} {v:.1f}"
    return path


def rectangle(place: Rectangle, style: str, radius: int, more: str = "") -> str:
    """Return a box with round corners.

    Args:
        place: centre and size, px.
        style: CSS class.
        radius: of the corners, px.
        more: further attributes, with a leading blank, already escaped.
    """
    x, y, box = place
    return (
        f'<rect class="{style}" x="{x - box.width / 2:.1f}" y="{y - box.height / 2:.1f}" '
        f'width="{box.width:.1f}" height="{box.height:.1f}" rx="{radius}"{more}/>'
    )


def text(line: str, x: float, y: float, style: str) -> str:
    """Return words in the middle of a place.

    Args:
        line: escaped here.
        x: px, centre of the words.
        y: px, baseline of the words.
        style: CSS class.
    """
    return (
        f'<text class="{style}" x="{x:.1f}" y="{y:.1f}" text-anchor="middle">{escape(line)}</text>'
    )


def width(line: str, character: float) -> float:
    """Return how wide words are (px), with so much for a character."""
    return character * len(line)


def listed(line: str) -> list[str]:
    """Return the lines of one item of a strip."""
    return wrap(line, LIST_WIDTH, subsequent_indent="    ", break_on_hyphens=False)


def strip_width(lines: Sequence[str]) -> float:
    """Return how wide a strip has to be (px)."""
    return max(width(line, 6.4) + 24 for line in lines)


def strip_height(lines: Sequence[str]) -> float:
    """Return how high a strip is (px), with the room below it."""
    return LINE * len(lines) + 16 + 14


def stacked(strips: Sequence[tuple[str, Sequence[str]]], y: float, wide: float) -> Iterator[str]:
    """Yield strips, each a style and lines, one below the other.

    Args:
        strips: CSS class and lines of each; a line with a leading blank is indented.
        y: px, top of the first strip.
        wide: px, of every strip.
    """
    for style, lines in strips:
        height = strip_height(lines)
        yield (
            f'<rect class="{style}" x="{PICTURE_MARGIN}" y="{y:.1f}" width="{wide:.1f}" '
            f'height="{height - 14:.1f}" rx="8"/>'
        )
        for at, line in enumerate(lines):
            indent = 12 + 16 * line.startswith(" ")
            top = y + 20 + LINE * at
            words = escape(line.strip())
            yield f'<text class="small" x="{PICTURE_MARGIN + indent}" y="{top:.1f}">{words}</text>'
        y += height
