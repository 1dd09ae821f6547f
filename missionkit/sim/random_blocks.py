"""Random numbers in blocks: the same sequence however it is cut into pieces."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from missionkit.geometry import Mat

STREAMS = (
    *("wind", "autopilot", "imu", "gnss", "baro", "magnetometer", "scan", "link", "camera"),
    *("flow", "range", "robots", "boxes", "external_pose", "gimbal"),
)


class Normals:
    """Rows of standard normal numbers, drawn ahead in blocks because single draws are slow."""

    def __init__(self, rng: np.random.Generator, width: int, block: int = 1000) -> None:
        self._rng = rng
        self._shape = (block, width)
        self._rows = np.empty((0, width))
        self._used = 0
        self._drawn = 0

    @property
    def taken(self) -> int:
        """How many rows were taken so far."""
        return self._drawn - len(self._rows) + self._used

    def skip_to(self, taken: int) -> None:
        """Go on as if `taken` rows had been taken; not backwards."""
        while self.taken < taken:
            self.take(min(self._shape[0], taken - self.taken))

    def take(self, count: int) -> Mat:
        """Return the next `count` rows, (count, width), not to be changed."""
        end = self._used + count
        while end > len(self._rows):
            fresh = self._rng.standard_normal(self._shape)
            self._rows = np.concatenate((self._rows[self._used :], fresh))
            self._used, end = 0, count
            self._drawn += len(fresh)
        rows = self._rows[self._used : end]
        self._used = end
        return rows


def streams(seed: int, names: Sequence[str] = STREAMS) -> dict[str, np.random.Generator]:
    """Return one independent generator for each source of randomness, by name.

    Each has its own child of the seed, so that switching one sensor off leaves the others as
    they were.

    Args:
        seed: of all of them.
        names: of the sources; those of a multicopter by default.
    """
    children = np.random.SeedSequence(seed).spawn(len(names))
    return {name: np.random.default_rng(c) for name, c in zip(names, children, strict=True)}
