"""A mission ready to fly: everything the tick needs that does not change in flight."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from missionkit.chart.model.guard_expressions import Use
from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.semantics.chart_compiler import compile_mission
from missionkit.chart.semantics.chart_memory import begin as begin_chart
from missionkit.chart.semantics.compiled_chart import Chart
from missionkit.engine.contained_navigator import contained
from missionkit.engine.control_law import ControlLaw
from missionkit.engine.flight_state import BehaviorState, FlightMemory, SensorState
from missionkit.engine.ground_floor import floor_of
from missionkit.engine.velocity_law import VelocityLaw
from missionkit.engine.wrench_law import WrenchLaw
from missionkit.errors import UsageError
from missionkit.estimation.builder import build
from missionkit.estimation.navigator import Navigator
from missionkit.estimation.warm_up import warm_up
from missionkit.geometry import Quat, Vec3
from missionkit.goal_pose import facing
from missionkit.messages import CameraModel, Occupancy
from missionkit.perception.vision_pipeline import VisionPipeline
from missionkit.perception.vision_recording import Vision
from missionkit.planning import warm_up as planning
from missionkit.planning.avoidance_planner import AvoidancePlanner
from missionkit.planning.potential_field import brake_of
from missionkit.plugin import Plugin
from missionkit.plugin_containment import PluginError, reporting_faults
from missionkit.plugin_protocols import TrackerProtocol


class PreparedMission(NamedTuple):
    """A mission ready to fly: chart, navigator, vision pipeline and camera model."""

    chart: Chart
    navigator: Navigator
    eye: Vision
    camera: CameraModel
    law: ControlLaw
    facing: Mapping[str, Quat]  # target -> marker attitude as surveyed
    period: float = 0.05  # s
    map: Occupancy | None = None
    tracker: TrackerProtocol | None = None
    arm_anyway: bool = False  # although a failsafe holds on the ground already


def prepare(mission: Mission, catalogue: Catalogue) -> PreparedMission:
    """Build what flies from a mission that was loaded without problems, ready to tick in time.

    Raises:
        UsageError: a navigator, planner or behaviour of another package cannot be made ready.
    """
    warm_up()
    if mission.known is not None:
        planning.warm_up()
    camera = mission.camera.model()
    surveyed = {
        name: (np.array(target.position), target.position_sd)
        for name, target in mission.targets.items()
    }
    turned = {
        name: facing(math.radians(target.facing_deg))
        for name, target in mission.targets.items()
        if target.facing_deg is not None
    }
    navigation = mission.navigation
    chart = compile_mission(mission, catalogue)
    for state in chart.states.values():
        _warm_up("behaviour", state.behavior)
    tracker = None if mission.tracking is None else mission.tracking.plugin
    _warm_up("tracker", tracker)
    for detector in mission.perception:
        _warm_up("detector", detector.plugin)
    return PreparedMission(
        chart=chart,
        navigator=_navigator(navigation.kind, navigation.plugin, surveyed, camera),
        eye=VisionPipeline(camera, [detector.plugin for detector in mission.perception]),
        camera=camera,
        law=_law(mission, chart),
        facing=turned,
        period=1.0 / mission.settings.rate,
        map=mission.known,
        tracker=tracker,
    )


def _law(mission: Mission, chart: Chart) -> ControlLaw:
    period = 1.0 / mission.settings.rate
    control = mission.velocity_control
    if control is None:
        return WrenchLaw(mission.control.plugin, period)
    avoid, surveyed = mission.avoid, {name: it.position[2] for name, it in mission.targets.items()}
    return VelocityLaw(
        control,
        period,
        None if avoid is None else _planner(avoid),
        None if avoid is None else brake_of(avoid.plugin),
        floor_of([state.behavior for state in chart.states.values()], surveyed),
    )


def _navigator(
    kind: str, plugin: Plugin, surveyed: Mapping[str, tuple[Vec3, float]], camera: CameraModel
) -> Navigator:
    try:
        with reporting_faults():  # `chart.plugin_check` has looked at its class
            built = build(plugin, surveyed, camera.mount, camera)
    except PluginError as error:
        raise UsageError(f"navigator {kind!r} cannot be used: build raised {error}") from error
    return contained(kind, plugin, built)


def _warm_up(word: str, plugin: object) -> None:
    """Let a plug-in compile what it needs; one of another package may have nothing to."""
    try:
        with reporting_faults():
            getattr(plugin, "warm_up", lambda: None)()
    except PluginError as error:
        kind = getattr(plugin, "kind", type(plugin).__name__)
        raise UsageError(f"{word} {kind!r} cannot be used: warm_up raised {error}") from error


def _planner(use: Use[AvoidancePlanner]) -> AvoidancePlanner:
    try:
        with reporting_faults():
            use.plugin.begin()
    except PluginError as error:
        raise UsageError(f"planner {use.kind!r} cannot be used: begin raised {error}") from error
    return use.plugin


def begin(plan: PreparedMission, now: float = 0.0) -> FlightMemory:
    """Return the memory before the first tick."""
    return FlightMemory(
        now,
        SensorState(plan.navigator.begin(), plan.eye.begin()),
        begin_chart(plan.chart, now),
        BehaviorState(plan.law.begin(), plan.law.begin_avoidance()),
    )
