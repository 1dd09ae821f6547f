"""Search: looking for a lost marker."""

from missionkit.messages import Mode
from missionkit.states.contract import StateKind
from missionkit.states.shared_failsafes import SEARCH_TIMEOUT

SEARCH = StateKind(
    name="search",
    summary="Flying a pattern to find a marker again.",
    mode=Mode.TRAJECTORY,
    flying=True,
    must_reach=("visual", "gps", "land"),
    failsafes=(SEARCH_TIMEOUT,),
)
