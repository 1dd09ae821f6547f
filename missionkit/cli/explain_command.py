"""A chart in sentences, set to the width of the terminal."""

from __future__ import annotations

import shutil
import textwrap
from collections.abc import Iterable

from missionkit.chart.prose.state_text import Sentences

INDENT = 2
BULLET = "- "
NARROWEST_PAGE, WIDEST_PAGE = 40, 100


def width() -> int:
    """Return how wide a page is set: as the terminal is, within reason."""
    return max(NARROWEST_PAGE, min(shutil.get_terminal_size((80, 24)).columns, WIDEST_PAGE))


def page(paragraphs: Iterable[Sentences], width: int) -> str:
    """Return paragraphs one below the other, an empty line above each that begins a topic."""
    blocks = [_wrapped(each, width) for each in paragraphs]
    return "\n".join(blocks).strip("\n")


def _wrapped(paragraph: Sentences, width: int) -> str:
    margin = " " * INDENT * paragraph.depth
    bullet = BULLET if paragraph.item else ""
    lines = textwrap.fill(
        paragraph.text,
        max(width, len(margin) + NARROWEST_PAGE // 2),
        initial_indent=margin + bullet,
        subsequent_indent=margin + " " * len(bullet),
        break_on_hyphens=False,
        break_long_words=False,
    )
    return f"\n{lines}" if paragraph.topic else lines
