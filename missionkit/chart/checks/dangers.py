"""What may be lost in the air, as situations."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from missionkit.chart.checks.ways import Chart
from missionkit.guards.battery import CHARGE
from missionkit.guards.camera import MISSED
from missionkit.guards.confidence import confidence_of
from missionkit.guards.converged import GOAL_AGE
from missionkit.guards.estimate import FIX_AGE, POSITION_SD
from missionkit.guards.link import SILENCE
from missionkit.guards.plugins import FAILING
from missionkit.guards.target import time_since_seen, time_without
from missionkit.messages.region import NO, YES, Box, Interval, Quantity

EVER = Interval.at_least(1e9)  # of whatever grows while something is lost


class Danger(NamedTuple):
    """Something that is lost, and for good."""

    name: str
    says: str
    box: Box
    remedy: str


def dangers(chart: Chart) -> Iterator[Danger]:
    """Yield what may be lost in a mission."""
    failsafe = "failsafes: [{{name: {}, when: {{use: {}}}, to: ...}}]".format
    yield Danger("link", "link lost", {SILENCE: EVER}, failsafe("link", "link_lost"))
    yield Danger(
        "battery", "battery empty", {CHARGE: NO}, failsafe("battery", "battery_below, floor: 0.2")
    )
    lost: Box = {POSITION_SD: EVER, FIX_AGE: EVER}
    yield Danger("position", "position lost", lost, failsafe("lost", "estimate_bad"))
    if chart.mission.perception and chart.mission.camera.use != "none":
        yield Danger("camera", "camera lost", _blind(chart), failsafe("camera", "camera_silent"))
    yield Danger("plug-in", "a plug-in fails", {FAILING: YES}, "")


def _blind(chart: Chart) -> Box:
    box: dict[Quantity, Interval | None] = {MISSED: EVER, GOAL_AGE: EVER}
    for detector in chart.mission.perception:
        target = str(getattr(detector.plugin, "target", ""))
        box[confidence_of(target)] = NO
        box[time_since_seen(target)] = EVER
        box[time_without(target)] = EVER
    return box
