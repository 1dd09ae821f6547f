"""The interface of a control law: from what a behaviour wants to a command for the vehicle.

Each kind of setpoint has its own: velocities are limited by obstacles, planner and ground
(`velocity_law`), a wrench is the controller's alone (`wrench_law`).
"""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol, Self

from missionkit.control.hold_point import HoldPoint
from missionkit.engine.flight_state import BehaviorState
from missionkit.geometry import Vec3
from missionkit.messages import Command, Estimate, Guidance, Mode, Step
from missionkit.plugin_containment import Containment


class Controlled(NamedTuple):
    """Result of one step of a control law."""

    command: Command
    control: Any  # the controller's next memory
    avoidance: Any = None  # the planner's next memory


class ControlLaw(Protocol):
    """Turns steps of behaviours into commands; its memory is an immutable value."""

    def begin(self) -> Any:
        """Return the controller's memory at rest."""

    def begin_avoidance(self) -> Any:
        """Return the planner's memory before the first step, None without a planner."""

    def moving(self, velocity: Vec3) -> Any:
        """Return the controller's memory of a vehicle that moves at `velocity` (3,), m/s, NED."""

    def noted(self, acting: BehaviorState, seen: Estimate) -> BehaviorState:
        """Take in what was scanned, whatever the state does."""

    def blind(self, acting: BehaviorState, guidance: Guidance | None, seen: Estimate) -> bool:
        """Say whether the guidance leads past obstacles that can no longer be seen.

        Args:
            acting: with the last scan.
            guidance: of the behaviour; `None` if it wants none.
            seen: the estimate at this tick.
        """

    def hold_point(self, seen: Estimate) -> HoldPoint:
        """Return where the vehicle comes to rest if it brakes now."""

    def without_planner(self) -> Self:
        """Return the same law for a tick in which the planner misbehaves."""

    def command(
        self,
        acting: BehaviorState,
        mode: Mode,
        step: Step,
        seen: Estimate,
        contain: Containment,
    ) -> Controlled:
        """Return the command for one tick, and the next memories.

        Args:
            acting: memories of controller, planner and scan, and the place that is held.
            mode: how guidance is flown; never NONE.
            step: what the behaviour wants.
            seen: the estimate at this tick.
            contain: keeps what went wrong in a plug-in.
        """
