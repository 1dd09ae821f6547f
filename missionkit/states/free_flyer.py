"""Free flyer: a small satellite that flies by thrusters and docks (P3).

Its kinds of state are the multicopter's by name. They differ where a velocity of centimetres per
second takes longer, where nothing lands, and where docking asks for millimetres.
"""

from __future__ import annotations

from dataclasses import replace
from types import MappingProxyType

from missionkit.geometry import norm
from missionkit.messages import Estimate, Mode, Verdict
from missionkit.number_text import beside
from missionkit.states.contract import KindFailsafe, KindInvariant
from missionkit.states.custom import CUSTOM_KIND
from missionkit.states.gps import GPS_KIND
from missionkit.states.hover import HOVER_STATE
from missionkit.states.idle import IDLE_KIND
from missionkit.states.land import LAND_KIND
from missionkit.states.logic import LOGIC
from missionkit.states.returning import RETURN_KIND
from missionkit.states.search import SEARCH
from missionkit.states.shared_failsafes import LOCK_LOST
from missionkit.states.task import TASK
from missionkit.states.vehicle_kind import VehicleKind
from missionkit.states.visual import VISUAL

DOCKED_POSITION = 0.02  # m from the docked place, in `task`
SLIPPED_FOR = 2.0  # s
TURNING_LIMIT = 300.0  # s, half a turn at a degree per second, and the way
STUCK = KindFailsafe(
    "unreachable",
    "goal_unreachable",
    {"further_than": 0.3, "progress": 0.05, "longer_than": 60.0},  # m, m, s
    "hover",
)


def _docked(seen: Estimate, _: str | None) -> Verdict:
    if seen.goal is None:
        return Verdict.unknown("the behaviour has no goal yet")
    error = norm(seen.position - seen.goal.position)
    shown, limit = beside(100.0 * error, 100.0 * DOCKED_POSITION, 1)
    far = f"{shown} cm from the docked place, more than {limit} cm"
    return Verdict.at_most(error, DOCKED_POSITION, far if error > DOCKED_POSITION else "")


_FLYER_STATE_KINDS = (
    replace(IDLE_KIND, summary="Thrusters off, or holding."),
    replace(
        GPS_KIND,
        summary="Flying by radio ranges, towards the target or in front of it.",
        failsafes=(STUCK,),
    ),
    replace(
        VISUAL,
        summary="Flying in on the features that the camera sees.",
        failsafes=(LOCK_LOST, STUCK),
    ),
    replace(
        SEARCH,
        summary="Turning until the camera looks at the target.",
        failsafes=(
            KindFailsafe("search-timeout", "elapsed", {"longer_than": TURNING_LIMIT}, "return"),
        ),
    ),
    replace(
        TASK,
        summary="At the docked place, within its tolerance.",
        invariant=KindInvariant("‖e_p‖ ≤ 2 cm", _docked, tolerated=SLIPPED_FOR, to_kind="visual"),
        failsafes=(),
    ),
    replace(RETURN_KIND, summary="Backing off.", failsafes=(replace(STUCK, to_kind="land"),)),
    replace(
        LAND_KIND,
        summary="Docked, or clear of the target and at rest; thrusters off.",
        mode=Mode.GPS,
        default_behavior=None,
    ),
    HOVER_STATE,
    CUSTOM_KIND,
    LOGIC,
)

FREE_FLYER = VehicleKind(
    name="free_flyer",
    summary="A small satellite with thrusters that docks; in the simulator only.",
    setpoint="wrench",
    sections=MappingProxyType({"navigation": "tandem_ekf", "avoid": "none", "control": "lqr"}),
    kinds=MappingProxyType({kind.name: kind for kind in _FLYER_STATE_KINDS}),
    estimate_limit=0.3,
    ending_limit=1.0,
    over_mavlink=False,
    over_ground=False,
)
