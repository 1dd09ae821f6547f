"""The states of `track.png` over time: a row for each, which is also the key to the map."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

from matplotlib.axes import Axes

from missionkit.recorder.flight_track import FlightTrack, Visit
from missionkit.recorder.palette import INK, MUTED, Style
from missionkit.recorder.plot_text import Font, Ruler

MOST_STATE_ROWS = 64  # rows
STATE_ROW, STATE_NAMES_ROOM = 15.0, 160.0  # px: height of a row; room for the names
SAMPLE = (-42.0, -6.0)  # px from the left edge: the line that the map draws
STATE_ROW_FONT = Font(9.0)
SHORTEST_VISIT = 0.05  # s, so that a visit of one tick is seen


def state_rows(track: FlightTrack) -> int:
    """Return how many rows the panel has."""
    states = len({it.state for it in track.visits})
    return max(min(states, MOST_STATE_ROWS) + (states > MOST_STATE_ROWS), 1)


def draw_states(axes: Axes, ruler: Ruler, track: FlightTrack, looks: dict[str, Style]) -> None:
    """Draw when the vehicle was in each state, in the order of the first visits.

    Of more than `MOST_STATE_ROWS` states those are shown that lasted longest.

    Args:
        axes: an empty panel.
        ruler: of the figure.
        track: of the run.
        looks: style of each state.
    """
    visits: dict[str, list[Visit]] = defaultdict(list)
    for visit in track.visits:
        visits[visit.state].append(visit)
    names = _longest(visits)
    rows = state_rows(track)
    axes.set_title("States", pad=10)
    axes.set_ylim(rows - 0.4, -0.6)
    axes.set_yticks([])
    axes.spines["left"].set_visible(False)
    edge = axes.get_window_extent().width
    for row, name in enumerate(names):
        look = looks[name]
        bars = [(it.start, it.end - it.start + SHORTEST_VISIT) for it in visits[name]]
        axes.broken_barh(bars, (row - 0.36, 0.72), facecolors=look.colour, linewidth=0)
        left, right = (at / edge for at in SAMPLE)
        axes.plot(
            [left, 0.5 * (left + right), right],
            [row] * 3,
            transform=axes.get_yaxis_transform(),
            lw=3.0,
            markersize=5.5,
            markevery=[1],
            clip_on=False,
            gid=f"key of {name}",
            **look.line,
        )
        axes.annotate(
            ruler.cut(name, STATE_ROW_FONT, STATE_NAMES_ROOM),
            ((SAMPLE[0] - 6.0) / edge, row),
            xycoords=axes.get_yaxis_transform(),
            ha="right",
            va="center",
            color=INK,
            **STATE_ROW_FONT.keywords,
        )
    if len(names) < len(visits):
        left_out = len(visits) - len(names)
        axes.annotate(
            f"and {left_out} more states, visited more briefly: see states in summary.json",
            (0.0, rows - 1),
            xycoords=axes.get_yaxis_transform(),
            va="center",
            color=MUTED,
            backgroundcolor="white",
            **STATE_ROW_FONT.keywords,
        )


def _longest(visits: dict[str, list[Visit]]) -> Sequence[str]:
    def lasted(name: str) -> float:
        return -sum(it.end - it.start for it in visits[name])

    kept = set(sorted(visits, key=lasted)[:MOST_STATE_ROWS])
    return [name for name in visits if name in kept]
