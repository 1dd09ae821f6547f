"""The values of guards over time, for the small curves beside them."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Iterable, Mapping
from typing import Any

SHOWN = 30.0  # s
COLUMNS = ("value", "threshold", "holds")


class GuardSeries:
    """Values of each guard.

    Args:
        kept: s; older values are forgotten. None: none are.
    """

    def __init__(self, kept: float | None = None) -> None:
        self._kept = kept
        self._rows: dict[str, tuple[list[float], list[tuple[Any, ...]]]] = {}

    def add(self, at: float, rows: Iterable[Mapping[str, Any]]) -> None:
        """Take the guards of one tick at `at` (s)."""
        for row in rows:
            times, values = self._rows.setdefault(row["name"], ([], []))
            times.append(at)
            values.append(tuple(row.get(key) for key in COLUMNS))
            if self._kept is not None and at - times[0] > 2.0 * self._kept:
                old = bisect_left(times, at - self._kept)
                del times[:old], values[:old]

    def since(self, name: str, start: float) -> dict[str, list[Any]]:
        """Return the values of a guard in the 30 s from a time (s) on.

        Args:
            name: of the guard.
            start: s.
        """
        times, values = self._rows.get(name, ([], []))
        first, last = bisect_left(times, start), bisect_left(times, start + SHOWN)
        columns = zip(*values[first:last], strict=True)
        named = dict(zip(COLUMNS, map(list, columns), strict=False))
        return {"at": times[first:last], **{key: named.get(key, []) for key in COLUMNS}}
