"""Plug-ins from outside the package that do what they should not."""

from __future__ import annotations

import math
import time
from typing import Any, ClassVar

import numpy as np
from typing_extensions import override

from missionkit.chart.plugin_catalogue import Catalogue, builtin
from missionkit.messages import Action, Estimate, Goal, Guidance, Step, Verdict
from missionkit.plugin import Behavior, Guard

AWAY = np.array([100.0, 0.0, -5.0])

ANSWERS: dict[str, object] = {
    "well": Step(Guidance(AWAY, 2.0), goal=Goal(AWAY, None, 0.0), memory="kept"),
    "nothing": None,
    "a number": 7,
    "no guidance": Step(guidance=(1.0, 2.0, 3.0)),
    "a list": Step(Guidance([1.0, 2.0, 3.0], 1.0)),
    "no place": Step(Guidance(None, 1.0)),
    "two axes": Step(Guidance(np.zeros(2), 1.0)),
    "words": Step(Guidance(np.array(["a", "b", "c"]), 1.0)),
    "nan": Step(Guidance(np.array([1.0, math.nan, 0.0]), 1.0)),
    "endless": Step(Guidance(np.array([1.0, math.inf, 0.0]), 1.0)),
    "no speed": Step(Guidance(AWAY, None)),
    "nan speed": Step(Guidance(AWAY, math.nan)),
    "nan velocity": Step(Guidance(AWAY, 1.0, np.full(3, math.nan))),
    "nan yaw": Step(Guidance(AWAY, 1.0, yaw=math.nan)),
    "nan goal": Step(goal=Goal(np.full(3, math.nan), None, 0.0)),
    "no goal": Step(goal="there"),
    "odd action": Step(action="explode"),
    "nan height": Step(action=Action.TAKE_OFF, height=math.nan),
    "odd payload": Step(payload=3),
    "odd note": Step(note=None),
}


class Odd(Behavior):
    """Returns what the test gives it."""

    kind: ClassVar[str] = "odd"
    says: str

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        if self.says == "raise":
            raise RuntimeError("out of ideas")
        return ANSWERS[self.says]


class Stillborn(Behavior):
    """Cannot begin, but would step."""

    kind: ClassVar[str] = "stillborn"

    @override
    def begin(self, seen: Estimate) -> Any:
        raise RuntimeError("not today")

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        return Step(note=f"began with {memory}")


class Sleepy(Guard):
    """Sleeps for ten seconds once the vehicle is above `over` metres."""

    kind: ClassVar[str] = "sleepy"
    over: float = 1.0

    @override
    def check(self, seen: Estimate) -> Verdict:
        if -float(seen.position[2]) > self.over:
            time.sleep(10.0)  # noqa: TID251 - it is what is to be interrupted
        return Verdict(holds=False)


class Starved(Guard):
    """Holds above `over` metres, and takes 40 ms there while others have the processor."""

    kind: ClassVar[str] = "starved"
    over: float = 1.0

    @override
    def check(self, seen: Estimate) -> Verdict:
        height = -float(seen.position[2])
        if height > self.over:
            time.sleep(0.04)  # noqa: TID251 - as if others had the processor
        return Verdict.above(height, self.over)


def with_odd_ones() -> Catalogue:
    return builtin().extended("behaviors", (Odd, Stillborn)).extended("guards", (Sleepy, Starved))
