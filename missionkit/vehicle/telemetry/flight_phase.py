"""Flight phase of a vehicle whose mode does not determine it.

PX4 has a mode for taking off, holding and following setpoints each. ArduCopter does all of it in
GUIDED, so the difference is kept here.
"""

from __future__ import annotations

from typing_extensions import override

from missionkit.vehicle.autopilot_dialect import GUIDED_MODE, Dialect
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.telemetry.autopilot_state import AutopilotState

WITHIN = 0.3  # m below the height at which a climb counts as done


class FlightPhase(AutopilotState):
    """The autopilot's modes, with GUIDED split by phase."""

    def __init__(self, cache: Cache, dialect: Dialect) -> None:
        super().__init__(cache, dialect)
        self._height: float | None = None  # m, of the take-off under way
        self._steered = False

    @property
    @override
    def mode(self) -> str | None:
        """Its mode; GUIDED is taking off, following setpoints, or holding."""
        reported = super().mode
        if reported != GUIDED_MODE:
            return reported
        if self.climbing:
            return "take_off"
        return "offboard" if self._steered else "hold"

    @property
    def climbing(self) -> bool:
        """Whether a take-off is under way."""
        return self._height is not None

    def take_off(self, height: float | None) -> None:
        """Note that a take-off was requested."""
        self._height = 2.5 if height is None else height
        self._steered = False

    def see(self) -> None:
        """Notice the end of a climb."""
        height, wanted = self.height, self._height
        if wanted is None or height is None or not self.in_air:
            return
        if height >= wanted - WITHIN:
            self._height = None

    def steer(self) -> None:
        """Note that setpoints are followed."""
        self._height = None
        self._steered = True

    def rest(self) -> None:
        """Note that none are."""
        self._steered = False

    def end(self) -> None:
        """Note that something other than a take-off was requested."""
        self._height = None
        self._steered = False
