"""What became of the ground robots of a world, by the truth, and the paths they drove.

Imported late, as the ground robots are.
"""

from __future__ import annotations

from typing import Final, Literal, NamedTuple, cast

import numpy as np

from missionkit.geometry import Mat
from missionkit.sim.flight_grading import HerdGrade
from missionkit.sim.ground_robots import BUMPS, HOME, LOST, OBSTACLE, OUT, OUT_AT, SIZE, TOUCHES

EVERY: Final = 10  # rows between two places of a path
End = Literal["", "home", "lost"]


class HerdTrack:
    """Growing record of all ground robots, one row of states for each stretch flown."""

    def __init__(self) -> None:
        self._times: list[float] = []
        self._states: list[Mat] = []

    def add(self, at: float, robots: Mat) -> None:
        """Append the states (R, SIZE) at a time (s)."""
        self._times.append(at)
        self._states.append(robots.astype(np.float32))

    @property
    def times(self) -> Mat:
        """Times (T,), s."""
        return np.array(self._times)

    @property
    def states(self) -> Mat:
        """States (T, R, SIZE), see `ground_robots`, in single precision."""
        return np.array(self._states) if self._states else np.zeros((0, 0, SIZE), np.float32)

    def driven(self) -> list[DrivenPath]:
        """Return where each robot drove while it was in play, twice a second at least."""
        states = self.states[::-EVERY][::-1]
        return [_driven(states[:, n]) for n in range(states.shape[1])]


class DrivenPath(NamedTuple):
    """Where one ground robot drove, and how that ended."""

    places: Mat  # (N, 2), m, north and east
    obstacle: bool
    end: End


def grade_herd(robots: Mat) -> HerdGrade | None:
    """Grade the robots by their states at the end of a flight; None: there are no target robots.

    Args:
        robots: (R, SIZE).
    """
    targets = robots[robots[:, OBSTACLE] == 0.0]
    if not len(targets):
        return None
    home, lost = (_left(targets, end) for end in (HOME, LOST))
    return HerdGrade(
        home=len(home),
        lost=len(lost),
        remaining=len(targets) - len(home) - len(lost),
        home_at=home,
        lost_at=lost,
        bumps=int(targets[:, BUMPS].sum()),
        touches=int(targets[:, TOUCHES].sum()),
    )


def _driven(states: Mat) -> DrivenPath:
    gone = states[:, OUT] > 0.0
    last = int(gone.argmax()) + 1 if gone.any() else len(states)
    end = {HOME: "home", LOST: "lost"}.get(float(states[-1, OUT]), "")
    return DrivenPath(states[:last, :2], bool(states[0, OBSTACLE]), cast(End, end))


def _left(targets: Mat, end: float) -> tuple[float, ...]:
    times: list[float] = targets[targets[:, OUT] == end, OUT_AT].tolist()
    return tuple(sorted(times))
