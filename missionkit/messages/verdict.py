"""The verdict of a guard."""

from __future__ import annotations

from typing import NamedTuple

_new = tuple.__new__  # a third of the time of the class's own, and guards answer at every tick


class Verdict(NamedTuple):
    """Answer of a guard: it holds, does not hold, or is unknown (`holds is None`), and why."""

    holds: bool | None
    why: str = ""
    value: float | None = None
    threshold: float | None = None
    margin: float | None = None  # how far inside (positive) or outside (negative) the guard is

    @classmethod
    def unknown(cls, why: str) -> Verdict:
        """Return a verdict that is unknown."""
        return _new(cls, (None, why, None, None, None))

    @classmethod
    def below(cls, value: float, threshold: float, why: str = "") -> Verdict:
        """Holds when `value` < `threshold`.

        Args:
            value: finite.
            threshold: in the unit of `value`; equal does not hold.
            why: for people, such as what was measured.
        """
        return _new(cls, (value < threshold, why, value, threshold, threshold - value))

    @classmethod
    def above(cls, value: float, threshold: float, why: str = "") -> Verdict:
        """Holds when `value` > `threshold`.

        Args:
            value: finite.
            threshold: in the unit of `value`; equal does not hold.
            why: for people, such as what was measured.
        """
        return _new(cls, (value > threshold, why, value, threshold, value - threshold))

    @classmethod
    def at_least(cls, value: float, threshold: float, why: str = "") -> Verdict:
        """Holds when `value` >= `threshold`.

        Args:
            value: finite.
            threshold: in the unit of `value`; equal holds.
            why: for people, such as what was measured.
        """
        return _new(cls, (value >= threshold, why, value, threshold, value - threshold))

    @classmethod
    def at_most(cls, value: float, threshold: float, why: str = "") -> Verdict:
        """Holds when `value` <= `threshold`.

        Args:
            value: finite.
            threshold: in the unit of `value`; equal holds.
            why: for people, such as what was measured.
        """
        return _new(cls, (value <= threshold, why, value, threshold, threshold - value))
