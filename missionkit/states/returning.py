"""Return: the way home."""

from missionkit.messages import Mode
from missionkit.states.common import HOME_UNREACHABLE
from missionkit.states.contract import StateKind

RETURN = StateKind(
    name="return",
    summary="Flying home.",
    mode=Mode.GPS,
    flying=True,
    must_reach=("land",),
    failsafes=(HOME_UNREACHABLE,),
)
