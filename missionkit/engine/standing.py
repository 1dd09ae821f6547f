"""Standing still is holding a place: a velocity of zero drifts with the wind."""

from __future__ import annotations

from missionkit.control import holding
from missionkit.engine.flight import Plan
from missionkit.engine.memory import Hands
from missionkit.messages import Estimate, Guidance, Mode


def standing(
    plan: Plan, hands: Hands, mode: Mode, guidance: Guidance | None, seen: Estimate
) -> Hands:
    """Return the hands with the place to hold while no behaviour leads anywhere.

    Where it is not known where the vehicle is, nothing is held: its velocity goes to zero.

    Args:
        plan: what flies.
        hands: of the state that commands.
        mode: NONE while the autopilot flies by itself.
        guidance: what the behaviour wants.
        seen: the estimate at this tick.
    """
    if mode is Mode.NONE or guidance is not None or not holding.known(seen):
        return hands._replace(held=None)
    if hands.held is not None:
        return hands
    return hands._replace(held=holding.place(seen, plan.control.limits))
