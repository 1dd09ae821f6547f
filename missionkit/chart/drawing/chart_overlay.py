"""Overlay of a drawing: notes on parts of the chart, and edges that the chart does not have.

Plain words and weights: the maker of an overlay knows their meaning, the drawing does not.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, NamedTuple

from missionkit.chart.drawing.problem_marks import Way

Tone = Literal["good", "fair", "bad"]


class OverlayNote(NamedTuple):
    """Note at a state, a transition or a failsafe."""

    lines: tuple[str, ...] = ()
    weight: float = 0.0  # of an arrow, from 0 to 1
    pale: bool = False


class End(NamedTuple):
    """A way for all to end; drawn as a box of its own."""

    name: str
    lines: tuple[str, ...]
    tone: Tone


class UndeclaredArrow(NamedTuple):
    """An arrow that the chart does not declare."""

    source: str  # state
    to: str  # state, or name of an end
    text: str
    note: OverlayNote
    ends: bool = False  # leads to an end; others are drawn dashed


@dataclass(frozen=True, slots=True)
class Overlay:
    """Notes of a chart, its ends, more arrows, and a heading with lines that explain them."""

    states: Mapping[str, OverlayNote] = field(default_factory=dict)
    ways: Mapping[Way, OverlayNote] = field(default_factory=dict)
    failsafes: Mapping[str, OverlayNote] = field(default_factory=dict)
    ends: tuple[End, ...] = ()
    moves: tuple[UndeclaredArrow, ...] = ()
    lines: tuple[str, ...] = ()


NO_OVERLAY = Overlay()
NO_NOTE = OverlayNote()
