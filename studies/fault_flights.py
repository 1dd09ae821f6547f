"""One rehearsed flight with one fault, judged by the simulator's ground truth."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from enum import StrEnum
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import numpy as np
import yaml
from typing_extensions import override

from missionkit.chart.load import parse
from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import Catalogue, builtin
from missionkit.geometry import Mat
from missionkit.messages import MARKER_DUPLICATED, Estimate, Observation, Record, Verdict
from missionkit.plugin import Guard
from missionkit.rehearsal.grading import Rehearsal
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import Stage, stage, world_of
from missionkit.sim.fault_injection import parse_fault
from missionkit.sim.world import World

MISSIONS = Path(__file__).parents[1] / "missions"
AT_HOME = 3.0  # m: a fix is good for two
ASTRAY = 1.0  # m from the goal: that was the work at another place
FENCE = (-20.0, 120.0, -40.0, 60.0, 30.0)  # m, that of the precision task: south to height


class Outcome(StrEnum):
    """Outcome of a flight, by ground truth."""

    DONE = "work done, landed where it should"
    HOME = "landed where it should, work not done"
    ELSEWHERE = "landed elsewhere, unhurt"
    ASTRAY = "worked at the wrong place, landed unhurt"
    REPORTED = "worked at the wrong place, landed unhurt, two markers of its id reported"
    LEFT = "left the fence, landed unhurt"
    HIT = "hit something"
    UP = "did not come down"


class Seen(NamedTuple):
    """Outcome of one seed of one fault."""

    seed: int
    outcome: str
    details: str  # states, distances, exit codes
    false_success: bool = False  # the program reported success, the truth says otherwise


class Broken(Guard):
    """Raises once the vehicle is more than `north` metres north of where it took off."""

    kind: ClassVar[str] = "broken"
    north: float

    @override
    def check(self, seen: Estimate) -> Verdict:
        if float(seen.position[0]) > self.north:
            raise RuntimeError("a plug-in that raises")
        return Verdict(holds=False)


class Flight(NamedTuple):
    """A mission, the changes made to it, and its faults."""

    faults: Callable[[np.random.Generator], tuple[str, ...]] = lambda _: ()
    mission: str = "precision_task"
    change: Callable[[dict[str, Any]], None] = lambda _: None  # of the mission, as a mapping
    world: Callable[[World, np.random.Generator], World] = lambda world, _: world
    lands_at: tuple[float, float] = (0.0, 0.0)  # m, north and east
    fence: tuple[float, ...] = FENCE  # m, what the truth may not leave


def during(state: str, fault: str, first: float, last: float) -> Callable[..., tuple[str, ...]]:
    """Return a fault that begins between `first` and `last` (s) after a state is entered."""

    def drawn(chance: np.random.Generator) -> tuple[str, ...]:
        name, _, length = fault.partition("+")
        after = f"@{state}:{chance.uniform(first, last):.2f}"
        return (f"{name}{after}+{length}" if length else f"{name}{after}",)

    return drawn


def staged(flight: Flight, seed: int) -> Stage:
    """Set up one seed; what varies besides noise comes from the seed too."""
    chance = np.random.default_rng([seed, 27])
    catalogue = builtin().extended("guards", (Broken,))
    mission, world = _loaded(flight, catalogue)
    faults = [parse_fault(text) for text in flight.faults(chance)]
    return stage(mission, catalogue, flight.world(world, chance), seed, faults)


def _loaded(flight: Flight, catalogue: Catalogue) -> tuple[Mission, World]:
    path = MISSIONS / f"{flight.mission}.yaml"
    keys = yaml.safe_load(path.read_text(encoding="utf-8"))
    if keys["camera"]["use"] == "rendered":
        keys["camera"]["use"] = "corners"
    flight.change(keys)
    mission = parse(yaml.safe_dump(keys, sort_keys=False), str(path), catalogue)
    return mission, world_of(mission, MISSIONS)


class _Path:
    """Keeps the states in the order they were entered, and whether duplicates were reported."""

    def __init__(self) -> None:
        self.states: list[str] = []
        self.duplicated = False

    def __call__(self, record: Record, _: Observation) -> None:
        """Take in one tick."""
        self.duplicated |= MARKER_DUPLICATED in record.estimate.events
        if not self.states or record.state != self.states[-1]:
            self.states.append(record.state)


def flown(flight: Flight, seed: int) -> Seen:
    """Fly one seed."""
    ready, path = staged(flight, seed), _Path()
    return _judged(flight, seed, rehearse(ready, [path]), ready.vehicle.track.rows, path)


def _judged(flight: Flight, seed: int, run: Rehearsal, rows: Mat, path: _Path) -> Seen:
    """Judge by the track, (N, TRACK_WIDTH), of the truth.

    The work is done when the grade says so: the state that counts was entered at the right place.
    """
    away = math.dist(rows[-1, 1:3], flight.lands_at)
    if run.grade.crashed:
        outcome = Outcome.HIT
    elif not run.grade.landed:
        outcome = Outcome.UP
    elif run.grade.visit is not None and run.grade.visit.position_error > ASTRAY:
        outcome = Outcome.REPORTED if path.duplicated else Outcome.ASTRAY
    elif outside(rows, flight.fence) > 0.0:
        outcome = Outcome.LEFT
    elif away > AT_HOME:
        outcome = Outcome.ELSEWHERE
    else:
        outcome = Outcome.DONE if run.succeeded else Outcome.HOME
    details = (
        f"{' '.join(path.states)}; down {away:.1f} m from where it should, clearance "
        f"{run.grade.clearance:.2f} m, outside the fence by {outside(rows, flight.fence):.1f} m"
    )
    return Seen(seed, outcome, details, run.succeeded and outcome is not Outcome.DONE)


def outside(rows: Mat, fence: tuple[float, ...]) -> float:
    """Return how far (m) a track got outside the fence, 0 if it stayed inside."""
    south, north, west, east, height = fence
    n, e, d = rows[:, 1], rows[:, 2], rows[:, 3]
    gaps = np.stack([south - n, n - north, west - e, e - east, -d - height])
    return max(0.0, float(gaps.max()))


def with_guard(state: str, to: str, guard: Mapping[str, object]) -> Callable[..., None]:
    """Return a change that puts a transition first in a state of the mission."""

    def change(keys: dict[str, Any]) -> None:
        keys["states"][state]["transitions"].insert(0, {"to": to, "when": dict(guard)})

    return change
