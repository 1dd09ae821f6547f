"""Braking before obstacles: the last word on every setpoint, whatever a behaviour works at."""

from __future__ import annotations

from missionkit.control.controller import ControlMemory
from missionkit.control.velocity_limits import finite
from missionkit.engine.flight_state import BehaviorState
from missionkit.messages import Estimate, Guidance, Setpoint
from missionkit.planning.potential_field import PotentialField


def braked(
    brake: PotentialField,
    acting: BehaviorState,
    setpoint: Setpoint,
    control: ControlMemory,
    guidance: Guidance | None,
    seen: Estimate,
) -> tuple[Setpoint, ControlMemory]:
    """Return the setpoint so limited that the vehicle can stop; no comfort limit slows that.

    Args:
        brake: knows how far the vehicle needs to stop.
        acting: with the newest scan.
        setpoint: about to be sent.
        control: the memory of what made it.
        guidance: what it was made from.
        seen: the estimate at this tick.
    """
    velocity = brake.brake(acting.scan, seen, setpoint.velocity, guidance)
    if velocity is setpoint.velocity:
        return setpoint, control
    slower = finite(setpoint._replace(velocity=velocity))
    return (setpoint, control) if slower is None else (slower, control._replace(pushed=True))
