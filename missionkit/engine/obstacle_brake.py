"""Braking before obstacles: the last word on every setpoint, whatever a behaviour works at."""

from __future__ import annotations

from missionkit.control.controller import ControlMemory
from missionkit.control.velocity_limits import finite
from missionkit.engine.flight_state import BehaviorState
from missionkit.engine.prepared_mission import PreparedMission
from missionkit.messages import Estimate, Guidance, Setpoint


def scanned(plan: PreparedMission, acting: BehaviorState, seen: Estimate) -> BehaviorState:
    """Take in what was scanned, whatever the state does."""
    if plan.brake is None:
        return acting
    return acting._replace(scan=plan.brake.noted(acting.scan, seen))


def blind(
    plan: PreparedMission, acting: BehaviorState, guidance: Guidance | None, seen: Estimate
) -> bool:
    """Say whether the guidance leads past obstacles that can no longer be seen."""
    if plan.brake is None or guidance is None or not guidance.avoid:
        return False
    return plan.brake.blind(acting.scan, seen.now)


def braked(
    plan: PreparedMission,
    acting: BehaviorState,
    setpoint: Setpoint,
    control: ControlMemory,
    guidance: Guidance | None,
    seen: Estimate,
) -> tuple[Setpoint, ControlMemory]:
    """Return the setpoint so limited that the vehicle can stop; no comfort limit slows that.

    Args:
        plan: what flies.
        acting: with the newest scan.
        setpoint: about to be sent.
        control: the memory of what made it.
        guidance: what it was made from.
        seen: the estimate at this tick.
    """
    if plan.brake is None:
        return setpoint, control
    velocity = plan.brake.brake(acting.scan, seen, setpoint.velocity, guidance)
    slower = finite(setpoint._replace(velocity=velocity))
    if slower is None or velocity is setpoint.velocity:
        return setpoint, control
    return slower, control._replace(pushed=True)
