"""The control law of a vehicle that flies velocities, which obstacles and the ground limit."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from missionkit.control import hold_point
from missionkit.control.controller import Control, ControlMemory
from missionkit.control.hold_point import HoldPoint, guidance_to
from missionkit.control.velocity_limits import ZERO, Triple
from missionkit.engine.control_law import Controlled
from missionkit.engine.flight_state import BehaviorState
from missionkit.engine.ground_floor import above_floor
from missionkit.engine.obstacle_brake import braked
from missionkit.engine.step_validation import push_fault
from missionkit.geometry import Vec3
from missionkit.messages import (
    Command,
    Estimate,
    Guidance,
    Mode,
    Setpoint,
    Step,
    names_a_track,
)
from missionkit.planning.avoidance_planner import AvoidancePlanner
from missionkit.planning.potential_field import PotentialField
from missionkit.plugin_containment import Containment, is_foreign

IN_VIEW = 0.5  # s since a target's last sighting


class VelocityLaw(NamedTuple):
    """Velocity from guidance: controller, then planner, then the brake, then the ground."""

    control: Control
    period: float = 0.05  # s
    field: AvoidancePlanner | None = None
    brake: PotentialField | None = None  # before obstacles, whichever planner leads past them
    floor: float = math.inf  # m, NED, how far down guidance may lead

    def begin(self) -> ControlMemory:
        """Return the controller's memory at rest."""
        return self.control.begin()

    def begin_avoidance(self) -> Any:
        """Return the planner's memory before the first step, None without a planner."""
        return None if self.field is None else self.field.begin()

    def moving(self, velocity: Vec3) -> ControlMemory:
        """Return the controller's memory of a vehicle that moves at `velocity` (3,), m/s, NED."""
        north, east, down = velocity.tolist()
        return self.begin()._replace(velocity=(north, east, down))

    def noted(self, acting: BehaviorState, seen: Estimate) -> BehaviorState:
        """Take in what was scanned, whatever the state does."""
        if self.brake is None:
            return acting
        scan = self.brake.noted(acting.scan, seen)
        return acting if scan is acting.scan else acting._replace(scan=scan)

    def blind(self, acting: BehaviorState, guidance: Guidance | None, seen: Estimate) -> bool:
        """Say whether the guidance leads past obstacles that can no longer be seen.

        Args:
            acting: with the last scan and its time.
            guidance: blind only if it has `avoid`.
            seen: the estimate at this tick.
        """
        if self.brake is None or guidance is None or not guidance.avoid:
            return False
        return self.brake.blind(acting.scan, seen.now)

    def hold_point(self, seen: Estimate) -> HoldPoint:
        """Return where the vehicle comes to rest if it brakes now."""
        return hold_point.place(seen, self.control.limits)

    def without_planner(self) -> VelocityLaw:
        """Return the same law for a tick in which the planner misbehaves."""
        return self._replace(field=None)

    def command(
        self, acting: BehaviorState, mode: Mode, step: Step, seen: Estimate, contain: Containment
    ) -> Controlled:
        """Return the velocity for one tick, and the next memories.

        Args:
            acting: memory of behaviour, control and avoidance.
            mode: gains to use.
            step: what the behaviour wants.
            seen: the estimate of this tick.
            contain: runs the planner where it is a plug-in.
        """
        guidance = step.guidance if acting.held is None else guidance_to(acting.held)
        wanted, control = self.control.aim(acting.control, mode, guidance, seen, self.period)
        push, avoidance = self._push(acting, guidance, wanted, seen, contain)
        setpoint, control = self.control.fly(
            control, wanted, guidance, seen, self.period, push=push, bound=step.bound
        )
        if step.stop:  # what comes to rest does so by what the vehicle can do: no comfort limit
            setpoint, control = (
                Setpoint(np.zeros(3) if step.retreat is None else step.retreat, setpoint.yaw_rate),
                control._replace(velocity=ZERO),
            )
        if self.brake is not None:
            setpoint, control = braked(self.brake, acting, setpoint, control, guidance, seen)
        floor = math.inf if step.lands else self.floor
        setpoint = above_floor(setpoint, seen, floor, self.control.limits)
        control = control.having_sent(setpoint)
        command = Command(
            setpoint, payload=step.payload, own_velocity=_vouched(seen), orders=step.orders
        )
        return Controlled(command, control, avoidance)

    def _push(
        self,
        acting: BehaviorState,
        guidance: Guidance | None,
        wanted: Triple | None,
        seen: Estimate,
        contain: Containment,
    ) -> tuple[Vec3 | None, Any]:
        field = self.field
        if field is None or guidance is None or wanted is None or not guidance.avoid:
            return None, acting.avoidance
        arguments = (acting.avoidance, seen, guidance.position, np.array(wanted))
        if not is_foreign(field):
            return field.step(*arguments)
        name = str(getattr(field, "kind", "planner"))
        boxed = contain.call(name, field.step, *arguments)
        wrong = "" if boxed is None else push_fault(boxed[0])
        if wrong:
            contain.note(f"{name} returned {wrong}")
        return (None, acting.avoidance) if boxed is None or wrong else boxed[0]


def _vouched(seen: Estimate) -> Vec3 | None:
    """Return the vehicle's velocity (3,), m/s, NED, while a target in view vouches for it.

    A target that moves does not: it corrects nothing.
    """
    looks = (
        it.seen_at
        for name, it in seen.targets.items()
        if it.velocity is None and not names_a_track(name)
    )
    fresh = any(at is not None and seen.now - at <= IN_VIEW for at in looks)
    return seen.velocity if fresh and not seen.health.diverged else None
