"""The contract of a controller: from guidance to a setpoint."""

from __future__ import annotations

from typing import Any, ClassVar, Protocol, runtime_checkable

from missionkit.messages import AnySetpoint, Estimate, Guidance, Mode


@runtime_checkable
class ControllerProtocol(Protocol):
    """Turns guidance into setpoints; its memory is an immutable value.

    A controller of another package gives a `Wrench`: velocities are limited by obstacles and the
    ground, which only missionkit's own controller takes part in.
    """

    kind: ClassVar[str]

    def begin(self) -> Any:
        """Return the memory at the start."""

    def step(
        self, memory: Any, mode: Mode, guidance: Guidance | None, seen: Estimate, dt: float
    ) -> tuple[AnySetpoint, Any]:
        """Return the setpoint and the next memory.

        Args:
            memory: what this returned a step ago.
            mode: how guidance is flown.
            guidance: what the behaviour wants; None to come to rest.
            seen: the estimate at this tick.
            dt: time since the last step (s).
        """
