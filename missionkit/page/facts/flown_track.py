"""Where the vehicle has been, in a bounded number of points."""

from __future__ import annotations

from collections.abc import Sequence

MOST_POINTS = 2000


class FlownTrack:
    """Positions at equal times; when there are too many, every other one is forgotten."""

    def __init__(self) -> None:
        self._times: list[float] = []
        self._points: list[list[float]] = []
        self._every = 0.0  # s between two points
        self._next = float("-inf")

    def add(self, at: float, position: Sequence[float]) -> None:
        """Take a position.

        Args:
            at: s.
            position: (3,), m, NED.
        """
        if at < self._next:
            return
        self._times.append(at)
        self._points.append([round(float(it), 3) for it in position])
        if len(self._times) > MOST_POINTS:
            span = self._times[-1] - self._times[0]
            self._every = 2.0 * span / len(self._times)
            del self._times[1::2], self._points[1::2]
        self._next = at + self._every - 1e-6

    def as_value(self) -> dict[str, list[object]]:
        """Return what `/api/track` answers."""
        return {"at": [*self._times], "points": [*self._points]}
