"""One docking of a study, by one of four rules, judged by ground truth."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from missionkit.chart.load import load
from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import builtin
from missionkit.docking_geometry import pose_error
from missionkit.messages import Observation, Record
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import Stage, stage, world_of
from missionkit.sim.fault_injection import parse_fault
from missionkit.sim.free_flyer.world import FreeFlyerWorld
from studies.parallel import in_parallel

MISSION = Path(__file__).parents[1] / "missions" / "docking.yaml"
RULES = ("fixed", "markov_printed", "markov_safe", "ours")
LOST = math.nan  # of what a flight that did not dock has no figure for
EVERY = 40  # rows of the track between two points of a drawn path: 2 s


class Variant(NamedTuple):
    """How a group of flights differs from the mission file."""

    says: str
    settings: Mapping[str, str] = {}
    faults: tuple[str, ...] = ()
    solid: bool = True
    anywhere: bool = False  # starts at a random pose


PAPER = {"accel_noise": "0.0071", "effort": "0.006"}
"""Filter noise and weight of the effort with which the fixed distances cost what P3 reports."""

VARIANTS: Mapping[str, Variant] = {
    "paper": Variant("P3's filter noise and impulse", PAPER),
    "solid": Variant("the same, and the target can be hit", PAPER),
    "at its r1": Variant("fixed, no keep-out", {**PAPER, "r_1": "0.12", "keep_out": "0"}),
    "as shipped": Variant("the mission file's own numbers"),
    "gains": Variant("force five times as dear", {**PAPER, "effort": "0.03"}),
    "speed": Variant("twice the speed", {**PAPER, "speed": "0.0278"}),
    "slew": Variant("half the turn rate", {**PAPER, "slew": "2"}),
    "outliers": Variant("10 % outliers among the ranges", PAPER, ("uwb_outliers=0.1",)),
    "far side": Variant(
        "docks to the face that looks away",
        {**PAPER, "face": "bottom", "world": "worlds/docking_far.yaml"},
    ),
    "anywhere": Variant("starts at any pose inside the anchors", PAPER, anywhere=True),
    "stop 3 mm": Variant("docked when the estimate is 3 mm off", {**PAPER, "stop": "0.003"}),
    "stop 10 mm": Variant("docked when the estimate is 10 mm off", {**PAPER, "stop": "0.01"}),
}
THROUGH = ("paper", "at its r1")
"""Flown through a target that is not solid: without keep-out every flight would end at it."""


class Order(NamedTuple):
    """One flight to be flown."""

    rule: str
    variant: str
    seed: int


class Docking(NamedTuple):
    """Result of one flight, as the chart says that it is docked; NaN if it never does."""

    order: Order
    docked: bool  # and held by the docking mechanism at the end, unhurt
    crashed: bool
    succeeded: bool
    time: float  # s, from the start
    impulse: float  # N·s
    position_error: float  # m
    attitude_error: float  # rad
    turned: float  # m, true distance where it began to turn: r2
    aligned: float  # m, where it began to fly round to the docking axis: r1
    centres: float  # m, least distance of the centres outside the corridor
    separation: float  # m, least gap of the bounding spheres there
    sideways: float  # m, greatest distance from the docking axis inside, where the spheres overlap
    states: tuple[str, ...]
    path: tuple[tuple[float, float, float], ...]  # m

    def as_json(self) -> str:
        """Return it in one line."""
        return json.dumps(self._asdict())

    @classmethod
    def of_json(cls, line: str) -> Docking:
        """Return what `as_json` wrote."""
        data: dict[str, Any] = json.loads(line)
        data["order"], data["states"] = Order(*data["order"]), tuple(data["states"])
        data["path"] = tuple(map(tuple, data["path"]))
        return cls(**data)


@cache
def mission_of(rule: str, variant: str, start: tuple[str, ...] = ()) -> Mission:
    """Return the mission of a rule and variant; `start` is what differs from seed to seed."""
    changed = dict(item.split("=", 1) for item in start)
    settings = {"rule": rule, **VARIANTS[variant].settings, **changed}
    return load(MISSION, builtin(), settings)


def pose_of(seed: int) -> tuple[list[float], list[float]]:
    """Return a start: place (m) over the anchors' rectangle, before the target, and any attitude.

    The four anchors lie in one plane, y = -0.4 z, so that "inside" leaves y open: 0.6 to 1.2 m.
    """
    rng = np.random.default_rng((13, seed))
    low, high = (-1.0, 0.6, -0.5), (1.0, 1.2, 0.5)
    return rng.uniform(low, high).round(3).tolist(), rng.uniform(-180, 180, 3).round(1).tolist()


def staged(order: Order) -> Stage:
    """Set up one flight."""
    variant = VARIANTS[order.variant]
    place, angles = pose_of(order.seed)
    start = (f"start={place}", f"start_attitude_deg={angles}") if variant.anywhere else ()
    mission = mission_of(order.rule, order.variant, start)
    world = world_of(mission, MISSION.parent)
    assert isinstance(world, FreeFlyerWorld)  # noqa: S101 - the mission is that of a free flyer
    if variant.anywhere:
        pose = {"position": tuple(place), "attitude_deg": tuple(angles)}
        world = world.model_copy(update={"start": world.start.model_copy(update=pose)})
    if order.variant in THROUGH:
        ghost = world.target.model_copy(update={"solid": False})
        world = world.model_copy(update={"target": ghost})
    faults = [parse_fault(text) for text in variant.faults]
    return stage(mission, builtin(), world, order.seed, faults)


class _Witness:
    """Notes where the chart changes state, and the truth as it says that it is docked."""

    def __init__(self, ready: Stage) -> None:
        self._ready = ready
        self._target = np.array(ready.world.target.position)
        self.entered: dict[str, float] = {}  # m, true distance from the target at first entry
        self.states: list[str] = []
        self.docked: tuple[float, float, float, float] = (LOST, LOST, LOST, LOST)

    def __call__(self, record: Record, _: Observation) -> None:
        if self.states and self.states[-1] == record.state:
            return
        self.states.append(record.state)
        truth = self._ready.vehicle.truth
        far = float(np.linalg.norm(truth.position - self._target))
        self.entered.setdefault(record.state.removeprefix("printed-"), far)
        if record.state == "docked" and math.isnan(self.docked[0]):
            error = pose_error(self._ready.world.berth, truth.position, truth.attitude)
            self.docked = (record.now, self._ready.vehicle.impulse, *error)


def flown(order: Order) -> Docking:
    """Fly once."""
    ready = staged(order)
    watch = _Witness(ready)
    try:
        result = rehearse(ready, (watch,))
    except Exception as error:
        error.add_note(f"in {order}")
        raise
    grade = result.grade.docking
    assert grade is not None  # noqa: S101 - of a free flyer
    path = ready.vehicle.track.rows[::EVERY, 1:4].round(4).tolist()
    return Docking(
        order,
        grade.docked and not math.isnan(watch.docked[0]),
        grade.crashed,
        result.succeeded,
        *watch.docked,
        watch.entered.get("reorient", LOST),
        watch.entered.get("align", LOST),
        grade.centre_distance,
        grade.separation,
        grade.sideways,
        tuple(watch.states),
        tuple(map(tuple, path)) if order.variant == "paper" else (),
    )


def fly_all(orders: Sequence[Order], workers: int) -> Iterator[Docking]:
    """Fly each order, in order, `workers` at a time; with one worker in this process."""
    return in_parallel(flown, orders, workers, chunk=4)
