"""Standing still is holding a place: a velocity of zero drifts with the wind."""

from __future__ import annotations

from missionkit.control import hold_point
from missionkit.engine.control_law import ControlLaw
from missionkit.engine.flight_state import BehaviorState
from missionkit.messages import Estimate, Guidance, Mode


def standing(
    law: ControlLaw,
    acting: BehaviorState,
    mode: Mode,
    guidance: Guidance | None,
    seen: Estimate,
) -> BehaviorState:
    """Return the behaviour's state with the place to hold while no behaviour leads anywhere.

    Where it is not known where the vehicle is, nothing is held: its velocity goes to zero.

    Args:
        law: knows where the vehicle comes to rest.
        acting: of the state that commands.
        mode: NONE while the autopilot flies by itself.
        guidance: what the behaviour wants.
        seen: the estimate at this tick.
    """
    if mode is Mode.NONE or guidance is not None or not hold_point.known(seen):
        return acting if acting.held is None else acting._replace(held=None)
    if acting.held is not None:
        return acting
    return acting._replace(held=law.hold_point(seen))
