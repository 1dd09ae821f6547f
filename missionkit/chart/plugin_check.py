"""Checks plug-in classes before a mission may use them, whatever package they come from."""

from __future__ import annotations

import inspect
from collections.abc import Mapping

from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.estimation.optical_flow.flow_parameters import FlowKalman
from missionkit.perception.aruco import Aruco
from missionkit.plugin import Behavior, Detector, Guard, Plugin, WindowGuard

BASES: Mapping[str, tuple[type[Plugin], ...]] = {
    "guards": (Guard, WindowGuard),
    "behaviors": (Behavior,),
    "navigators": (Plugin,),
    "detectors": (Detector, Aruco),
    "planners": (Plugin,),
}
METHODS: Mapping[str, Mapping[str, int]] = {  # name -> number of arguments
    "navigators": {"build": 2},  # estimation.navigating.Navigation
    "planners": {"begin": 0, "step": 4},  # planning.avoiding.Avoids
}
BUILT_HERE = (VisualInertialEkf, FlowKalman)  # by `estimation.builder`


def wrong_with(group: str, plugin: object) -> str:
    """Say why something cannot be a plug-in of a group; "": nothing is wrong."""
    bases = BASES[group]
    if not (isinstance(plugin, type) and issubclass(plugin, bases)):
        names = " or ".join(base.__name__ for base in bases)
        return f"{plugin!r} is not a class derived from {names}"
    if not isinstance(getattr(plugin, "kind", None), str):
        return f"{plugin.__name__} has no `kind`, the name that mission files use"
    if missing := sorted(getattr(plugin, "__abstractmethods__", ())):
        return f"{plugin.__name__} lacks the method {', '.join(missing)}"
    if issubclass(plugin, BUILT_HERE):
        return ""
    wrong = (_lacks(plugin, name, count) for name, count in METHODS.get(group, {}).items())
    return next(filter(None, wrong), "")


def _lacks(plugin: type[Plugin], name: str, count: int) -> str:
    method = inspect.getattr_static(plugin, name, None)
    if not inspect.isfunction(method):
        return f"{plugin.__name__} lacks the method {name}"
    try:
        inspect.signature(method).bind(*range(count + 1))
    except TypeError as error:
        return f"{plugin.__name__}.{name} must take {count} arguments: {error}"
    return ""
