"""Return: the way home."""

from missionkit.messages import Mode
from missionkit.states.contract import StateKind
from missionkit.states.shared_failsafes import HOME_UNREACHABLE

RETURN_KIND = StateKind(
    name="return",
    summary="Flying home.",
    mode=Mode.GPS,
    flying=True,
    must_reach=("land",),
    failsafes=(HOME_UNREACHABLE,),
)
