"""A simulated flight over textured ground, and a navigator that looks at its images."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from missionkit.engine.feature_search import with_features
from missionkit.estimation.builder import build
from missionkit.estimation.ud_vision.parameters import UdVisionEkf
from missionkit.geometry import vec
from missionkit.messages import Action, Command, Observation, Setpoint
from missionkit.perception.camera_section import Camera, Mount
from missionkit.perception.vision_pipeline import VisionPipeline
from missionkit.sim.ground_truth import TrueState
from missionkit.sim.simulated_vehicle import SimulatedVehicle
from missionkit.sim.world import Ground, World

CAMERA = Camera(
    use="rendered", width=320, height=240, focal=200, mount=Mount(position=(0, 0, 0), tilt_deg=90)
)
LENS = CAMERA.model()
EYE = VisionPipeline(LENS, ())
LEGS = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (-1.0, 0.0, -0.1))


def built(**changes: Any) -> Any:
    settings = UdVisionEkf(align_for=1.0, **changes)
    return build(settings, {"post": (vec(4.0, 1.0, -1.0), 0.2)}, LENS.mount, LENS)


def observed(seconds: float, seed: int = 1) -> Iterator[tuple[Observation, TrueState]]:
    """Rest for 1.5 s, take off to 2 m, from 5 s on fly legs of 3 s; no satellites."""
    vehicle = SimulatedVehicle(World(world="hall", ground=Ground(texture="gravel")), CAMERA, seed)
    for tick in range(1, round(seconds / 0.05) + 1):
        seen = replace(vehicle.advance(tick * 0.05), gnss=None)
        if tick == 30:
            vehicle.apply(Command(action=Action.ARM))
        elif tick == 32:
            vehicle.apply(Command(action=Action.TAKE_OFF, height=2.0))
        elif tick >= 100:
            leg = LEGS[(tick - 100) // 60 % len(LEGS)]
            vehicle.apply(Command(Setpoint(np.array(leg), 0.2)))
        yield seen, vehicle.truth


def step(navigator: Any, known: Any, seen: Observation) -> Any:
    """Return the memory after one observation and what its frame shows."""
    return with_features(navigator, navigator.propagate(known, seen), seen.frame, EYE, LENS)


def through(
    navigator: Any,
    flight: Iterable[tuple[Observation, TrueState]],
    change: Callable[[Observation], Observation] = lambda seen: seen,
) -> tuple[Any, TrueState]:
    """Return the memory after a flight, and the truth then."""
    known, last = navigator.begin(), None
    for seen, truth in flight:
        known, last = step(navigator, known, change(seen)), truth
    assert last is not None
    return known, last
