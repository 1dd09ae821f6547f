"""Guards: predicates over the estimate that answer holds, does not hold, or cannot tell."""

from missionkit.guards.battery import BatteryBelow
from missionkit.guards.camera_silence import CameraSilent
from missionkit.guards.converged import Converged
from missionkit.guards.coverage import Covered
from missionkit.guards.detection_confidence import ArucoConfidence
from missionkit.guards.distances import NearGoal, Within
from missionkit.guards.disturbance import Disturbed
from missionkit.guards.estimate_quality import EstimateBad, GnssLost
from missionkit.guards.event_count import Count
from missionkit.guards.geofence import Inside, InsideFence
from missionkit.guards.gps_to_visual import GpsToVisual
from missionkit.guards.ground_height import HeightAboveGround
from missionkit.guards.ground_touched import GroundTouched
from missionkit.guards.link_loss import LinkLost
from missionkit.guards.markov_steady_state import MarkovSteadyState
from missionkit.guards.markov_switch import MarkovSwitch
from missionkit.guards.mdp_policy import MdpPolicy
from missionkit.guards.obstacle_robots import ObstacleRobotNear
from missionkit.guards.plugin_failure import PluginFailed
from missionkit.guards.readiness import Ready
from missionkit.guards.separation import SeparationBelow
from missionkit.guards.sequential_test import Sprt
from missionkit.guards.state_progress import Done, Elapsed, GoalUnreachable
from missionkit.guards.target_visibility import TargetLost, TargetSeen
from missionkit.guards.tick_timing import TickOverrun
from missionkit.guards.tracked_targets import (
    TargetHeading,
    TargetMode,
    TargetsInView,
    TimeToReversal,
)
from missionkit.guards.visits import Visited
from missionkit.guards.wind_speed import WindAbove

GUARDS = (
    ArucoConfidence,
    BatteryBelow,
    CameraSilent,
    Converged,
    Count,
    Covered,
    Disturbed,
    Done,
    Elapsed,
    EstimateBad,
    GnssLost,
    GoalUnreachable,
    GpsToVisual,
    GroundTouched,
    HeightAboveGround,
    Inside,
    InsideFence,
    LinkLost,
    MarkovSteadyState,
    MarkovSwitch,
    MdpPolicy,
    NearGoal,
    ObstacleRobotNear,
    PluginFailed,
    Ready,
    SeparationBelow,
    Sprt,
    TargetHeading,
    TargetLost,
    TargetMode,
    TargetSeen,
    TargetsInView,
    TickOverrun,
    TimeToReversal,
    Visited,
    WindAbove,
    Within,
)
