"""Idle: before the flight and between its parts."""

from missionkit.messages import Mode
from missionkit.states.contract import StateKind

IDLE_KIND = StateKind(
    name="idle",
    summary="On the ground, taking off, or hovering, as the autopilot does by itself.",
    mode=Mode.NONE,
    flying=False,
    default_behavior="hold",
)
