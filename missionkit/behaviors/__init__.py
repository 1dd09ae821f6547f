"""Behaviours: what a state does, as guidance for the controller or a request to the autopilot."""

from missionkit.behaviors.area_search import ExpandingSquare, Sector
from missionkit.behaviors.climb import Climb
from missionkit.behaviors.climb_clear import ClimbClear
from missionkit.behaviors.ddp_go_to import DdpGoTo
from missionkit.behaviors.devices import Gripper, Photo, SetRelay, SetServo
from missionkit.behaviors.docking import DOCKING
from missionkit.behaviors.follow import Follow
from missionkit.behaviors.follow_path import FollowPath
from missionkit.behaviors.go_to import GoTo
from missionkit.behaviors.herd import Herd
from missionkit.behaviors.hold import Hold
from missionkit.behaviors.inject import Inject
from missionkit.behaviors.land import Land
from missionkit.behaviors.land_on import LandOn
from missionkit.behaviors.loiter import Loiter
from missionkit.behaviors.orbit import Orbit
from missionkit.behaviors.point_at import PointAt
from missionkit.behaviors.robot_contact import LandInFront, TouchTop
from missionkit.behaviors.servo import Servo
from missionkit.behaviors.shadow import Shadow
from missionkit.behaviors.spiral import Spiral
from missionkit.behaviors.survey import Corridor, Survey
from missionkit.behaviors.take_off import TakeOff
from missionkit.behaviors.waypoints import Waypoints

BEHAVIORS = (
    *DOCKING,
    Climb,
    ClimbClear,
    Corridor,
    DdpGoTo,
    ExpandingSquare,
    Follow,
    FollowPath,
    GoTo,
    Gripper,
    Herd,
    Hold,
    Inject,
    Land,
    LandInFront,
    Loiter,
    Orbit,
    Photo,
    PointAt,
    LandOn,
    Sector,
    Servo,
    SetRelay,
    SetServo,
    Shadow,
    Spiral,
    Survey,
    TakeOff,
    TouchTop,
    Waypoints,
)
