"""Visual: servoing on a marker.

The invariant of P1, section 7.3, asks for C_aruco, a share of the last 30 frames. Its threshold is
the mission's to choose, so that here the lock is what is checked: that the marker was seen within
the last half second. C_aruco is the guard `aruco_confidence`.
"""

from missionkit.messages import Estimate, Mode, Verdict
from missionkit.number_text import beside
from missionkit.states.contract import KindInvariant, StateKind
from missionkit.states.shared_failsafes import LOCK_LIMIT, LOCK_LOST, UNREACHABLE

SURE_WITHIN = 0.5  # s: a lock this fresh needs more than half of 20 Hz frames


def _locked(seen: Estimate, target: str | None) -> Verdict:
    if target is None:
        return Verdict(holds=True)
    found = seen.targets.get(target)
    if found is None or found.seen_at is None:
        return Verdict(holds=False, why=f"{target} was never seen")
    ago = seen.now - found.seen_at
    shown, limit = beside(ago, SURE_WITHIN, 2)
    late = f"{target} was last seen {shown} s ago, more than {limit} s"
    return Verdict.at_most(ago, SURE_WITHIN, late if ago > SURE_WITHIN else "")


VISUAL = StateKind(
    name="visual",
    summary="Approaching a marker by what the camera sees.",
    mode=Mode.VISUAL,
    flying=True,
    must_reach=("search", "land"),
    invariant=KindInvariant(
        "visual_target ≠ ∅ ∧ t - t_seen ≤ 0.5 s", _locked, LOCK_LIMIT, to_kind="search"
    ),
    failsafes=(LOCK_LOST, UNREACHABLE),
)
