"""Custom: a flying state with no contract but the general one."""

from missionkit.messages import Mode
from missionkit.states.contract import StateKind

CUSTOM_KIND = StateKind(
    name="custom",
    summary="Anything else; must still be able to land.",
    mode=Mode.TRAJECTORY,
    flying=True,
    default_behavior="hold",
    must_reach=("land",),
)
