"""The port `Vehicle` as every simulated vehicle implements it."""

from __future__ import annotations

from abc import ABC, abstractmethod

from missionkit.messages import Command, Observation
from missionkit.sim.fault_injection import InjectedFaults
from missionkit.sim.ground_truth import TrueState, TrueTrack

STRETCH = 10  # physics steps flown at once at most: 50 ms


class SimulatedPort(ABC):
    """A vehicle whose time passes only in `advance`; the port's methods call the synchronous ones.

    Attributes:
        track: its true states so far.
        began: s since 1970, of time 0; None: it has no date.
    """

    track: TrueTrack
    began: float | None = None
    _injected: InjectedFaults

    @abstractmethod
    def advance(self, until: float) -> Observation:
        """Fly to mission time `until` (s) and return all that arrived on the way."""

    @abstractmethod
    def apply(self, command: Command) -> None:
        """Send a command."""

    def utc(self, now: float) -> float | None:
        """Return a mission time (s) in s since 1970; None: it has no date."""
        return None if self.began is None else self.began + now

    @property
    def truth(self) -> TrueState:
        """The true state now; `on_ground` is being in its safe end."""
        return self.track.last

    async def connect(self) -> None:  # noqa: B027 - there is nothing to do
        """Do nothing: a simulated vehicle is always there."""

    async def observe(self, until: float) -> Observation:
        """Return `advance(until)`."""
        return self.advance(until)

    async def send(self, command: Command) -> None:
        """Do `apply(command)`."""
        self.apply(command)

    async def close(self) -> None:  # noqa: B027 - there is nothing to do
        """Do nothing."""

    def entered(self, state: str, at: float) -> None:
        """Note that the mission entered `state` at `at` (s), for faults that wait for it."""
        self._injected.entered.setdefault(state, at)
