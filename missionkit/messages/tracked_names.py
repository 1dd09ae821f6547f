"""Names of the targets that a tracker finds in flight; no mission file says where they are."""

from __future__ import annotations

import re
from typing import Final

TRACKED: Final = "tracked"
"""Stands for the one target that the mission has chosen among all that are tracked."""
_TRACK: Final = re.compile(r"robot_[1-9][0-9]*")


def track_name(number: int) -> str:
    """Return the name of a track; tracks are counted from 1 in the order they began."""
    return f"robot_{number}"


def names_a_track(name: str) -> bool:
    """Say whether a name is that of a tracked target: `tracked`, or `robot_4`."""
    return name == TRACKED or _TRACK.fullmatch(name) is not None
