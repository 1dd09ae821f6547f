"""Task: the work the mission is flown for."""

import math

from missionkit.geometry import norm, wrap
from missionkit.messages import Estimate, Mode, Verdict
from missionkit.number_text import beside
from missionkit.states.contract import KindFailsafe, KindInvariant, StateKind
from missionkit.states.shared_failsafes import LOCK_LIMIT, LOCK_LOST

TASK_POSITION = 0.10  # m, ε_pos
YAW = 5.0  # deg, ε_yaw


def _on_goal(seen: Estimate, _: str | None) -> Verdict:
    if seen.goal is None:
        return Verdict.unknown("the behaviour has no goal yet")
    error = norm(seen.position - seen.goal.position)
    if error > TASK_POSITION or seen.goal.yaw is None:
        shown, limit = beside(error, TASK_POSITION, 2)
        far = f"{shown} m from its goal, more than {limit} m"
        return Verdict.at_most(error, TASK_POSITION, far if error > TASK_POSITION else "")
    turned = math.degrees(abs(wrap(seen.goal.yaw - seen.yaw)))
    shown, limit = beside(turned, YAW, 1)
    aside = f"turned {shown} deg from its goal's heading, more than {limit} deg"
    return Verdict.at_most(turned, YAW, aside if turned > YAW else "")


LEAVE_WHEN_PUSHED = KindFailsafe("disturbed", "disturbed", {}, to_kind="visual", emergency=True)
"""A gust at work: leave it backwards, to where it was approached from."""

TASK = StateKind(
    name="task",
    summary="Working at the goal pose, within its tolerance.",
    mode=Mode.VISUAL,
    flying=True,
    must_reach=("land",),
    invariant=KindInvariant(
        "‖e_p‖ ≤ ε_pos ∧ |e_ψ| ≤ ε_yaw", _on_goal, tolerated=LOCK_LIMIT, to_kind="visual"
    ),
    failsafes=(LEAVE_WHEN_PUSHED, LOCK_LOST),
)
