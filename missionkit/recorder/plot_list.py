"""The list of transitions of `track.png`."""

from __future__ import annotations

import textwrap

from matplotlib.axes import Axes

from missionkit.recorder.palette import INK, MUTED
from missionkit.recorder.plot_map import number
from missionkit.recorder.track import Track

MOST = 12  # rows; the rest is in summary.json
TWO_LINES = 25.0  # px, height of a row that takes them


def draw_list(axes: Axes, track: Track, shades: dict[str, str], letters: int) -> None:
    """Write each transition with its number on the map, its time and its reason.

    Args:
        axes: an empty panel.
        track: of the run.
        shades: colour of each state.
        letters: how many letters of the reason fit into a line; in high rows it takes two.
    """
    axes.set_title("Transitions", pad=10)
    axes.set_axis_off()
    rows = max(len(track.transitions[:MOST]), 6) + 0.6
    axes.set_xlim(0.0, letters + 36.0)
    axes.set_ylim(rows, 0.0)
    lines = 2 if axes.get_window_extent().height / rows >= TWO_LINES else 1
    for index, (at, fired) in enumerate(track.transitions[:MOST], 1):
        row = index - 0.5
        number(axes, (1.2, row), index, shades.get(fired.to, MUTED))
        reason = textwrap.wrap(
            fired.reason, letters, max_lines=lines, placeholder=" …", break_on_hyphens=False
        )
        axes.text(11.0, row, f"{at:.1f} s", color=MUTED, ha="right", va="center")
        axes.text(
            13.0, row, f"{fired.source} → {fired.to}", color=INK, fontweight="bold", va="center"
        )
        axes.text(
            36.0,
            row,
            "\n".join(reason),
            color=MUTED,
            va="center",
            fontsize=9.5,
            linespacing=1.1,
        )
    more = len(track.transitions) - MOST
    if more > 0:
        axes.text(13.0, rows - 0.2, f"and {more} more", color=MUTED, va="center")
