"""The guard timeline of `track.png`."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.patches import Patch

from missionkit.recorder.palette import HOLDS, INK, NOT, UNKNOWN
from missionkit.recorder.track import Span, Track

MOST = 14  # rows
LETTERS = 24  # of a guard's name; the whole one is in the record
TICK = 0.05  # s, so that an answer given once is seen


def draw_guards(axes: Axes, track: Track) -> None:
    """Draw one row per guard: what it said while it was asked, nothing while it was not."""
    names = _liveliest(track)
    axes.set_title("Guards", pad=10)
    axes.set_yticks(range(len(names)), labels(names), color=INK, fontsize=10)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    for row, name in enumerate(names):
        for holds, colour in ((True, HOLDS), (False, NOT), (None, UNKNOWN)):
            bars = [_bar(it) for it in track.guards[name] if it.holds is holds]
            axes.broken_barh(bars, (row - 0.32, 0.64), facecolors=colour, linewidth=0)
    axes.legend(
        handles=[
            Patch(color=HOLDS, label="holds"),
            Patch(color=NOT, label="does not hold"),
            Patch(color=UNKNOWN, label="unknown"),
        ],
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        ncols=3,
        frameon=False,
        fontsize=10,
        handlelength=1.0,
        handleheight=1.0,
        borderaxespad=0.2,
    )


def labels(names: Sequence[str]) -> list[str]:
    """Return names short enough for the margin, different for different guards.

    >>> labels(["marker-sure", "target lost (target trunk, longer_than 2)"])
    ['marker-sure', 'target lost …']
    """
    seen: Counter[str] = Counter()
    found = []
    for name in names:
        label = name if len(name) <= LETTERS else f"{name.partition(' (')[0][: LETTERS - 2]} …"
        seen[label] += 1
        found.append(label if seen[label] == 1 else f"{label} {seen[label]}")
    return found


def _bar(it: Span) -> tuple[float, float]:
    return it.start, it.end - it.start + TICK


def _liveliest(track: Track) -> list[str]:
    """Return the guards in the order they were first asked, at most `MOST`.

    When there are more, those that changed their answer most often stay.
    """
    names = list(track.guards)
    kept = sorted(names, key=lambda name: -len(track.guards[name]))[:MOST]
    return [name for name in names if name in kept]
