"""The missions that benchmarks fly."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Literal

from missionkit.chart.load import load
from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import builtin
from missionkit.engine.flight_loop import Observer
from missionkit.rehearsal.grading import Rehearsal
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import Stage, stage, world_of

MISSION = Path("missions/precision_task.yaml")
KNOWN_MAP = Path("missions/known_map.yaml")
Eyes = Literal["rendered", "corners", "none"]


def ready(eyes: Eyes, seed: int = 0) -> Stage:
    """Set up one flight of the precision task; with no camera, to the tree and back."""
    mission = load(MISSION, builtin())
    mission = mission.model_copy(update={"camera": mission.camera.model_copy(update={"use": eyes})})
    if eyes == "none":
        mission = _by_gps_alone(mission)
    return stage(mission, builtin(), world_of(mission, MISSION.parent), seed)


def past_two_walls(seed: int = 0) -> Stage:
    """Set up one flight of the known map, which has no camera."""
    mission = load(KNOWN_MAP, builtin())
    return stage(mission, builtin(), world_of(mission, KNOWN_MAP.parent), seed)


def flown(eyes: Eyes, observers: Sequence[Observer] = (), seed: int = 0) -> Rehearsal:
    """Fly once."""
    return rehearse(ready(eyes, seed), observers)


@cache
def warm_up() -> None:
    """Fly every kind once, so that kernels are compiled and libraries loaded."""
    for eyes in ("none", "corners", "rendered"):
        flown(eyes)


def _by_gps_alone(mission: Mission) -> Mission:
    """Return idle -> gps -> return -> land: `gps` leaves as `return` does, when done."""
    gps, home = mission.states["gps"], mission.states["return"]
    done = home.transitions[0].model_copy(update={"to": ("return",)})
    states = {**mission.states, "gps": gps.model_copy(update={"transitions": (done,)})}
    return mission.model_copy(update={"states": states, "success": ()})
