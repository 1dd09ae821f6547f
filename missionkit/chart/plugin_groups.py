"""The groups of plug-ins: one entry is all that a group needs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from missionkit.behaviors import BEHAVIORS
from missionkit.control.controller import Control
from missionkit.control.controller_protocol import ControllerProtocol
from missionkit.control.lqr import Lqr
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.estimation.navigator import NavigatorParameters
from missionkit.estimation.optical_flow.flow_parameters import FlowKalman
from missionkit.estimation.tandem_ekf.parameters import CompoundEkf, TandemEkf
from missionkit.estimation.target_tracking.tracker import MultiTargetTracker
from missionkit.estimation.ud_vision.parameters import UdVisionEkf
from missionkit.guards import GUARDS
from missionkit.perception.apriltag import AprilTag
from missionkit.perception.aruco import Aruco
from missionkit.perception.blob import Blob
from missionkit.perception.haar.detector import Haar
from missionkit.perception.template.detector import Template
from missionkit.perception.tower import Tower
from missionkit.planning.avoidance_planner import AvoidancePlanner
from missionkit.planning.herding.dynamic_programme import DynamicProgramme
from missionkit.planning.herding.nearest_to_goal import NearestToGoal
from missionkit.planning.potential_field import PotentialField
from missionkit.plugin import Plugin
from missionkit.plugin_protocols import (
    BehaviorProtocol,
    BoxDetectorProtocol,
    CompositeGuardProtocol,
    DetectorProtocol,
    GuardProtocol,
    HerdingPolicyProtocol,
    TrackerProtocol,
    WindowGuardProtocol,
)


class PluginGroup(NamedTuple):
    """A group of plug-ins: its name in messages, its contracts, and its built-in classes."""

    word: str  # for one of them, in messages
    contracts: tuple[type, ...]  # protocols; a class satisfies one of them
    builtin: tuple[type[Plugin], ...]
    bases: tuple[type[Plugin], ...] = ()  # parameters of what the package builds: no methods needed


PLUGIN_GROUPS: Mapping[str, PluginGroup] = {
    # name of the section in `missionkit plugins`, and of the entry points `missionkit.NAME`
    "guards": PluginGroup(
        "guard", (GuardProtocol, WindowGuardProtocol, CompositeGuardProtocol), GUARDS
    ),
    "behaviors": PluginGroup("behaviour", (BehaviorProtocol,), BEHAVIORS),
    "navigators": PluginGroup(
        "navigator",
        (NavigatorParameters,),
        builtin=(FlowKalman, VisualInertialEkf, UdVisionEkf, TandemEkf, CompoundEkf),
        bases=(FlowKalman, VisualInertialEkf, UdVisionEkf, TandemEkf, CompoundEkf),
    ),
    "detectors": PluginGroup(
        "detector",
        (DetectorProtocol, BoxDetectorProtocol),
        (AprilTag, Aruco, Blob, Haar, Template, Tower),
        bases=(Aruco,),
    ),
    "trackers": PluginGroup("tracker", (TrackerProtocol,), (MultiTargetTracker,)),
    "planners": PluginGroup("planner", (AvoidancePlanner,), (PotentialField,)),
    "controllers": PluginGroup("controller", (ControllerProtocol,), (Control, Lqr)),
    "herding_policies": PluginGroup(
        "herding policy", (HerdingPolicyProtocol,), (DynamicProgramme, NearestToGoal)
    ),
}
