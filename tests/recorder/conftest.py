from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
import pytest

from missionkit.geometry import Quat, Transform, Vec3, from_euler, multiply, vec
from missionkit.messages import (
    Battery,
    CameraModel,
    Command,
    Cycle,
    Estimate,
    Fired,
    Goal,
    Health,
    Mode,
    Record,
    Setpoint,
    Target,
    VehicleStatus,
    Verdict,
)
from missionkit.recorder.scenery import DrawnBox, DrawnMarker, Round, Scenery

PLAN = (  # state, until (s), mode, why it ended
    ("idle", 4.0, Mode.NONE, "when done"),
    ("gps", 22.0, Mode.GPS, "when all of marker-sure, trunk-in-range, near-goal"),
    ("visual", 26.0, Mode.VISUAL, "when target_lost for 2.0 s"),
    ("search", 30.0, Mode.GPS, "when marker-sure"),
    ("visual", 36.0, Mode.VISUAL, "when converged for 1.0 s"),
    ("task", 40.0, Mode.VISUAL, "when done"),
    ("return", 56.0, Mode.GPS, "when done"),
    ("land", 60.0, Mode.NONE, ""),
)
CORNERS = np.array(
    [
        (0.0, 0.0, 0.0, 0.0),
        (4.0, 0.0, 0.0, -6.0),
        (22.0, 78.0, 11.0, -6.0),
        (26.0, 82.0, 12.0, -2.6),
        (30.0, 79.0, 14.5, -3.0),
        (36.0, 83.0, 12.0, -2.5),
        (40.0, 83.0, 12.0, -2.5),
        (56.0, 1.0, 0.5, -6.0),
        (60.0, 0.2, 0.3, -0.1),
    ]
)
SOUTH = np.array([0.5, -0.5, -0.5, 0.5])  # a marker whose normal points south
SOUTH_BY_WEST = multiply(from_euler(0.0, 0.0, math.radians(3.0)), SOUTH)


class Truth(NamedTuple):
    position: Vec3
    attitude: Quat


def place(t: float) -> Vec3:
    ease = np.interp(t, CORNERS[:, 0], np.arange(len(CORNERS)))
    i = min(int(ease), len(CORNERS) - 2)
    s = 0.5 - 0.5 * math.cos(math.pi * (ease - i))
    here = CORNERS[i, 1:] + s * (CORNERS[i + 1, 1:] - CORNERS[i, 1:])
    return here + vec(0.0, 4.0 * math.sin(math.pi * here[0] / 80.0) * (t < 22.0), 0.0)


def leg(t: float) -> int:
    return next(i for i, (_, until, _, _) in enumerate(PLAN) if t < until + 1e-9)


def answers(t: float, state: str) -> tuple[tuple[str, Verdict], ...]:
    charge = 1.0 - 0.006 * t
    said: list[tuple[str, Verdict]] = [("battery", Verdict.below(charge, 0.2))]
    said.append(("link", Verdict(holds=False, value=0.1, threshold=3.0, margin=-2.9)))
    if state in {"gps", "search"}:
        sure = max(0.0, min(1.0, (t - 17.0) / 5.0)) if t < 23.0 else 0.2 * (t - 26.0)
        unknown = Verdict.unknown("no frame for 0.4 s")
        said.append(("marker-sure", unknown if t < 8.0 else Verdict.at_least(sure, 0.7)))
        said.append(("near-goal", Verdict.below(abs(80.0 - place(t)[0]), 4.0)))
    if state == "visual":
        said.append(("converged", Verdict.below(float(place(36.0)[0] - place(t)[0]), 0.1)))
        said.append(("target_lost", Verdict(holds=24.0 < t < 27.0)))
    return tuple(said)


def tick(t: float, rng: np.random.Generator, *, wall: float = 0.004) -> tuple[Record, Truth]:
    i = leg(t)
    state, _, mode, _ = PLAN[i]
    before = PLAN[leg(t - 0.05)] if t > 0.0 else PLAN[0]
    fired = ()
    if before[0] != state:
        outputs = (f"mode {mode.value}", "log injection finished")[: 1 + (before[0] == "task")]
        fired = (Fired(before[0], state, before[3], answers(t, before[0])[:1], outputs),)
    here = place(t)
    trunk = Target("trunk", vec(84.0, 12.0, -2.5), 0.3, None, None, t if t > 20 else None)
    seen = Estimate(
        now=t,
        position=here + rng.normal(0.0, 0.15, 3),
        velocity=(place(t + 0.05) - here) / 0.05,
        attitude=from_euler(0.0, 0.02, 0.3),
        rates=vec(0.0, 0.0, 0.0),
        health=Health(True, False, t, None, 0.4, 0),
        battery=Battery(t, 1.0 - 0.006 * t, 14.8),
        status=VehicleStatus(t, True, t > 1.0, True, "offboard"),
        home=vec(0.0, 0.0, 0.0),
        targets={"trunk": trunk},
        goal=None if state in {"idle", "land"} else Goal(vec(83.0, 12.0, -2.5), 0.0, t, "trunk"),
    )
    problems = ("search: height above 2 m is not kept",) if 27.0 < t < 28.0 else ()
    command = Command(Setpoint(seen.velocity, 0.1), payload="injector" if state == "task" else None)
    cycle = Cycle(wall, 0.001, 0.0005, int(t > 30))
    record = Record(
        t,
        state,
        (state,),
        mode,
        answers(t, state),
        fired,
        command,
        "on the way",
        problems,
        seen,
        cycle,
    )
    return record, Truth(here, seen.attitude)


@pytest.fixture
def flight() -> Callable[..., Iterator[tuple[Record, Truth]]]:
    """A made-up precision task: ticks of 20 Hz up to `until` s."""

    def ticks(
        until: float = 60.0, seed: int = 1, wall: float = 0.004
    ) -> Iterator[tuple[Record, Truth]]:
        rng = np.random.default_rng(seed)
        for k in range(round(until * 20.0)):
            yield tick(0.05 * k, rng, wall=wall)

    return ticks


@pytest.fixture
def orchard() -> Scenery:
    return Scenery(
        (
            Round((25.0, 1.5), 0.8, 0.0, 9.0),
            Round((45.0, 8.0), 1.0, 0.0, 9.0),
            DrawnBox((58.0, 8.0), (60.0, 14.0), 0.0, 8.0),
            Round((84.75, 12.3), 0.35, 0.0, 5.0),
        ),
        (
            DrawnMarker(
                "marker 23",
                vec(84.35, 12.3, -2.4),
                multiply(from_euler(0.0, 0.0, math.radians(3.0)), SOUTH),
                0.40,
            ),
            DrawnMarker("marker 62", vec(58.0, 11.0, -2.0), SOUTH, 0.25),
        ),
    )


@pytest.fixture
def camera() -> CameraModel:
    matrix = np.array([[554.0, 0.0, 320.0], [0.0, 554.0, 240.0], [0.0, 0.0, 1.0]])
    mount = Transform(np.array([0.5, 0.5, 0.5, 0.5]), vec(0.1, 0.0, 0.0))
    return CameraModel(640, 480, matrix, np.zeros(5), mount, 0.05)
