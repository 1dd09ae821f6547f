"""The groups of plug-ins: one entry is all that a group needs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from missionkit.behaviors import BEHAVIORS
from missionkit.control.controller_protocol import ControllerProtocol
from missionkit.estimation.navigator import NavigatorParameters
from missionkit.guards import GUARDS
from missionkit.planning.avoidance_planner import AvoidancePlanner
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
    builtin: Mapping[str, str]  # name -> class; imported when a mission names it
    bases: tuple[str, ...] = ()  # parameters of what the package builds: no methods needed


_NAVIGATORS = {
    "compound_ekf": "missionkit.estimation.tandem_ekf.parameters.CompoundEkf",
    "flow_kalman": "missionkit.estimation.optical_flow.flow_parameters.FlowKalman",
    "tandem_ekf": "missionkit.estimation.tandem_ekf.parameters.TandemEkf",
    "ud_vision_ekf": "missionkit.estimation.ud_vision.parameters.UdVisionEkf",
    "visual_inertial_ekf": "missionkit.estimation.error_state_ekf.parameters.VisualInertialEkf",
}

PLUGIN_GROUPS: Mapping[str, PluginGroup] = {
    # name of the section in `missionkit plugins`, and of the entry points `missionkit.NAME`
    "guards": PluginGroup(
        "guard", (GuardProtocol, WindowGuardProtocol, CompositeGuardProtocol), GUARDS
    ),
    "behaviors": PluginGroup("behaviour", (BehaviorProtocol,), BEHAVIORS),
    "navigators": PluginGroup(
        "navigator", (NavigatorParameters,), _NAVIGATORS, bases=(*_NAVIGATORS.values(),)
    ),
    "detectors": PluginGroup(
        "detector",
        (DetectorProtocol, BoxDetectorProtocol),
        {
            "apriltag": "missionkit.perception.apriltag.AprilTag",
            "aruco": "missionkit.perception.aruco.Aruco",
            "blob": "missionkit.perception.blob.Blob",
            "haar": "missionkit.perception.haar.detector.Haar",
            "template": "missionkit.perception.template.detector.Template",
            "tower": "missionkit.perception.tower.Tower",
        },
        bases=("missionkit.perception.aruco.Aruco",),
    ),
    "trackers": PluginGroup(
        "tracker",
        (TrackerProtocol,),
        {
            "tracker": "missionkit.estimation.target_tracking.tracker.MultiTargetTracker",
        },
    ),
    "planners": PluginGroup(
        "planner",
        (AvoidancePlanner,),
        {
            "potential_field": "missionkit.planning.potential_field.PotentialField",
        },
    ),
    "controllers": PluginGroup(
        "controller",
        (ControllerProtocol,),
        {
            "lqr": "missionkit.control.lqr.Lqr",
            "velocity_pid": "missionkit.control.controller.Control",
        },
    ),
    "herding_policies": PluginGroup(
        "herding policy",
        (HerdingPolicyProtocol,),
        {
            "dynamic_programme": "missionkit.planning.herding.dynamic_programme.DynamicProgramme",
            "nearest_to_goal": "missionkit.planning.herding.nearest_to_goal.NearestToGoal",
        },
    ),
}
