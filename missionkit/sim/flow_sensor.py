"""Optical flow and range finder, looking down along the body's z at flat ground.

Imported late: it compiles kernels. Each is given the true state (see `kernel_layout`) and draws
from its own stream.
"""

from __future__ import annotations

import math
from statistics import NormalDist

import numpy as np

from missionkit import geometry
from missionkit.geometry import Vec3
from missionkit.jit import compiled
from missionkit.messages import OpticalFlow, Range
from missionkit.sim.kernel_layout import RATE
from missionkit.sim.random_blocks import Normals
from missionkit.sim.sensors import Beat
from missionkit.sim.vehicle_parameters import FlowModel, RangeModel

_conjugate = compiled(geometry.conjugate)
_exp = compiled(geometry.exp)
_log = compiled(geometry.log)
_multiply = compiled(geometry.multiply)
_rotate = compiled(geometry.rotate)

_below = NormalDist().inv_cdf

LEAST_COSINE = 0.2
"""Tilted further, the axis does not meet the ground in any useful place."""


@compiled
def distance(x: Vec3) -> float:
    """Return the way to the ground (m) along the body's z, infinite if it does not lead there."""
    cosine = 1.0 - 2.0 * (x[7] * x[7] + x[8] * x[8])
    return -x[2] / cosine if cosine > LEAST_COSINE else math.inf


@compiled
def passing(before: Vec3, x: Vec3, dt: float, out: Vec3) -> None:
    """Write mean flow (2,) and mean turn rate (3,) between two states into `out` (5,), rad/s.

    With the mean velocity v and rate ω in the axes of mid-interval, and d the mean distance:
    ẋ = -v_x / d - ω_y,  ẏ = -v_y / d + ω_x.

    Args:
        before: (13,) state at the start of the interval.
        x: (13,) state at its end.
        dt: s.
        out: (5,), overwritten.
    """
    turn = _log(_multiply(_conjugate(before[6:10]), x[6:10]))
    middle = _multiply(before[6:10], _exp(0.5 * turn))
    moved = _rotate(_conjugate(middle), x[0:3] - before[0:3])
    d = max(0.5 * (distance(before) + distance(x)), 1e-3)
    out[0] = (-moved[0] / d - turn[1]) / dt
    out[1] = (-moved[1] / d + turn[0]) / dt
    for i in range(3):
        out[2 + i] = turn[i] / dt


@compiled
def look(before: Vec3, x: Vec3, dt: float, noise: Vec3, lens: Vec3, out: Vec3) -> None:
    """Write flow (2,), the gyroscope's rates (3,) and the quality into `out` (6,).

    Where nothing is seen flow and quality are 0.

    Args:
        before: (13,) state at the start of the interval.
        x: (13,) state at its end.
        dt: s.
        noise: (5,), standard normal.
        lens: (10,): scale, noise of flow (2) and gyroscope (rad/s), biases (3, rad/s), least and
            most distance (m), fastest flow (rad/s).
        out: (6,), rad/s and 0 to 1, overwritten.
    """
    passing(before, x, dt, out)
    for i in range(3):
        out[2 + i] += lens[4 + i] + lens[3] * noise[2 + i]
    first, last = distance(before), distance(x)
    seen = lens[7] < min(first, last) and max(first, last) < lens[8]
    for i in range(2):
        out[i] = lens[0] * out[i] + lens[1 + i] * noise[i] if seen else 0.0
    speed = math.sqrt(out[0] * out[0] + out[1] * out[1])
    out[5] = 1.0 - 0.5 * speed / lens[9] if seen else 0.0
    if speed > lens[9]:
        out[0] = out[1] = out[5] = 0.0


class FlowSensor:
    """Image motion with noise, error of scale and holes; its own gyroscope has its own bias."""

    def __init__(self, model: FlowModel, rng: np.random.Generator) -> None:
        self.beat = Beat(model.rate)
        self._noise = Normals(rng, 6, 500)
        first = self._noise.take(1)[0]
        scale, biases = 1.0 + model.scale * first[0], model.gyro_bias * first[3:6]
        reach = (model.least, model.most, model.fastest)
        self._lens = np.array([scale, *model.sd, model.gyro_sd, *biases, *reach])
        self._lost = False
        self._before = np.zeros(13)
        self._since = 0.0
        # A chain of two states, left when a normal number falls below these bounds.
        leave = min(self.beat.every / RATE / model.lost_for, 1.0 - 1e-12)
        enter = min(leave * model.lost / (1.0 - model.lost), 1.0 - 1e-12)
        self._leave, self._enter = _below(leave), _below(enter) if enter > 0.0 else -math.inf

    def start(self, at: float, x: Vec3) -> None:
        """Begin the first interval."""
        self._since, self._before = at, x[:13].copy()

    def measure(self, at: float, x: Vec3) -> OpticalFlow:
        """Return the flow since the last call, up to `at` (s)."""
        noise, over, out = self._noise.take(1)[0], at - self._since, np.empty(6)
        self._lost = bool(noise[5] >= self._leave if self._lost else noise[5] < self._enter)
        look(self._before, x, over, noise, self._lens, out)
        self.start(at, x)
        if self._lost:
            return OpticalFlow(at, np.zeros(2), out[2:5], over, 0.0)
        return OpticalFlow(at, out[:2], out[2:5], over, float(out[5]))


class RangeSensor:
    """Distance with white noise."""

    def __init__(self, model: RangeModel, rng: np.random.Generator) -> None:
        self.beat = Beat(model.rate)
        self._model = model
        self._noise = Normals(rng, 1, 500)

    def measure(self, at: float, x: Vec3) -> Range | None:
        """Return the distance at `at` (s), None out of its reach."""
        noise = float(self._noise.take(1)[0, 0])
        true = distance(x)
        if not self._model.least < true < self._model.most:
            return None
        return Range(at, true + self._model.sd * noise)
