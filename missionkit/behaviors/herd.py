"""Choosing the next ground robot of a herd, and waiting above it for the moment to turn it."""

from __future__ import annotations

import math
from typing import Any, ClassVar, Literal, NamedTuple

from pydantic import Field
from typing_extensions import override

from missionkit.geometry import vec
from missionkit.ground_robot import GroundRobot
from missionkit.messages import TRACKED, Estimate, Goal, Guidance, Step, Target, names_a_track
from missionkit.messages.herd import Arena, HerdChoice, HerdObstacle, HerdRobot, HerdView
from missionkit.planning.herding.dynamic_programme import DynamicProgramme
from missionkit.planning.herding.nearest_to_goal import NearestToGoal
from missionkit.plugin import Behavior
from missionkit.plugin_protocols import HerdingPolicyProtocol
from missionkit.units import Degrees, Metres, MetresPerSecond, Seconds

ROBOT = GroundRobot()
OBSTACLE, SPIN = "obstacle", "spin"
EVERY = 0.5  # s, between two decisions


class Herding(NamedTuple):
    """Memory of `herd`."""

    yaw: float  # rad, where the nose points
    decided_at: float = -math.inf  # s
    choice: HerdChoice = HerdChoice(None, "wait")


class Herd(Behavior):
    """Choose the robot that is next by a herding policy and stay above it until it is to be turned.

    Of the tracked robots those count whose heading is known and that are likelier targets than
    obstacle robots. The choice becomes the mission's `tracked`; done `within` of it, once the
    policy says that the descent begins. While none is worth a landing it stays above the one that
    comes next to it, and says what each is worth.

    The arena is a square of `side` around `north`, `east`, its goal line in the direction
    `goal_deg`; the mission ends at `length`. `policy` is a herding policy of missionkit, with
    `turns` if it is `dynamic_programme`.
    """

    kind: ClassVar[str] = "herd"
    policy: Literal["dynamic_programme", "nearest_to_goal"] = Field(
        default="dynamic_programme", description="that chooses"
    )
    turns: Literal["front", "front_and_top"] = Field(
        default="front", description="how robots are turned"
    )
    height: Metres = Field(default=2.5, gt=0, description="above the ground")
    speed: MetresPerSecond = Field(default=2.13, gt=0)
    within: Metres = Field(default=0.5, gt=0)
    side: Metres = Field(default=20.0, gt=0, description="of the arena")
    north: Metres = Field(default=0.0, description="of its centre")
    east: Metres = Field(default=0.0, description="of its centre")
    goal_deg: Degrees = Field(default=0.0, description="of the goal line, clockwise from north")
    length: Seconds = Field(default=600.0, description="of the mission")

    @override
    def begin(self, seen: Estimate) -> Herding:
        return Herding(seen.yaw)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        on: Herding = memory or self.begin(seen)  # None: begin failed
        if seen.now - on.decided_at >= EVERY:
            choice = self._policy().choose(self._view(seen, on.choice.robot))
            on = on._replace(decided_at=seen.now, choice=choice)
        values = on.choice.values
        name = on.choice.robot or max(values, key=values.__getitem__, default="")
        robot = seen.targets.get(name)
        if robot is None:
            return Step(note="no robot can be turned", memory=on)
        return self._above(seen, robot, on)

    @override
    def warm_up(self) -> None:
        policy = self._policy()
        if isinstance(policy, DynamicProgramme):
            policy.choose(_rehearsed(self._arena()))

    def _policy(self) -> HerdingPolicyProtocol:
        if self.policy == "nearest_to_goal":
            return NearestToGoal()
        return DynamicProgramme(turns=self.turns, length=self.length, speed=self.speed)

    def _arena(self) -> Arena:
        return Arena(self.side, self.north, self.east, math.radians(self.goal_deg))

    def _view(self, seen: Estimate, chosen: str | None) -> HerdView:
        known = {name: it for name, it in seen.targets.items() if _counts(name, it)}
        n, e, d = seen.position.tolist()
        v_n, v_e, v_d = seen.velocity.tolist()
        return HerdView(
            self.length - seen.now,
            self._arena(),
            (n, e, d),
            (v_n, v_e, v_d),
            tuple(_robot(name, it) for name, it in known.items() if not _is_obstacle(it)),
            tuple(_obstacle(it) for it in known.values() if _is_obstacle(it)),
            chosen,
        )

    def _above(self, seen: Estimate, robot: Target, on: Herding) -> Step:
        north, east, ground = robot.position.tolist()
        place = vec(north, east, ground - self.height)
        gap = math.dist(place[:2], seen.position[:2])
        speed = 0.0 if robot.modes.get(SPIN, 0.0) > 0.5 else ROBOT.speed
        heading = robot.heading or 0.0
        ahead = vec(speed * math.cos(heading), speed * math.sin(heading), 0.0)
        choice = on.choice
        due = choice.action != "wait" and choice.start_in - (seen.now - on.decided_at) <= EVERY
        return Step(
            Guidance(place, self.speed, ahead, yaw=on.yaw),
            done=due and gap <= self.within,
            goal=Goal(place, None, seen.now, TRACKED),
            note=f"{gap:.2f} m off {robot.name}, {choice.action} in {choice.start_in:.0f} s "
            f"({choice.text()})",
            memory=on,
            chosen=robot.name,
        )


def _counts(name: str, it: Target) -> bool:
    return names_a_track(name) and name != TRACKED and it.heading is not None


def _is_obstacle(it: Target) -> bool:
    return it.classes.get(OBSTACLE, 0.0) > 0.5


def _robot(name: str, it: Target) -> HerdRobot:
    north, east, _ = it.position.tolist()
    spins = it.modes.get(SPIN, 0.0) > 0.5
    return HerdRobot(
        name,
        (north, east),
        it.heading or 0.0,
        0.5 * ROBOT.spin_time if spins else 0.0,
        it.reversal_in,
        it.position_sd,
        it.heading_sd or 0.0,
    )


def _obstacle(it: Target) -> HerdObstacle:
    north, east, _ = it.position.tolist()
    return HerdObstacle((north, east), it.heading or 0.0, ROBOT.speed, ROBOT.circle_rate)


def _rehearsed(arena: Arena) -> HerdView:
    """Return a view that makes a policy compile all it needs."""
    robots = (
        HerdRobot("known", (arena.north + 2.0, arena.east), 0.0, reversal_in=12.0),
        HerdRobot("not known", (arena.north, arena.east + 2.0), 1.0, position_sd=1.0),
    )
    return HerdView(60.0, arena, (0.0, 0.0, -2.0), (0.0, 0.0, 0.0), robots)
