"""The guard timeline of `track.png`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.patches import Patch

from missionkit.recorder.flight_track import FlightTrack, Span
from missionkit.recorder.palette import HOLDS_COLOUR, HOLDS_NOT_COLOUR, INK, MUTED, UNKNOWN_COLOUR
from missionkit.recorder.plot_text import Font, Ruler

MOST_GUARDS = 14  # rows
GUARD_ROW, GUARD_NAMES_ROOM = 20.0, 200.0  # px: height of a row; room for the names
GUARD_FONT = Font(9.5)
SHORTEST_ANSWER = 0.05  # s, so that an answer given once is seen


def guard_rows(track: FlightTrack) -> int:
    """Return how many rows the panel has."""
    return max(min(len(track.guards), MOST_GUARDS) + (len(track.guards) > MOST_GUARDS), 1)


def draw_guards(axes: Axes, ruler: Ruler, track: FlightTrack) -> None:
    """Draw one row per guard: its answers while it was evaluated, nothing otherwise.

    Args:
        axes: empty, as tall as `guard_rows` says.
        ruler: for the widths of names.
        track: with the guards' answers.
    """
    names = _liveliest(track)
    rows = guard_rows(track)
    axes.set_title("Guards", pad=10)
    axes.set_yticks(range(len(names)), labels(ruler, names), color=INK, fontsize=GUARD_FONT.size)
    axes.set_ylim(rows - 0.4, -0.6)
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    for row, name in enumerate(names):
        for holds, colour in (
            (True, HOLDS_COLOUR),
            (False, HOLDS_NOT_COLOUR),
            (None, UNKNOWN_COLOUR),
        ):
            bars = [_bar(it) for it in track.guards[name] if it.holds is holds]
            axes.broken_barh(bars, (row - 0.32, 0.64), facecolors=colour, linewidth=0)
    if len(names) < len(track.guards):
        axes.annotate(
            f"and {len(track.guards) - len(names)} more, which changed least: "
            "see /guards in flight.mcap",
            (0.0, rows - 1),
            xycoords=axes.get_yaxis_transform(),
            va="center",
            color=MUTED,
            backgroundcolor="white",
            **GUARD_FONT.keywords,
        )
    _key(axes)


def labels(ruler: Ruler, names: Sequence[str]) -> list[str]:
    """Return names short enough for the margin, different for different guards."""
    seen: Counter[str] = Counter()
    found = []
    for name in names:
        label = ruler.cut(name, GUARD_FONT, GUARD_NAMES_ROOM)
        seen[label] += 1
        found.append(label if seen[label] == 1 else f"{label} {seen[label]}")
    return found


def _key(axes: Axes) -> None:
    axes.legend(
        handles=[
            Patch(color=HOLDS_COLOUR, label="holds"),
            Patch(color=HOLDS_NOT_COLOUR, label="does not hold"),
            Patch(color=UNKNOWN_COLOUR, label="unknown"),
        ],
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        ncols=3,
        frameon=False,
        fontsize=9.5,
        handlelength=1.0,
        handleheight=1.0,
        borderaxespad=0.2,
    )


def _bar(it: Span) -> tuple[float, float]:
    return it.start, it.end - it.start + SHORTEST_ANSWER


def _liveliest(track: FlightTrack) -> list[str]:
    """Return the guards in the order they were first evaluated, at most `MOST_GUARDS`.

    When there are more, those that changed their answer most often stay.
    """
    names = list(track.guards)
    kept = set(sorted(names, key=lambda name: -len(track.guards[name]))[:MOST_GUARDS])
    return [name for name in names if name in kept]
