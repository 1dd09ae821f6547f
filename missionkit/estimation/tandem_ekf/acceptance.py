"""Whether one kind of measurement is still accepted: a filter that refuses most has diverged."""

from __future__ import annotations

from typing import NamedTuple

WINDOW = 30
"""Measurements over which the share is averaged: 0.6 s of ranges at 50 Hz, 1.5 s of frames."""
DIVERGED_ABOVE, TRUSTED_BELOW = 0.5, 0.2
"""Share of refused measurements; one outlier in ten reaches 0.5 in no lifetime."""


class Acceptance(NamedTuple):
    """How many of the last measurements of one kind were accepted."""

    at: float | None = None  # s, of the last accepted one
    refused: float = 0.0  # share of those refused, exponentially averaged
    diverged: bool = False  # until few are refused again
    why: str = ""  # of the last one that could not even be compared


def counted(known: Acceptance, at: float, *, accepted: bool, why: str = "") -> Acceptance:
    """Return the share with one more measurement, taken at `at` (s).

    Args:
        known: the share before.
        at: s, of the measurement.
        accepted: whether it passed its gate.
        why: it was refused, for the record.
    """
    share = known.refused + ((0.0 if accepted else 1.0) - known.refused) / WINDOW
    return Acceptance(
        at=at if accepted else known.at,
        refused=share,
        diverged=share > (TRUSTED_BELOW if known.diverged else DIVERGED_ABOVE),
        why=why if not accepted else "",
    )
