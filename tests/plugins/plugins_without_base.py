"""A plug-in of every group; none is derived from a base class of the package."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np
from pydantic import BaseModel, ConfigDict

from missionkit import Guidance, Step, Target, Verdict, Wrench
from missionkit.estimation.builder import build
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.messages.herd import HerdChoice, HerdView

CONFIG = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class HighEnough(BaseModel):
    """A guard: holds above `height` (m)."""

    model_config = CONFIG
    kind: ClassVar[str] = "high_enough"
    height: float

    def check(self, seen: Any) -> Verdict:
        return Verdict.above(-float(seen.position[2]), self.height)

    def region(self) -> None:
        return None


class HighForLong(BaseModel):
    """A guard with memory: holds once it was above `height` (m) for `count` ticks."""

    model_config = CONFIG
    kind: ClassVar[str] = "high_for_long"
    height: float
    count: int = 100

    def begin(self) -> int:
        return 0

    def advance(self, memory: int, seen: Any) -> int:
        return memory + 1 if -seen.position[2] > self.height else 0

    def resumed(self, memory: int, gap: float) -> int:
        return 0

    def check(self, memory: int, seen: Any) -> Verdict:
        return Verdict.above(float(memory), float(self.count))

    def region(self) -> None:
        return None


class Climb(BaseModel):
    """A behaviour: straight up to `height` (m)."""

    model_config = CONFIG
    kind: ClassVar[str] = "bare_climb"
    height: float

    def begin(self, seen: Any) -> Any:
        return seen.position

    def step(self, seen: Any, memory: Any) -> Step:
        goal = np.array([memory[0], memory[1], -self.height])
        return Step(Guidance(goal, 1.0), memory=memory)

    def targets(self) -> tuple[str, ...]:
        return ()

    def unfit(self, known: Any, targets: Any) -> str:
        return ""


class Plain(BaseModel):
    """A navigator: the built-in filter with its defaults."""

    model_config = CONFIG
    kind: ClassVar[str] = "plain"

    def build(self, surveyed: Any, mount: Any) -> Any:
        return build(VisualInertialEkf(), surveyed, mount)


class Blind(BaseModel):
    """A detector that sees nothing."""

    model_config = CONFIG
    kind: ClassVar[str] = "blind"
    target: str

    def detect(self, frame: Any, camera: Any, prior: Any) -> tuple[Any, ...]:
        return ()


class Carefree(BaseModel):
    """A planner that lets everything pass."""

    model_config = CONFIG
    kind: ClassVar[str] = "carefree"

    def begin(self) -> None:
        return None

    def step(self, memory: None, seen: Any, goal: Any, wanted: Any) -> tuple[Any, None]:
        return np.zeros(3), None


class Drifting(BaseModel):
    """A controller that never thrusts."""

    model_config = CONFIG
    kind: ClassVar[str] = "drifting"

    def begin(self) -> None:
        return None

    def step(
        self, memory: None, mode: Any, guidance: Any, seen: Any, dt: float
    ) -> tuple[Wrench, None]:
        return Wrench(np.zeros(3), np.zeros(3)), None


class AnyRobot(BaseModel):
    """A herding policy: the first robot."""

    model_config = CONFIG
    kind: ClassVar[str] = "any_robot"

    def choose(self, view: HerdView) -> HerdChoice:
        return HerdChoice(view.robots[0].name, "front")


class Standing(BaseModel):
    """A tracker that always knows one target, 4 m to the north."""

    model_config = CONFIG
    kind: ClassVar[str] = "standing"

    def begin(self) -> int:
        return 0

    def observe(self, memory: int, frame: Any) -> int:
        return memory + 1

    def targets(self, memory: int, now: float) -> dict[str, Target]:
        place = np.array([4.0, 0.0, 0.0])
        return {"robot_1": Target("robot_1", place, 0.1, None, None, seen_at=now)}
