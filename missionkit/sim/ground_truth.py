"""Ground truth: the current state, and the track that flights are graded by."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from missionkit.geometry import Mat, Quat, Transform, Vec3
from missionkit.sim.kernel_layout import MODES, TRACK_WIDTH


class TrueState(NamedTuple):
    """The true state of the vehicle at one moment."""

    at: float  # s
    position: Vec3  # (3,), m, NED
    velocity: Vec3  # (3,), m/s, NED
    attitude: Quat  # (4,), body to world
    rates: Vec3  # (3,), rad/s, FRD
    on_ground: bool
    armed: bool
    mode: str
    crashed: bool
    charge: float  # 0 to 1
    clearance: float  # m, from the vehicle's surface to the nearest obstacle, infinite without any
    energy: float  # J, taken so far

    @property
    def pose(self) -> Transform:
        """Body to world."""
        return Transform(self.attitude, self.position)

    @classmethod
    def of(cls, row: Vec3) -> TrueState:
        """Return the truth in one row of a track, (TRACK_WIDTH,)."""
        ground, armed, mode, crashed, charge, clearance, energy = row[14:21].tolist()
        return cls(
            float(row[0]),
            row[1:4],
            row[4:7],
            row[7:11],
            row[11:14],
            bool(ground),
            bool(armed),
            MODES[int(mode)],
            bool(crashed),
            charge,
            clearance,
            energy,
        )


class TrueTrack:
    """Growing record of the truth, one row for each stretch flown (at most 50 ms)."""

    def __init__(self) -> None:
        self._rows = np.empty((4096, TRACK_WIDTH))
        self._count = 0

    def add(self, at: float, state: Vec3, rest: tuple[float, ...]) -> None:
        """Append a row: time (s), state (13,), and the seven numbers that follow it.

        Args:
            at: not before the last row.
            state: p (m, NED), v (m/s, NED), q (body to world), ω (rad/s, body).
            rest: on ground, armed, mode, crashed, charge, clearance (m), energy (J).
        """
        if self._count == len(self._rows):
            self._rows = np.concatenate((self._rows, np.empty_like(self._rows)))
        row = self._rows[self._count]
        row[0], row[1:14], row[14:] = at, state, rest
        self._count += 1

    def restore(self, rows: Mat) -> None:
        """Begin with these rows, (N, TRACK_WIDTH)."""
        self._rows = np.concatenate((rows, np.empty((4096, TRACK_WIDTH))))
        self._count = len(rows)

    @property
    def rows(self) -> Mat:
        """All rows, (N, TRACK_WIDTH), in the order of time, not to be changed."""
        return self._rows[: self._count]

    @property
    def last(self) -> TrueState:
        """The present truth."""
        return TrueState.of(self._rows[self._count - 1])
