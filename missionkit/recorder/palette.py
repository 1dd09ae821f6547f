"""Colours that remain apart for colour-blind readers.  Source: Okabe and Ito, 2008."""

from __future__ import annotations

from collections.abc import Iterable

STATES = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#8C6D31", "#5E4FA2")
HOLDS, NOT, UNKNOWN = "#009E73", "#D9DCE0", "#F0A30A"
INK, MUTED, RULE = "#1F2933", "#6B7785", "#E4E7EB"
WOOD, WOOD_EDGE = "#D6CCBE", "#9C8B75"


def colours(states: Iterable[str]) -> dict[str, str]:
    """Give each state a colour, in order of its first visit; after eight they repeat."""
    names = dict.fromkeys(states)
    return {name: STATES[i % len(STATES)] for i, name in enumerate(names)}
