"""Colours and line styles that remain apart, also for colour-blind readers.

Source: Okabe and Ito, "Color universal design", 2008, without black and yellow; wine and indigo
of P. Tol, "Colour schemes", 2021, which keep a CIELAB distance of 16 from these and from each other
under simulated deuteranopia, protanopia and tritanopia.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

STATE_COLOURS = (
    "#0072B2",
    "#D55E00",
    "#009E73",
    "#CC79A7",
    "#E69F00",
    "#56B4E9",
    "#882255",
    "#332288",
)
HOLDS_COLOUR, HOLDS_NOT_COLOUR, UNKNOWN_COLOUR = "#009E73", "#D9DCE0", "#F0A30A"
INK, MUTED, RULE = "#1F2933", "#6B7785", "#E4E7EB"
WOOD, WOOD_EDGE = "#D6CCBE", "#9C8B75"
FENCE_COLOUR, FENCE_DASHES = "#B3261E", (0, (6.0, 3.0))
HOME_COLOUR = "#009E73"
DASHES: tuple[Any, ...] = ("solid", (0, (3.2, 1.0)), (0, (1.0, 0.7)), (0, (4.5, 0.8, 0.9, 0.8)))
MARKERS = ("", "o", "s", "^", "D")
BRIGHT = 0.35  # luminance above which dark letters are read more easily


class Style(NamedTuple):
    """How the line of a state is drawn: markers and dashes tell lines of one colour apart."""

    colour: str
    dashes: Any = "solid"
    marker: str = ""

    @property
    def line(self) -> dict[str, Any]:
        """The keywords of a matplotlib line."""
        return {
            "color": self.colour,
            "linestyle": self.dashes,
            "dash_capstyle": "butt",
            "solid_capstyle": "round",
            "marker": self.marker or None,
            "markeredgecolor": "white",
            "markeredgewidth": 0.6,
        }


OTHER_STYLE = Style(MUTED)
MOST_STYLES = len(STATE_COLOURS) * len(DASHES) * len(MARKERS)


def styles(states: Iterable[str]) -> dict[str, Style]:
    """Give each state a style, in order of its first visit; states after `MOST_STYLES` share one.

    >>> styles(["idle", "gps", "idle"])["gps"].colour
    '#D55E00'
    """
    found = {}
    for i, name in enumerate(dict.fromkeys(states)):
        turn = i // len(STATE_COLOURS)
        found[name] = OTHER_STYLE
        if i < MOST_STYLES:
            marker = MARKERS[turn // len(DASHES)]
            found[name] = Style(
                STATE_COLOURS[i % len(STATE_COLOURS)], DASHES[turn % len(DASHES)], marker
            )
    return found


def darker(colour: str) -> str:
    """Return a colour in which thin letters on white are read.

    >>> darker("#E69F00")
    '#8a5f00'
    """
    return f"#{''.join(f'{int(0.6 * part):02x}' for part in _parts(colour))}"


def letters_on(colour: str) -> str:
    """Return the colour of letters that are read on a colour.

    >>> letters_on("#E69F00"), letters_on("#0072B2")
    ('#1F2933', 'white')
    """
    red, green, blue = (part / 255.0 for part in _parts(colour))
    bright = 0.2126 * red**2.2 + 0.7152 * green**2.2 + 0.0722 * blue**2.2
    return INK if bright > BRIGHT else "white"


def disc(colour: str) -> dict[str, Any]:
    """Return the keywords of the disc behind the number of a transition."""
    shape = "round,pad=0.28,rounding_size=0.9"
    return {"boxstyle": shape, "facecolor": colour, "edgecolor": "white", "lw": 1.0}


def _parts(colour: str) -> list[int]:
    return [int(colour[at : at + 2], 16) for at in (1, 3, 5)]
