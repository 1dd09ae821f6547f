"""One flight at the edge of the envelope, in plain values."""

from __future__ import annotations

import json
import math
from typing import NamedTuple

import numpy as np

from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import builtin
from missionkit.messages import Observation, Record
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import stage, world_of
from missionkit.sim.fault_injection import parse_fault
from missionkit.sim.world import Wind
from studies.flight import MISSION

LIMIT = 180.0  # s of mission time, after which it is ordered to land
CRASHED = 17  # column of a track


class Trouble(NamedTuple):
    """Speed, wind and faults of one flight."""

    seed: int
    cruise: float  # m/s
    wind: tuple[float, float] | None = None  # m/s, towards north and east; None: the world's own
    gust: float = 0.0  # m/s, standard deviation
    faults: tuple[str, ...] = ()

    def described(self) -> str:
        """Return it in words."""
        wind = "" if self.wind is None else f", wind [{self.wind[0]:g}, {self.wind[1]:g}, 0]"
        gust = "" if self.wind is None else f" gust {self.gust:g}"
        faults = "".join(f", {fault}" for fault in self.faults)
        return f"seed {self.seed}, cruise {self.cruise:g}{wind}{gust}{faults}"


class Run(NamedTuple):
    """Result of one flight, by ground truth."""

    order: Trouble
    succeeded: bool
    landed: bool
    crashed: bool
    powered: bool  # the battery was not empty
    clearance: float  # m, the least
    armed: float  # s
    error: float | None  # m, on entry to the task
    where: str  # of a crash: state, time and place

    def written(self) -> str:
        """Return a line of JSON."""
        return json.dumps(self)

    @classmethod
    def read(cls, line: str) -> Run:
        """Return the result that a line of JSON holds."""
        (seed, cruise, wind, gust, faults), *rest = json.loads(line)
        wind = None if wind is None else tuple(wind)
        return cls(Trouble(seed, cruise, wind, gust, tuple(faults)), *rest)


def fly(order: Trouble) -> Run:
    """Fly once, with the corners of the markers instead of images."""
    catalogue = builtin()
    mission = load(MISSION, catalogue, {"cruise": str(order.cruise)})
    camera = mission.camera.model_copy(update={"use": "corners"})
    settings = mission.settings.model_copy(update={"time_limit": LIMIT})
    mission = mission.model_copy(update={"camera": camera, "settings": settings})
    world = world_of(mission, MISSION.parent)
    if order.wind is not None:
        wind = Wind(mean=(*order.wind, 0.0), gust=order.gust)
        world = world.model_copy(update={"wind": wind})
    ready = stage(mission, catalogue, world, order.seed, [parse_fault(f) for f in order.faults])
    states: list[tuple[float, str]] = []

    def watch(record: Record, _: Observation) -> None:
        states.append((record.now, record.state))

    result = rehearse(ready, (watch,))
    grade, rows = result.grade, ready.vehicle.track.rows
    where = ""
    if grade.crashed:
        row = rows[int(np.argmax(rows[:, CRASHED] > 0.0))]
        state = next((name for at, name in reversed(states) if at <= row[0]), states[0][1])
        place = ", ".join(f"{value:.1f}" for value in row[1:4])
        where = f"in {state} at {row[0]:.1f} s, [{place}]"
    return Run(
        order,
        result.succeeded,
        grade.landed,
        grade.crashed,
        ready.vehicle.truth.charge > 0.0,
        grade.clearance if math.isfinite(grade.clearance) else 1e3,
        grade.duration,
        None if grade.visit is None else grade.visit.position_error,
        where,
    )
