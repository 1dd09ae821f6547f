"""The list of transitions of `track.png`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from matplotlib.axes import Axes

from missionkit.messages import Fired
from missionkit.recorder.flight_track import FlightTrack
from missionkit.recorder.palette import INK, MUTED, OTHER_STYLE, Style, disc, letters_on
from missionkit.recorder.plot_text import Font, Ruler

MOST_LISTED, LAST_LISTED = 24, 8
"""Rows; those of the end of the flight among them if there are more."""
ROWS = {1: 23.0, 2: 35.0}  # px, height of a row whose reason takes so many lines
COLUMN_GAP, STATES_SHARE = 20.0, 0.46  # px between columns; share of the panel that states take
BOLD_FONT = Font(10.0, "bold")
PLAIN_FONT = Font(10.0)
SMALL_FONT = Font(9.0)
COUNT_FONT = Font(9.0, "bold")

Numbered = tuple[int, float, Fired]


class Columns(NamedTuple):
    """Where columns are, px from the left: middle of numbers, end of times, other beginnings."""

    number: float
    time: float
    states: float
    reason: float


def list_height(track: FlightTrack, lines: int) -> float:
    """Return how high (px) the list is whose reasons take so many lines (1 or 2)."""
    return ROWS[lines] * max(min(len(track.transitions), MOST_LISTED + 2), 4)


def draw_list(
    axes: Axes, ruler: Ruler, track: FlightTrack, looks: dict[str, Style], lines: int
) -> None:
    """Write each transition with its number on the map, its time and its reason.

    Of more than `MOST_LISTED` + 2 the first and the last are written, and which are not.

    Args:
        axes: an empty panel, `list_height` high.
        ruler: of the figure.
        track: of the run.
        looks: style of each state.
        lines: that a reason may take, 1 or 2.
    """
    axes.set_title("Transitions", pad=8)
    axes.set_axis_off()
    panel, high = axes.get_window_extent(), ROWS[lines]
    axes.set_xlim(0.0, panel.width)  # px
    axes.set_ylim(panel.height, 0.0)
    rows, left_out = _shown(track)
    columns = _columns(ruler, rows, panel.width)
    for place, (number, at, fired) in enumerate(rows):
        y = high * (place + 0.5 + (left_out > 0 and place >= MOST_LISTED - LAST_LISTED))
        axes.text(
            columns.number,
            y,
            str(number),
            ha="center",
            va="center",
            color=letters_on(looks.get(fired.to, OTHER_STYLE).colour),
            bbox=disc(looks.get(fired.to, OTHER_STYLE).colour),
            **COUNT_FONT.keywords,
        )
        axes.text(
            columns.time, y, _time(at), color=MUTED, ha="right", va="center", **PLAIN_FONT.keywords
        )
        states = ruler.cut(_states(fired), BOLD_FONT, columns.reason - COLUMN_GAP - columns.states)
        axes.text(columns.states, y, states, color=INK, va="center", **BOLD_FONT.keywords)
        reason = "\n".join(
            ruler.lines(fired.reason, SMALL_FONT, panel.width - columns.reason, lines)
        )
        axes.text(columns.reason, y, reason, color=MUTED, va="center", **SMALL_FONT.keywords)
    if left_out:
        first = MOST_LISTED - LAST_LISTED + 1
        _tell(axes, columns.states, high * (first - 0.5), "…")
        words = f"{left_out} of {len(track.transitions)} are left out, {first} to "
        words += f"{first + left_out - 1}: see transitions in summary.json"
        _tell(axes, columns.states, high * (MOST_LISTED + 1.5), words)


def _shown(track: FlightTrack) -> tuple[list[Numbered], int]:
    """Return the transitions that are written, with their numbers, and how many are not."""
    rows = [(number, at, fired) for number, (at, fired) in enumerate(track.transitions, 1)]
    if len(rows) <= MOST_LISTED + 2:
        return rows, 0
    return [*rows[: MOST_LISTED - LAST_LISTED], *rows[-LAST_LISTED:]], len(rows) - MOST_LISTED


def _columns(ruler: Ruler, rows: Sequence[Numbered], room: float) -> Columns:
    """Return the positions of the columns, as wide as their content."""
    number = max((ruler.width(str(it), COUNT_FONT) for it, _, _ in rows), default=0.0)
    time = max((ruler.width(_time(at), PLAIN_FONT) for _, at, _ in rows), default=0.0)
    states = max((ruler.width(_states(it), BOLD_FONT) for _, _, it in rows), default=0.0)
    ends = number + COLUMN_GAP, number + COLUMN_GAP + time + COLUMN_GAP
    begin = ends[1] + 0.7 * COLUMN_GAP
    return Columns(
        0.5 * number + 8.0, ends[1], begin, begin + min(states, STATES_SHARE * room) + COLUMN_GAP
    )


def _time(at: float) -> str:
    return f"{at:.1f} s"


def _states(fired: Fired) -> str:
    return f"{fired.source} → {fired.to}"


def _tell(axes: Axes, x: float, y: float, words: str) -> None:
    axes.text(x, y, words, color=MUTED, va="center", **PLAIN_FONT.keywords)
