"""Logic: a state that commands nothing itself."""

from missionkit.messages import Mode
from missionkit.states.contract import StateKind

LOGIC = StateKind(
    name="logic",
    summary="Groups states, watches, or ends something; commands nothing by itself.",
    mode=Mode.NONE,
    flying=False,
)
