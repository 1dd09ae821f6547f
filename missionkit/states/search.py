"""Search: looking for a lost marker."""

from missionkit.messages import Mode
from missionkit.states.common import SEARCH_TIMEOUT
from missionkit.states.contract import StateKind

SEARCH = StateKind(
    name="search",
    summary="Flying a pattern to find a marker again.",
    mode=Mode.TRAJECTORY,
    flying=True,
    must_reach=("visual", "gps", "land"),
    failsafes=(SEARCH_TIMEOUT,),
)
