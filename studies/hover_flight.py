"""One hover of five minutes, and where each navigator thought it was."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from missionkit.engine.feature_search import with_features
from missionkit.estimation.builder import build
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.estimation.navigator import Navigator
from missionkit.estimation.optical_flow import dead_reckoning
from missionkit.estimation.optical_flow.dead_reckoning import Reckoning
from missionkit.estimation.optical_flow.flow_parameters import FlowKalman
from missionkit.estimation.ud_vision.parameters import UdVisionEkf
from missionkit.geometry import IDENTITY, Mat, Transform, Vec3, vec
from missionkit.messages import Action, Command, Observation
from missionkit.perception.camera_section import Camera, Mount
from missionkit.perception.vision_pipeline import VisionPipeline
from missionkit.sim.simulated_vehicle import SimulatedVehicle
from missionkit.sim.world import Ground, World
from studies.parallel import in_parallel

PERIOD = 0.05  # s
HEIGHT = 2.0  # m
REST, SETTLED = 6.0, 14.0  # s: when it arms, when the hover begins
EVERY = 100  # ticks between two samples
ESTIMATING = FlowKalman()
PRINTED = FlowKalman(bias_gain=0.0)
EKF = VisualInertialEkf(flow=True, align_for=ESTIMATING.align_for, origin_sd=0.1)
SEEING = UdVisionEkf(align_for=ESTIMATING.align_for)
CAMERA = Camera(
    use="rendered", width=320, height=240, focal=200, mount=Mount(position=(0, 0, 0), tilt_deg=90)
)
FLOOR = Ground(texture="concrete")
P2, BIASED, WHOLE, COMPENSATED, ALONE = range(5)
METHODS = (
    "P2's filter",
    "the same, gyroscope's bias estimated",
    "`visual_inertial_ekf` with flow",
    "compensated flow, not fused",
    "flow alone",
)
"""In the order of the arrays below."""


class Hover(NamedTuple):
    """Result of one flight; errors are estimate less truth, 0 at the hover's beginning."""

    seed: int
    errors: Mat  # (methods, samples, 2), m, north and east
    wander: Mat  # (methods, 2), m, standard deviation of the estimate over the flight
    velocity: Mat  # (methods, 2), m/s, root mean square
    claimed: Vec3  # (methods,), m, `position_sd` at the end, NaN where nothing is claimed


class _Reckoned(NamedTuple):
    """The two that only sum up velocities."""

    summed: Vec3  # (2,), m, compensated flow
    at: float  # s, of its last good sample
    velocity: Vec3  # (2,), m/s
    alone: Reckoning


def hover(order: tuple[int, float]) -> Hover:
    """Fly one hover of a seed and a length (s)."""
    seed, length = order
    vehicle = SimulatedVehicle(World(world="hall"), Camera(use="none"), seed)
    navigators = _navigators()
    memories = [it.begin() for it in navigators]
    reckoned: _Reckoned | None = None
    places, speeds = [], []
    for tick in range(1, round((SETTLED + length) / PERIOD) + 1):
        seen = _observed(vehicle, tick)
        memories = [it.propagate(m, seen) for it, m in zip(navigators, memories, strict=True)]
        truth = vehicle.truth
        if reckoned is None and seen.now > SETTLED - 0.5 * PERIOD:
            place = truth.position[:2]
            reckoned = _Reckoned(place, seen.now, np.zeros(2), dead_reckoning.begin(place, 0.0))
        elif reckoned is not None:
            reckoned = _summed(reckoned, memories[BIASED].measured, seen)
        if reckoned is not None:
            states = [it.read(m) for it, m in zip(navigators, memories, strict=True)]
            sums = (reckoned.summed, reckoned.alone.position)
            places.append([*(s.position[:2] for s in states), *sums, truth.position[:2]])
            rates = (reckoned.velocity, reckoned.alone.velocity)
            speeds.append([*(s.velocity[:2] for s in states), *rates, truth.velocity[:2]])
    ends = [it.read(m).health.position_sd for it, m in zip(navigators, memories, strict=True)]
    return _judged(seed, np.array(places), np.array(speeds), ends)


def hover_by_sight(order: tuple[int, float]) -> Hover:
    """Fly one hover of a seed and a length (s) over a floor that a camera sees.

    The flight is that of `hover` with the seed; the result has one method.
    """
    seed, length = order
    vehicle, lens = (
        SimulatedVehicle(World(world="hall", ground=FLOOR), CAMERA, seed),
        CAMERA.model(),
    )
    navigator, eye = build(SEEING, {}, lens.mount, lens), VisionPipeline(lens, ())
    known, places, speeds = navigator.begin(), [], []
    for tick in range(1, round((SETTLED + length) / PERIOD) + 1):
        seen = _observed(vehicle, tick)
        known = with_features(navigator, navigator.propagate(known, seen), seen.frame, eye, lens)
        if seen.now > SETTLED - 0.5 * PERIOD:
            state, truth = navigator.read(known), vehicle.truth
            places.append([state.position[:2], truth.position[:2]])
            speeds.append([state.velocity[:2], truth.velocity[:2]])
    claimed = navigator.read(known).health.position_sd
    return _judged(seed, np.array(places), np.array(speeds), [claimed])


def _navigators() -> list[Navigator]:
    still = Transform(IDENTITY, vec(0.0, 0.0, 0.0))
    return [build(settings, {}, still) for settings in (PRINTED, ESTIMATING, EKF)]


def _observed(vehicle: SimulatedVehicle, tick: int) -> Observation:
    """Fly one tick; return what was seen, satellites left out."""
    if tick == round(REST / PERIOD):
        vehicle.apply(Command(action=Action.ARM))
    if tick == round(REST / PERIOD) + 2:
        vehicle.apply(Command(action=Action.TAKE_OFF, height=HEIGHT))
    return replace(vehicle.advance(tick * PERIOD), gnss=None)


def _summed(known: _Reckoned, measured: Vec3 | None, seen: Observation) -> _Reckoned:
    alone = dead_reckoning.reckoned(known.alone, seen)
    if measured is None:
        return known._replace(alone=alone)
    place = known.summed + (seen.now - known.at) * measured
    return _Reckoned(place, seen.now, measured, alone)


def _judged(seed: int, places: Mat, speeds: Mat, ends: list[float]) -> Hover:
    """Compare with the truth, which is the last of (ticks, methods + 1, 2)."""
    errors = places[:, :-1] - places[:, -1:]
    errors -= errors[0]
    missed = np.square(speeds[1:, :-1] - speeds[1:, -1:]).mean(axis=0)
    return Hover(
        seed,
        errors[::EVERY].transpose(1, 0, 2).copy(),
        places[:, :-1].std(axis=0),
        np.sqrt(missed),
        np.array([*ends, *[np.nan] * (places.shape[1] - 1 - len(ends))]),
    )


def hover_all(
    seeds: int, length: float, workers: int, fly: Callable[[tuple[int, float]], Hover] = hover
) -> Iterator[Hover]:
    """Fly every seed on `workers` processes; yield in the order of seeds."""
    orders = [(seed, length) for seed in range(seeds)]
    return in_parallel(fly, orders, workers)
