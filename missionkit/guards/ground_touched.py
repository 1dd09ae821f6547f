"""The ground, where it should not be."""

from __future__ import annotations

from typing import ClassVar

from typing_extensions import override

from missionkit.guards.comparison import FlagGuard
from missionkit.messages import GROUND_TOUCHED, Estimate
from missionkit.messages.region import Quantity

TOUCHED = Quantity("ground touched", most=1.0, whole=True)


class GroundTouched(FlagGuard):
    """Holds when the vehicle touches the ground outside landing and take-off.

    That is the tick at which it reports that it is no longer in the air, with its rotors turning
    and in a mode that neither lands nor takes off; the event `ground_touched` comes with it.
    Every mission has it as a failsafe that lands.
    """

    kind: ClassVar[str] = "ground_touched"

    @override
    def quantity(self) -> Quantity:
        return TOUCHED

    @override
    def raised(self, seen: Estimate) -> bool:
        return GROUND_TOUCHED in seen.events
