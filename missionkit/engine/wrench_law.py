"""The control law of a vehicle with thrusters: its controller gives force and torque directly."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from missionkit.control.controller_protocol import ControllerProtocol
from missionkit.control.hold_point import HoldPoint, guidance_to
from missionkit.engine.control_law import Controlled
from missionkit.engine.flight_state import BehaviorState
from missionkit.geometry import Vec3
from missionkit.messages import Command, Estimate, Guidance, Mode, Step, Wrench
from missionkit.plugin_containment import Containment, is_foreign


class WrenchLaw(NamedTuple):
    """A wrench from guidance. No obstacle or ground limits it: keep-out is the behaviour's."""

    control: ControllerProtocol
    period: float = 0.05  # s

    def begin(self) -> Any:
        """Return the controller's memory at the start."""
        return self.control.begin()

    def begin_avoidance(self) -> None:
        """Return the planner's memory: there is no planner."""

    def moving(self, velocity: Vec3) -> Any:  # noqa: ARG002 - force has no memory of velocity
        """Return the controller's memory of a vehicle that moves: as at the start."""
        return self.begin()

    def noted(self, acting: BehaviorState, seen: Estimate) -> BehaviorState:  # noqa: ARG002
        """Take in nothing: nothing is scanned."""
        return acting

    def blind(self, acting: BehaviorState, guidance: Guidance | None, seen: Estimate) -> bool:  # noqa: ARG002
        """Say whether guidance needs a scanner that is silent: it never does.

        Args:
            acting: not used: nothing is scanned.
            guidance: not used.
            seen: not used.
        """
        return False

    def hold_point(self, seen: Estimate) -> HoldPoint:
        """Return the present pose."""
        return HoldPoint(seen.position, seen.yaw, seen.attitude)

    def without_planner(self) -> WrenchLaw:
        """Return the same law: it has no planner."""
        return self

    def command(
        self, acting: BehaviorState, mode: Mode, step: Step, seen: Estimate, contain: Containment
    ) -> Controlled:
        """Return the wrench for one tick; none, so that the vehicle holds, if there is none.

        Args:
            acting: pose to hold, if there is one, and the controller's memory.
            mode: of the active state.
            step: of the behaviour; its payload is passed on.
            seen: the estimate at this tick.
            contain: calls the controller; what it raises or returns wrongly is noted.

        Returns:
            Command and memory; after a fault the memory begins again.
        """
        guidance = step.guidance if acting.held is None else guidance_to(acting.held)
        asked = (acting.control, mode, None if step.stop else guidance, seen, self.period)
        name = str(getattr(self.control, "kind", "controller"))
        boxed = contain.call(name, self.control.step, *asked, foreign=is_foreign(self.control))
        fault = "" if boxed is None else wrench_fault(boxed[0])
        if fault:
            contain.note(f"{name} returned {fault}")
        if boxed is None or fault:
            return Controlled(Command(payload=step.payload), self.begin())
        setpoint, control = boxed[0]
        return Controlled(Command(setpoint, payload=step.payload), control)


def wrench_fault(answer: object) -> str:
    """Say what makes a controller's answer unusable; empty if nothing does."""
    if not (isinstance(answer, tuple) and len(answer) == 2 and isinstance(answer[0], Wrench)):
        return f"{type(answer).__name__}, expected a Wrench and its memory"
    for vector in answer[0]:
        if not (isinstance(vector, np.ndarray) and vector.shape == (3,)):
            return "with a wrench that is not two vectors of three numbers"
        if not math.isfinite(float(vector.sum())):
            return "with a wrench that is not finite"
    return ""
