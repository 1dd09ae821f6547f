"""From the parameters that a mission file gives to the navigator that flies."""

from __future__ import annotations

from collections.abc import Mapping
from typing import cast

from missionkit.estimation.error_state_ekf.filter import ErrorStateEkf
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.estimation.navigator import Navigator, NavigatorParameters
from missionkit.estimation.optical_flow.flow_filter import FlowFilter
from missionkit.estimation.optical_flow.flow_parameters import FlowKalman
from missionkit.estimation.tandem_ekf.filter import FlyerFilter
from missionkit.estimation.tandem_ekf.parameters import FlyerEkf
from missionkit.geometry import Transform, Vec3
from missionkit.plugin import Plugin

Surveyed = Mapping[str, tuple[Vec3, float]]


def build(parameters: Plugin, surveyed: Surveyed, mount: Transform) -> Navigator:
    """Return the navigator of `navigation:`, its kernels compiled.

    Args:
        parameters: of a built-in navigator, or of a plug-in, which has a `build` of its own.
        surveyed: where the mission file says each target is: (3,), m, NED, and its sd (m).
        mount: camera to body.
    """
    if not hasattr(parameters, "build"):
        if isinstance(parameters, VisualInertialEkf):
            return ErrorStateEkf(parameters, surveyed, mount)
        if isinstance(parameters, FlowKalman):
            navigator = FlowFilter(parameters, surveyed)
            navigator.warm_up()
            return navigator
        if isinstance(parameters, FlyerEkf):
            flyer = FlyerFilter(parameters, surveyed)
            flyer.warm_up()
            return flyer
    return cast(NavigatorParameters, parameters).build(surveyed, mount)
