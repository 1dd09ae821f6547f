"""Drone missions as YAML state charts: checked, rehearsed in a simulator, flown over MAVLink.

Everything that `__all__` names is public and described in `docs/reference/python-api.md`; it is
imported when it is first used, so that `import missionkit` costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from missionkit.version import __version__ as __version__

if TYPE_CHECKING:
    from missionkit.api.campaign import campaign as campaign
    from missionkit.api.flight import fly as fly
    from missionkit.api.missions import LoadedMission as LoadedMission
    from missionkit.api.missions import load as load
    from missionkit.api.replay import Replay as Replay
    from missionkit.api.replay import ReplayDifference as ReplayDifference
    from missionkit.api.replay import replay as replay
    from missionkit.api.simulation import rehearse as rehearse
    from missionkit.api.validation import validate as validate
    from missionkit.api.what_if import WhatIf as WhatIf
    from missionkit.api.what_if import what_if as what_if
    from missionkit.api.why import Why as Why
    from missionkit.api.why import why as why
    from missionkit.campaigns.analysis import Analysis as Analysis
    from missionkit.engine.flight_loop import Operator as Operator
    from missionkit.errors import FileError as FileError
    from missionkit.errors import MissionkitError as MissionkitError
    from missionkit.errors import NotFitError as NotFitError
    from missionkit.errors import Problem as Problem
    from missionkit.errors import UsageError as UsageError
    from missionkit.errors import VehicleError as VehicleError
    from missionkit.messages import Action as Action
    from missionkit.messages import Battery as Battery
    from missionkit.messages import BoxDetection as BoxDetection
    from missionkit.messages import CameraModel as CameraModel
    from missionkit.messages import Command as Command
    from missionkit.messages import Detection as Detection
    from missionkit.messages import Estimate as Estimate
    from missionkit.messages import Fired as Fired
    from missionkit.messages import Frame as Frame
    from missionkit.messages import Goal as Goal
    from missionkit.messages import GroundDetection as GroundDetection
    from missionkit.messages import GroundFrame as GroundFrame
    from missionkit.messages import Guidance as Guidance
    from missionkit.messages import HalfSpace as HalfSpace
    from missionkit.messages import Health as Health
    from missionkit.messages import Look as Look
    from missionkit.messages import Mode as Mode
    from missionkit.messages import Observation as Observation
    from missionkit.messages import Occupancy as Occupancy
    from missionkit.messages import Record as Record
    from missionkit.messages import Sighting as Sighting
    from missionkit.messages import Step as Step
    from missionkit.messages import Target as Target
    from missionkit.messages import VehicleStatus as VehicleStatus
    from missionkit.messages import Verdict as Verdict
    from missionkit.messages import Wrench as Wrench
    from missionkit.messages.region import Interval as Interval
    from missionkit.messages.region import Quantity as Quantity
    from missionkit.messages.region import Region as Region
    from missionkit.plugin import Behavior as Behavior
    from missionkit.plugin import BoxDetector as BoxDetector
    from missionkit.plugin import CompositeGuard as CompositeGuard
    from missionkit.plugin import Detector as Detector
    from missionkit.plugin import Guard as Guard
    from missionkit.plugin import Plugin as Plugin
    from missionkit.plugin import WindowGuard as WindowGuard
    from missionkit.plugin_protocols import Inputs as Inputs
    from missionkit.plugin_protocols import NamedInput as NamedInput
    from missionkit.plugin_protocols import Prior as Prior
    from missionkit.recorder.run_summary import Summary as Summary
    from missionkit.recorder.topic_bus import Subscription as Subscription
    from missionkit.recorder.topic_bus import TopicBus as TopicBus
    from missionkit.recorder.topic_bus import subscribe as subscribe

_HOMES = {  # module -> what it gives
    "api.campaign": ("campaign",),
    "api.flight": ("fly",),
    "api.missions": ("LoadedMission", "load"),
    "api.replay": ("Replay", "ReplayDifference", "replay"),
    "api.simulation": ("rehearse",),
    "api.validation": ("validate",),
    "api.what_if": ("WhatIf", "what_if"),
    "api.why": ("Why", "why"),
    "campaigns.analysis": ("Analysis",),
    "engine.flight_loop": ("Operator",),
    "errors": (
        *("FileError", "MissionkitError", "NotFitError", "Problem", "UsageError", "VehicleError"),
    ),
    "messages": (
        *("Action", "Battery", "BoxDetection", "CameraModel", "Command", "Detection", "Estimate"),
        *("Fired", "Frame", "Goal", "GroundDetection", "GroundFrame"),
        *(
            "Guidance",
            "HalfSpace",
            "Health",
            "Look",
            "Mode",
            "Observation",
            "Occupancy",
            "Record",
        ),
        *("Sighting", "Step", "Target", "VehicleStatus", "Verdict", "Wrench"),
    ),
    "messages.region": ("Interval", "Quantity", "Region"),
    "plugin": (
        *("Behavior", "BoxDetector", "CompositeGuard", "Detector", "Guard", "Plugin"),
        "WindowGuard",
    ),
    "plugin_protocols": ("Inputs", "NamedInput", "Prior"),
    "recorder.run_summary": ("Summary",),
    "recorder.topic_bus": ("Subscription", "TopicBus", "subscribe"),
}
_HOME_OF = {name: module for module, names in _HOMES.items() for name in names}

__all__ = sorted([*_HOME_OF, "__version__"])  # noqa: PLE0605 - a list, built once

if not TYPE_CHECKING:  # a type checker reads the imports above, and refuses every other name

    def __getattr__(name: str) -> object:
        """Import a public name when it is first used."""
        if name not in _HOME_OF:
            raise AttributeError(f"module 'missionkit' has no attribute {name!r}")
        value = getattr(import_module(f"missionkit.{_HOME_OF[name]}"), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    return __all__
