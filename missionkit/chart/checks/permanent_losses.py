"""Situations in which something is lost for good in the air."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.guards.battery import CHARGE
from missionkit.guards.camera_silence import MISSED
from missionkit.guards.converged import GOAL_AGE
from missionkit.guards.detection_confidence import confidence_of
from missionkit.guards.estimate_quality import FIX_AGE, POSITION_SD
from missionkit.guards.link_loss import SILENCE
from missionkit.guards.plugin_failure import FAILING
from missionkit.guards.target_visibility import time_since_seen, time_without
from missionkit.guards.tracked_targets import COUNTED
from missionkit.messages import TRACKED
from missionkit.messages.region import ONLY_FALSE, ONLY_TRUE, Box, Interval, Quantity

FOR_EVER = Interval.at_least(1e9)  # of whatever grows while something is lost


class Loss(NamedTuple):
    """Something that is lost, and for good."""

    name: str
    says: str
    box: Box
    remedy: str


def losses(chart: AnalysedChart) -> Iterator[Loss]:
    """Yield what may be lost in a mission."""
    failsafe = "failsafes: [{{name: {}, when: {{use: {}}}, to: ...}}]".format
    yield Loss("link", "link lost", {SILENCE: FOR_EVER}, failsafe("link", "link_lost"))
    yield Loss(
        "battery",
        "battery empty",
        {CHARGE: ONLY_FALSE},
        failsafe("battery", "battery_below, floor: 0.2"),
    )
    lost: Box = {POSITION_SD: FOR_EVER, FIX_AGE: FOR_EVER}
    yield Loss("position", "position lost", lost, failsafe("lost", "estimate_bad"))
    if chart.mission.perception and chart.mission.camera.use != "none":
        yield Loss("camera", "camera lost", _blind(chart), failsafe("camera", "camera_silent"))
    yield Loss("plug-in", "a plug-in fails", {FAILING: ONLY_TRUE}, "")


def _blind(chart: AnalysedChart) -> Box:
    box: dict[Quantity, Interval | None] = {MISSED: FOR_EVER, GOAL_AGE: FOR_EVER}
    found = {str(getattr(it.plugin, "target", "")) for it in chart.mission.perception}
    if chart.mission.tracking is not None:
        found.add(TRACKED)
        box[COUNTED["any"]] = box[COUNTED["target"]] = box[COUNTED["obstacle"]] = ONLY_FALSE
    for target in sorted(found - {""}):
        box[confidence_of(target)] = ONLY_FALSE
        box[time_since_seen(target)] = FOR_EVER
        box[time_without(target)] = FOR_EVER
    return box
