"""Flying a behaviour with a body that answers late, without an engine around it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np
from playing import TICK
from samples import calm

from missionkit.geometry import from_euler, wrap
from missionkit.messages import Estimate, Step, Target
from missionkit.plugin import Behavior

Targets = Callable[[float], Mapping[str, Target]]


class Flown(NamedTuple):
    """One tick: what was seen, and what was answered."""

    seen: Estimate
    step: Step


def fly(
    behavior: Behavior,
    start: tuple[float, float, float],
    seconds: float,
    targets: Targets = lambda _: {},
    *,
    absent: tuple[float, float] = (1e9, 1e9),
    memory: Any = None,
) -> list[Flown]:
    """Return each tick until the behaviour is done.

    Args:
        behavior: begins at the first tick.
        start: m, NED.
        seconds: at most.
        targets: by time (s).
        absent: s, from when to when something else flies the vehicle, to the east.
        memory: what it begins with, instead of what it says.
    """
    p, v, yaw = np.array(start), np.zeros(3), 0.0
    flown: list[Flown] = []
    for n in range(round(seconds / TICK)):
        now = n * TICK
        attitude = from_euler(0.0, 0.0, yaw)
        seen = calm(now=now, position=p, velocity=v, attitude=attitude, targets=targets(now))
        if absent[0] <= now < absent[1]:
            v = np.array((0.0, 2.0, 0.0))
            p = p + TICK * v
            continue
        memory = behavior.begin(seen) if memory is None else memory
        step = behavior.step(seen, memory)
        flown.append(Flown(seen, step))
        memory = step.memory
        if step.done:
            break
        wanted = np.zeros(3)
        if step.guidance is not None:
            it = step.guidance
            wanted = 0.9 * (it.position - p) + (0.0 if it.velocity is None else it.velocity)
            wanted = wanted * min(1.0, it.speed / max(1e-9, float(np.linalg.norm(wanted))))
            if it.yaw is not None:
                yaw += TICK * max(-1.0, min(1.0, 1.5 * wrap(it.yaw - yaw)))
        v = v + (wanted - v) * TICK / 0.3
        p = p + TICK * v
    return flown


def places(flown: list[Flown]) -> np.ndarray:
    """Return where it was at each tick, (N, 3)."""
    return np.array([it.seen.position for it in flown])
