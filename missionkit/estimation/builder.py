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
from missionkit.estimation.ud_vision.parameters import UdVisionEkf
from missionkit.estimation.ud_vision.ud_vision_filter import UdVisionFilter
from missionkit.geometry import Transform, Vec3
from missionkit.messages import CameraModel
from missionkit.plugin import Plugin

Surveyed = Mapping[str, tuple[Vec3, float]]


def build(
    parameters: Plugin, surveyed: Surveyed, mount: Transform, camera: CameraModel | None = None
) -> Navigator:
    """Return the navigator of `navigation:`, its kernels compiled.

    Args:
        parameters: of a built-in navigator, or of a plug-in, which has a `build` of its own.
        surveyed: where the mission file says each target is: (3,), m, NED, and its sd (m).
        mount: camera to body.
        camera: its lens too, for a navigator that looks at images.
    """
    if isinstance(parameters, UdVisionEkf):
        if camera is None:
            raise ValueError(f"{parameters.kind} needs the camera")
        seeing = UdVisionFilter(parameters, surveyed, camera)
        seeing.warm_up()
        return seeing
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
