"""What the camera shows although it should not: reported once in an episode."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Final, NamedTuple

EPISODE_ENDS: Final = 5.0  # s without it


class VisionWarning(NamedTuple):
    """An episode in which the images contradicted the mission."""

    event: str  # for the chart
    about: tuple[str, ...]  # with `event`: what makes two warnings the same
    message: str  # a sentence for people
    since: float  # s, first frame
    last: float  # s, latest frame


def continued(
    known: Iterable[VisionWarning], seen: Iterable[VisionWarning], at: float
) -> tuple[VisionWarning, ...]:
    """Return the warnings after a frame at time `at` (s); those that have ended are dropped.

    Args:
        known: warnings after the frame before.
        seen: those of this frame.
        at: s, exposure of the frame.
    """
    kept = {_kind(it): it for it in known if at - it.last <= EPISODE_ENDS}
    for it in seen:
        kept[_kind(it)] = kept.get(_kind(it), it)._replace(last=at)
    return tuple(kept.values())


def begun(
    now: Iterable[VisionWarning], before: Iterable[VisionWarning]
) -> tuple[VisionWarning, ...]:
    """Return the warnings that were not there `before`."""
    known = {(_kind(it), it.since) for it in before}
    return tuple(it for it in now if (_kind(it), it.since) not in known)


def _kind(warning: VisionWarning) -> tuple[str, tuple[str, ...]]:
    return warning.event, warning.about
