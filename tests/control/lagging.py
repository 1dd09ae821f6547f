"""A vehicle whose velocity follows the command with second order lag behind a latency."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from missionkit.control.controller import Control
from missionkit.geometry import Vec3, from_euler, wrap
from missionkit.messages import Estimate, Guidance, HalfSpace, Health, Mode

DT = 0.05  # s
HEALTH = Health(True, False, 0.0, 0.0, 0.1, 0)


class Track(NamedTuple):
    time: np.ndarray  # (N,), s
    position: np.ndarray  # (N, 3), m
    velocity: np.ndarray  # (N, 3), m/s
    command: np.ndarray  # (N, 3), m/s
    yaw: np.ndarray  # (N,), rad


def seen(
    position: Vec3 | None = None, velocity: Vec3 | None = None, yaw: float = 0.0, now: float = 0.0
) -> Estimate:
    return Estimate(
        now,
        np.zeros(3) if position is None else position,
        np.zeros(3) if velocity is None else velocity,
        from_euler(0.0, 0.0, yaw),
        np.zeros(3),
        HEALTH,
    )


def fly(
    control: Control,
    guide: Callable[[float], Guidance | None],
    until: float,
    mode: Callable[[float], Mode] = lambda t: Mode.GPS,
    disturbance: Callable[[float], Vec3] = lambda t: np.zeros(3),
    push: Callable[[float], Vec3 | None] = lambda t: None,
    bound: HalfSpace | None = None,
) -> Track:
    """Two lags of 0.25 s and 0.1 s behind 0.1 s of latency; acceleration at most 3 m/s²."""
    p, v, a, yaw = np.zeros(3), np.zeros(3), np.zeros(3), 0.0
    memory, pipe, rows = control.begin(), [np.zeros(3)] * 2, []
    for k in range(round(until / DT)):
        t = k * DT
        now = seen(p, v, yaw, t)
        setpoint, memory = control.step(
            memory, mode(t), guide(t), now, DT, push=push(t), bound=bound
        )
        rows.append((t, *p, *v, *setpoint.velocity, yaw))
        pipe.append(setpoint.velocity)
        command = pipe.pop(0) + disturbance(t)
        for _ in range(5):
            a += (np.clip((command - v) / 0.25, -3.0, 3.0) - a) * 0.1
            v = v + 0.01 * a
            p = p + 0.01 * v
        yaw = wrap(yaw + setpoint.yaw_rate * DT)
    table = np.array(rows)
    return Track(table[:, 0], table[:, 1:4], table[:, 4:7], table[:, 7:10], table[:, 10])
