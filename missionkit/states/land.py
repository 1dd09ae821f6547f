"""Land: the end of every flight."""

from missionkit.messages import Mode
from missionkit.states.contract import StateKind

LAND_KIND = StateKind(
    name="land",
    summary="Landing here; the mission ends on the ground.",
    mode=Mode.NONE,
    flying=True,
    default_behavior="land",
)
