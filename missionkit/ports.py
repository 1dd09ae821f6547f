"""Interfaces of the engine to the outside world."""

from __future__ import annotations

from typing import Protocol

from missionkit.messages import Command, Observation


class Clock(Protocol):
    """Where time comes from. Never runs backwards."""

    def now(self) -> float:
        """Return the mission's time (s)."""


class Vehicle(Protocol):
    """A vehicle, simulated or real."""

    async def connect(self) -> None:
        """Reach the vehicle.

        Raises:
            VehicleError: it did not answer.
        """

    async def observe(self, until: float) -> Observation:
        """Return all that was sensed since the last call, at mission time `until` (s)."""

    async def send(self, command: Command) -> None:
        """Carry out `command`; setpoints are finite and within limits."""

    async def close(self) -> None:
        """Let go of the vehicle."""
