"""Behaviours that order devices which the vehicle, as the mission describes it, does not have."""

from __future__ import annotations

import math
from collections.abc import Iterator

from missionkit.behaviors.devices import Gripper, Photo, SetRelay, SetServo
from missionkit.behaviors.gimbal import Gimbal
from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.errors import Level, Place, Problem
from missionkit.perception.camera_section import Camera

DEVICES = (Photo, SetServo, SetRelay, Gripper, Gimbal)


def problems_of(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield each behaviour whose device is missing, and each gimbal that cannot turn so far."""
    mission, kind = chart.mission, chart.tree.catalogue.vehicle
    for name, state, _ in chart.tree.states.values():
        use = state.behavior
        if use is None or not isinstance(use.plugin, DEVICES):
            continue
        says = f"state {name!r}: behaviour {use.kind!r}"
        if not kind.over_mavlink:
            says += f" orders a device that a {kind.name.replace('_', ' ')} does not have"
            yield _missing(use.place, f"{says}: nothing happens", "leave the state out")
        elif isinstance(use.plugin, Gimbal):
            yield from _gimbal(use.plugin, mission.camera, use.place, says)
    if mission.camera.gimbal is not None and getattr(mission.navigation.plugin, "images", False):
        yield Problem(
            mission.navigation.place,
            f"navigator {mission.navigation.kind!r} needs a camera that is fixed to the body, but "
            "'camera' has a gimbal",
            Level.ERROR,
            "no-images",
            "camera: {mount: {tilt_deg: 90}}, without a gimbal",
        )


def _gimbal(plugin: Gimbal, camera: Camera, place: Place, says: str) -> Iterator[Problem]:
    """Yield what keeps a gimbal from turning as it is ordered."""
    section = camera.gimbal
    if section is None or camera.use == "none":
        lacks = "has no 'gimbal'" if section is None else "is 'use: none'"
        yield _missing(place, f"{says} turns the camera, which {lacks}", "camera: {gimbal: {}}")
        return
    if plugin.angles is None:
        return
    for axis, angle, (low, high) in (
        ("pitch", math.degrees(plugin.angles.pitch), section.pitch_deg),
        ("yaw", math.degrees(plugin.angles.yaw), section.yaw_deg),
    ):
        if not low - 1e-9 <= angle <= high + 1e-9:
            yield Problem(
                place,
                f"{says} turns to a {axis} of {angle:g} deg, and the gimbal reaches {low:g} to "
                f"{high:g}: it stops there, and the state lasts its whole 'patience'",
                Level.ERROR,
                "out-of-reach",
                f"{axis}_deg within those limits, or camera: {{gimbal: {{{axis}_deg: ...}}}}",
            )


def _missing(place: Place, says: str, remedy: str) -> Problem:
    return Problem(place, says, Level.ERROR, "no-device", remedy)
