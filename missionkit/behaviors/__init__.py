"""Behaviours: what a state does, as guidance for the controller or a request to the autopilot."""

from missionkit.behaviors.ddp_go_to import DdpGoTo
from missionkit.behaviors.docking import DOCKING
from missionkit.behaviors.follow_path import FollowPath
from missionkit.behaviors.go_to import GoTo
from missionkit.behaviors.herd import Herd
from missionkit.behaviors.hold import Hold
from missionkit.behaviors.inject import Inject
from missionkit.behaviors.land import Land
from missionkit.behaviors.precision_land import PrecisionLand
from missionkit.behaviors.robot_contact import LandInFront, TouchTop
from missionkit.behaviors.servo import Servo
from missionkit.behaviors.shadow import Shadow
from missionkit.behaviors.spiral import Spiral
from missionkit.behaviors.take_off import TakeOff

BEHAVIORS = (
    *DOCKING,
    DdpGoTo,
    FollowPath,
    GoTo,
    Herd,
    Hold,
    Inject,
    Land,
    LandInFront,
    PrecisionLand,
    Servo,
    Shadow,
    Spiral,
    TakeOff,
    TouchTop,
)
