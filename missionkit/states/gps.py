"""GPS: waypoint flight."""

from missionkit.messages import Estimate, Mode, Verdict
from missionkit.states.contract import KindInvariant, StateKind
from missionkit.states.shared_failsafes import HOVER, UNREACHABLE


def _has_goal(seen: Estimate, target: str | None) -> Verdict:
    known = target is None or target in seen.targets
    return Verdict(known, "" if known else f"the position of {target} is unknown")


GPS_KIND = StateKind(
    name="gps",
    summary="Flying to a place by satellite and inertial navigation, past obstacles.",
    mode=Mode.GPS,
    flying=True,
    must_reach=("land",),
    invariant=KindInvariant("gps_target ≠ ∅", _has_goal, tolerated=1.0, to_kind=HOVER),
    failsafes=(UNREACHABLE,),
)
