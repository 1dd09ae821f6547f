"""Hover: where a goal out of reach ends."""

from missionkit.messages import Mode
from missionkit.states.contract import StateKind
from missionkit.states.shared_failsafes import HOVER

HOVER_STATE = StateKind(
    name=HOVER,
    summary="Holding position because the goal is out of reach; goes home after a while.",
    mode=Mode.GPS,
    flying=True,
    default_behavior="hold",
    must_reach=("land",),
)
