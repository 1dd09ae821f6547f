"""Guards: predicates over the estimate that answer holds, does not hold, or cannot tell."""

from missionkit.guards.battery import BatteryBelow
from missionkit.guards.camera import CameraSilent
from missionkit.guards.confidence import ArucoConfidence
from missionkit.guards.converged import Converged
from missionkit.guards.disturbed import Disturbed
from missionkit.guards.estimate import EstimateBad, GnssLost
from missionkit.guards.fence import InsideFence
from missionkit.guards.ground import GroundTouched
from missionkit.guards.link import LinkLost
from missionkit.guards.plugins import PluginFailed
from missionkit.guards.progress import Done, Elapsed, GoalUnreachable
from missionkit.guards.range import NearGoal, Within
from missionkit.guards.ready import Ready
from missionkit.guards.target import TargetLost, TargetSeen
from missionkit.guards.timing import TickOverrun
from missionkit.guards.visual import GpsToVisual

ALL = (
    ArucoConfidence,
    BatteryBelow,
    CameraSilent,
    Converged,
    Disturbed,
    Done,
    Elapsed,
    EstimateBad,
    GnssLost,
    GoalUnreachable,
    GpsToVisual,
    GroundTouched,
    InsideFence,
    LinkLost,
    NearGoal,
    PluginFailed,
    Ready,
    TargetLost,
    TargetSeen,
    TickOverrun,
    Within,
)
