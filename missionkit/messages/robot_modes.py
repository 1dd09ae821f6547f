"""What a tracked target is said to do, and to be."""

from __future__ import annotations

from typing import Final

from missionkit.messages.estimate import Target

STRAIGHT, SPIN, CIRCLING, STANDING = "straight", "spin", "circling", "standing"
"""Models of motion: the keys of `Target.modes`."""
TARGET, OBSTACLE = "target", "obstacle"
"""Keys of `Target.classes`: a target is herded, an obstacle robot is kept away from."""
LIKELY: Final = 0.5


def spins(target: Target) -> bool:
    """Say whether a target more likely spins than not: its heading then leads nowhere."""
    return target.modes.get(SPIN, 0.0) > LIKELY


def is_obstacle(target: Target) -> bool:
    """Say whether a target is more likely an obstacle robot than not."""
    return target.classes.get(OBSTACLE, 0.0) > LIKELY
