"""Noticing that the vehicle touches the ground where it should be flying."""

from __future__ import annotations

from dataclasses import replace

from missionkit.messages import GROUND_TOUCHED, Observation, VehicleStatus

COMMANDED = frozenset({"offboard", "guided", "hold", "brake"})  # modes that a mission flies in
TOUCHED_GROUND = "touched the ground outside landing and take-off"


def with_ground_contact(
    observation: Observation, before: VehicleStatus | None, *, lands: bool = False
) -> Observation:
    """Return the observation with the event `ground_touched` if that has just happened.

    Args:
        observation: what was sensed.
        before: the vehicle's previous status.
        lands: the behaviour led to the ground on purpose.
    """
    now = observation.status
    if lands or now is None or before is None:
        return observation
    if not before.in_air or now.in_air or not now.armed:
        return observation
    if now.mode not in COMMANDED or before.mode not in COMMANDED:
        return observation
    return replace(
        observation,
        events=(*observation.events, GROUND_TOUCHED),
        problems=(*observation.problems, TOUCHED_GROUND),
    )
