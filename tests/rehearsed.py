"""Flights in the simulator for tests: each is flown once, with camera corners instead of images."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from missionkit.chart.load import load, parse
from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import Catalogue, builtin
from missionkit.engine.flight_loop import Operator
from missionkit.messages import Observation, Record
from missionkit.rehearsal.grading import Rehearsal
from missionkit.rehearsal.rehearse import Kept, rehearse
from missionkit.rehearsal.stage import Stage, stage, world_of
from missionkit.sim.fault_injection import parse_fault
from missionkit.sim.world import Wind, World

MISSIONS = Path(__file__).parents[1] / "missions"


class Flight(NamedTuple):
    """Result of a flight, with the estimate and the decision of every tick."""

    ready: Stage
    result: Rehearsal
    records: list[Record]
    observations: list[Observation]

    def went(self) -> list[tuple[str, str]]:
        """Every transition: to, and why."""
        return [(fired.to, fired.reason) for r in self.records for fired in r.fired]

    def entered(self, state: str, nth: int = 0) -> float:
        """When a state was entered for the nth time (s)."""
        return [r.now for r in self.records for fired in r.fired if fired.to == state][nth]

    def problems(self) -> list[str]:
        return [problem for record in self.records for problem in record.problems]


def flown(ready: Stage, operator: Operator | None = None) -> Flight:
    """Fly, and keep everything."""
    records: list[Record] = []
    observations: list[Observation] = []

    def watch(record: Record, observation: Observation) -> None:
        records.append(record)
        observations.append(observation)

    return Flight(ready, rehearse(ready, (watch,), operator=operator), records, observations)


class KilledError(BaseException):
    """The process died: a recorder that only fails never ends a flight."""


def killed(ready: Stage, when: Callable[[Kept], bool]) -> tuple[Kept, np.ndarray]:
    """Fly until `when` holds of what is saved; return that, and the truth up to there."""
    kept: list[Kept] = []

    def save(each: Kept) -> None:
        kept.append(each)
        if when(each):
            raise KilledError

    with pytest.raises(KilledError):
        rehearse(ready, save=save)
    rows = ready.vehicle.track.rows
    return kept[-1], rows[rows[:, 0] <= kept[-1].course.memory.now + 1e-9]


@cache
def precise(*faults: str, seed: int = 1) -> Flight:
    """The precision task in its orchard. The flight is shared: do not change it."""
    return flown(precise_stage(*faults, seed=seed))


def precise_stage(
    *faults: str,
    seed: int = 1,
    cruise: float = 5.0,
    wind: Wind | None = None,
    limit: float = 1800.0,
    upright: bool = True,
) -> Stage:
    catalogue = builtin()
    mission = load(MISSIONS / "precision_task.yaml", catalogue, {"cruise": str(cruise)})
    if not upright:  # nothing is said about how the marker hangs
        (use,) = mission.perception
        loose = use.plugin.model_copy(update={"upright": False})
        perception = (replace(use, plugin=loose),)
        mission = mission.model_copy(update={"perception": perception})
    eye = mission.camera.model_copy(update={"use": "corners"})
    settings = mission.settings.model_copy(update={"time_limit": limit})
    mission = mission.model_copy(update={"camera": eye, "settings": settings})
    world = world_of(mission, MISSIONS)
    if wind is not None:
        world = world.model_copy(update={"wind": wind})
    return stage(mission, catalogue, world, seed, tuple(map(parse_fault, faults)))


HEAD = """\
missionkit: 1
mission: short
camera: {use: none}
"""


def short(text: str, catalogue: Catalogue | None = None) -> Mission:
    """A small mission without a camera."""
    return parse(HEAD + text, "short.yaml", catalogue or builtin())


def short_stage(
    text: str, *faults: str, catalogue: Catalogue | None = None, seed: int = 1
) -> Stage:
    """A small mission over an empty, windless field."""
    catalogue = catalogue or builtin()
    mission = short(text, catalogue)
    return stage(mission, catalogue, World(world="field"), seed, tuple(map(parse_fault, faults)))


def plain(value: Any) -> Any:
    """Return a value that compares bit by bit: arrays as bytes, records as tuples."""
    if isinstance(value, np.ndarray):
        return (value.shape, value.dtype.str, value.tobytes())
    if isinstance(value, float):
        return value.hex()
    if is_dataclass(value) and not isinstance(value, type):
        return tuple(plain(getattr(value, field.name)) for field in fields(value))
    if isinstance(value, Mapping):
        return tuple((key, plain(item)) for key, item in value.items())
    if isinstance(value, (tuple, list)):
        return tuple(map(plain, value))
    return value


def timeless(records: list[Record]) -> list[Any]:
    """Return the records without the wall time that each tick took."""
    return [plain(record[:-1]) for record in records]
