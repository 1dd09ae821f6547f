"""What keeps the vehicle from flying the velocity it was sent, estimated and taken off.

An autopilot answers a velocity setpoint u about like

    v' = k (w - v) + d,   w' = (u - w)/T,

with the gain k of its velocity loop, the lag T of attitude and rotors, and d all else: wind, the
error of its own velocity, the integral of its loop that is still charged after it braked. A
Luenberger observer integrates the model and corrects v and d, both errors falling with the pole -p,

    v_o' = k (w - v_o) + d_o + l_1 (v - v_o),   d_o' = l_2 (v - v_o),

and -d_o/k is added to what is sent. An integral of the position's error would learn the same only
after the vehicle had been off its goal for a while.

Source: Ohnishi, "A new servo method in mechatronics", 1987; Li, Yang, Chen and Chen, "Disturbance
Observer-Based Control", 2014, chapter 2.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

from pydantic import BaseModel, ConfigDict, Field

from missionkit.control.velocity_limits import ZERO, Triple
from missionkit.units import MetresPerSecond, Number, Seconds

PositiveNumber = Annotated[Number, Field(gt=0)]


class DisturbanceObserver(BaseModel):
    """How the autopilot answers a velocity, level and vertical, and how fast to learn the rest."""

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", allow_inf_nan=False)

    gain: tuple[PositiveNumber, PositiveNumber] = Field(
        default=(2.2, 4.0), description="1/s, k, of the autopilot's velocity loop"
    )
    lag: Seconds = Field(default=0.18, gt=0, description="T, of attitude and rotors")
    pole: Annotated[Number, Field(gt=0, le=20)] = Field(default=4.8, description="1/s, p")
    limit: MetresPerSecond = Field(default=1.0, ge=0, description="of what is added, each axis")


class Observed(NamedTuple):
    """Memory of the observer."""

    velocity: Triple | None = None  # m/s, NED, v_o; None: it has not begun
    answered: Triple = ZERO  # m/s, NED, w
    disturbance: Triple = ZERO  # m/s², NED, d_o
    sent: Triple = ZERO  # m/s, NED, u, since the last step


class _Axis(NamedTuple):
    v: float
    w: float
    d: float


def observed(model: DisturbanceObserver, memory: Observed, velocity: Triple, dt: float) -> Observed:
    """Return the memory after a step.

    Args:
        model: of the autopilot.
        memory: of the last step, with what was sent then.
        velocity: (3,), m/s, NED, as it is estimated now; ignored where it is not finite.
        dt: s since the last step.
    """
    if not all(map(math.isfinite, velocity)) or dt <= 0.0:
        return memory
    if memory.velocity is None:
        return memory._replace(velocity=velocity, answered=velocity)
    last = zip(memory.velocity, memory.answered, memory.disturbance, strict=True)
    north, east, down = (
        _stepped(model, which, _Axis(*axis), sent, measured, dt)
        for which, axis, sent, measured in zip((0, 0, 1), last, memory.sent, velocity, strict=True)
    )
    v, w, d = zip(north, east, down, strict=True)
    return Observed(v, w, d, memory.sent)


def _stepped(
    model: DisturbanceObserver, which: int, axis: _Axis, sent: float, measured: float, dt: float
) -> _Axis:
    """Return one axis after a step: the model, then what the measured velocity (m/s) corrects."""
    k, top = model.gain[which], model.gain[which] * model.limit
    w = axis.w + (1.0 - math.exp(-dt / model.lag)) * (sent - axis.w)
    keep, z = math.exp(-k * dt), math.exp(-model.pole * dt)
    v = keep * axis.v + (1.0 - keep) * (w + axis.d / k)
    missed = measured - v
    # gains that put both poles of the sampled error at z: trace 2 z, determinant z²
    v += max(0.0, 1.0 - z * z / keep) * missed
    d = _bounded(axis.d + (1.0 - z) ** 2 / dt * missed, top)
    return _Axis(v, w, d)


def _bounded(x: float, top: float) -> float:
    return min(top, max(-top, x))


def correction(model: DisturbanceObserver, memory: Observed) -> Triple:
    """Return the velocity (3,), m/s, NED, to be added to what is sent: -d_o/k."""
    north, east, down = memory.disturbance
    return -north / model.gain[0], -east / model.gain[0], -down / model.gain[1]
