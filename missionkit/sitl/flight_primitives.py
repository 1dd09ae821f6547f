"""Primitives of autonomous flights."""

from __future__ import annotations

from missionkit.geometry import norm, vec
from missionkit.messages import Action, Command
from missionkit.sitl.setpoint_tracking import SetpointTarget, TrackingLimits, follow
from missionkit.sitl.sitl_state import SitlState


def limits(state: SitlState) -> TrackingLimits:
    """Return the limits of the outer loop, from the parameters."""
    value, inner = state.parameters, state.body.world.autopilot
    if state.dialect.name == "px4":
        names = ("MPC_XY_P", "MPC_Z_P", "MPC_XY_VEL_MAX", "MPC_Z_VEL_MAX_UP", "MPC_Z_VEL_MAX_DN")
        level, climb, fast, up, down = (value[name] for name in names)
    else:
        level, climb = value["PSC_POSXY_P"], value["PSC_POSZ_P"]
        fast, up, down = (value[f"WPNAV_SPEED{end}"] / 100.0 for end in ("", "_UP", "_DN"))
    hover = 1.0 / state.body.world.quadrotor.thrust_to_weight
    return TrackingLimits(
        level, climb, fast, up, down, hover, inner.velocity_gain, inner.climb_gain
    )


def cruise(state: SitlState) -> float:
    """Return the speed (m/s) of autonomous flights."""
    px4 = state.dialect.name == "px4"
    usual = state.parameters["MPC_XY_CRUISE"] if px4 else state.parameters["WPNAV_SPEED"] / 100.0
    return state.speed or usual


def act(state: SitlState, action: Action, mode: str) -> Command | None:
    """Return the action, unless the inner autopilot is in its mode already.

    Args:
        state: of the autopilot.
        action: for the inner autopilot.
        mode: of the inner autopilot, which the action leads to.
    """
    return None if state.body.truth.mode == mode else Command(action=action)


def to(state: SitlState, aim: SetpointTarget) -> Command:
    """Return the setpoint on the way to a target."""
    return Command(setpoint=follow(aim, state.body, limits(state)))


def there(state: SitlState, aim: SetpointTarget, radius: float) -> bool:
    """Tell whether it is within `radius` (m) of the position of a target.

    Args:
        state: of the autopilot.
        aim: axes without a position count as 0.
        radius: m.
    """
    gap = vec(*(goal or 0.0 for goal in aim.position)) - state.body.position
    return norm(gap) < radius
