"""Choosing the next ground robot of a herd, and waiting above it for the moment to turn it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import Field, field_validator
from typing_extensions import override

from missionkit.geometry import vec
from missionkit.ground_robot import GroundRobot
from missionkit.messages import TRACKED, Estimate, Goal, Guidance, Step, Target, names_a_track
from missionkit.messages.herd import Arena, HerdChoice, HerdObstacle, HerdRobot, HerdView
from missionkit.messages.robot_modes import SPIN, is_obstacle, spins
from missionkit.planning.herding.dynamic_programme import DynamicProgramme
from missionkit.planning.herding.nearest_to_goal import NearestToGoal
from missionkit.planning.target_robots import place_ahead, stands_for, way_out
from missionkit.plugin import Behavior, InGroup
from missionkit.plugin_protocols import HerdingPolicyProtocol
from missionkit.units import Degrees, Fraction, Metres, MetresPerSecond, Seconds

if TYPE_CHECKING:
    from missionkit.planning.herding.remembered_herd import Met, RememberedHerd, Sight

ROBOT = GroundRobot()
OWN = ("dynamic_programme", "nearest_to_goal")  # policies that it makes itself
EVERY = 0.5  # s, between two decisions
LEVEL = 0.9  # m, that a landing flies level while it descends
BLOCK = 0.5  # m, ahead of a robot where it lands
FRESH = 0.3  # s; a track is in view if it was seen so lately
TURNS = {"front": "herd.front", "top": "herd.top"}  # events, by how the robot is to be turned
CLEAR = 0.6  # of the height, under which it flies nowhere but up


class Herding(NamedTuple):
    """Memory of `herd`."""

    yaw: float  # rad, where the nose points
    decided_at: float = -math.inf  # s
    choice: HerdChoice = HerdChoice(None, "wait")
    known: RememberedHerd | None = None
    robots: tuple[HerdRobot, ...] = ()  # what the last choice was made from
    met: Met | None = None  # the last meeting that it began


class Herd(Behavior):
    """Choose the robot that is next by a herding policy and stay above it until it is to be turned.

    Robots out of view are remembered, from the start on: `robots` of them on a circle of 1 m in the
    middle of the arena, heading out. Those in view are tracked ones whose heading is known and that
    are likelier targets than obstacle robots. It flies to the choice, or to where that is
    expected; once it is in view it becomes the mission's `tracked`; done `within` of it, when the
    policy says that the descent begins, with the event `herd.front` or `herd.top`. While none is
    worth a landing it stays above the one that comes next to it, and says what each is worth. From
    near the ground it climbs straight up first.

    A state inside, that meets the robot, pauses it and keeps its memory.

    The arena is a square of `side` around `north`, `east`, its goal line in the direction
    `goal_deg`; the mission ends at `length`. `policy` is a herding policy, of another package too.
    By its bare kind `dynamic_programme` knows `turns`, `speed`, `land`, `touch`, `climb`, `length`
    and the sight from here; as `{use: dynamic_programme, ...}` it is taken as it is given.
    """

    kind: ClassVar[str] = "herd"
    policy: Annotated[Any, InGroup("herding_policies", OWN)] = Field(
        default="dynamic_programme", description="that chooses"
    )
    turns: Literal["front", "front_and_top"] = Field(
        default="front", description="how robots are turned"
    )
    robots: int = Field(default=10, ge=1, le=20, description="in the arena at the start")
    height: Metres = Field(default=2.5, gt=0, description="above the ground")
    speed: MetresPerSecond = Field(default=2.13, gt=0)
    within: Metres = Field(default=0.5, gt=0)
    land: Seconds = Field(default=3.2, gt=0, description="from the choice's start to the bump")
    touch: Seconds = Field(default=3.0, gt=0, description="from the choice's start to the touch")
    climb: Seconds = Field(default=2.7, gt=0, description="from the bump until it is back up")
    ahead: Metres = Field(
        default=0.8, ge=0, description="of a robot, where it waits to land in front of it"
    )
    view: Fraction = Field(
        default=0.75, description="radius of what the camera shows, of the height"
    )
    side: Metres = Field(default=20.0, gt=0, description="of the arena")
    north: Metres = Field(default=0.0, description="of its centre")
    east: Metres = Field(default=0.0, description="of its centre")
    goal_deg: Degrees = Field(default=0.0, description="of the goal line, clockwise from north")
    length: Seconds = Field(default=600.0, description="of the mission")

    @field_validator("policy")
    @classmethod
    def _chooses(cls, policy: object) -> object:
        if policy in OWN or isinstance(policy, HerdingPolicyProtocol):
            return policy
        raise ValueError(f"expected a herding policy, got {policy!r}")

    @override
    def begin(self, seen: Estimate) -> Herding:
        return Herding(seen.yaw)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        on: Herding = memory or self.begin(seen)  # None: begin failed
        if seen.now - on.decided_at >= EVERY:
            on = self._decided(seen, on)
        name = _best(on.choice)
        it = next((it for it in on.robots if it.name == name), None)
        if it is None:
            return Step(note="no robot can be turned", memory=on)
        if -float(seen.position[2]) < CLEAR * self.height:
            return self._up(seen, on)
        target = seen.targets.get(it.name)
        return self._above(seen, target, it, on) if target else self._search(seen, it, on)

    @override
    def warm_up(self) -> None:
        from missionkit.planning.herding import remembered_herd as rh  # noqa: PLC0415

        arena = self._arena()
        known, policy = rh.beginning(self.robots, arena), self._policy()
        for k, modes in enumerate(({}, {}, {SPIN: 1.0}, {})):
            robot = _rehearsed(arena, 0.17 * k, modes)
            sight = rh.Sight(0.5 * k, (robot,), (arena.north, arena.east), 2.0)
            known = rh.looked(known, sight, arena)
            robots = rh.robots(known, arena, 2.0)
            near = HerdRobot("known", (arena.north + 2.0, arena.east), 0.0, reversal_in=12.0)
            view = HerdView(60.0, arena, (0.0, 0.0, -2.0), (0.0, 0.0, 0.0), (*robots, near))
            policy.choose(view)

    def _policy(self) -> HerdingPolicyProtocol:
        if isinstance(self.policy, HerdingPolicyProtocol):
            return self.policy
        if self.policy == "nearest_to_goal":
            return NearestToGoal()
        return DynamicProgramme(
            turns=self.turns,
            length=self.length,
            speed=self.speed,
            land=self.land,
            touch=self.touch,
            climb=self.climb,
            reach=LEVEL,
            lead=BLOCK,
            sight=self.view * self.height,
        )

    def _arena(self) -> Arena:
        return Arena(self.side, self.north, self.east, math.radians(self.goal_deg))

    def _decided(self, seen: Estimate, on: Herding) -> Herding:
        """Return the memory after a look at what is in view, and a choice."""
        from missionkit.planning.herding import remembered_herd as rh  # noqa: PLC0415

        arena, before = self._arena(), on.known
        known = before or rh.beginning(self.robots, arena)
        sight = self._sight(seen, on)
        after = rh.looked(known, sight, arena)
        chosen = rh.name_of(after, rh.number_of(known, on.choice.robot))
        robots = rh.robots(after, arena, self.view * self.height)
        n, e, d = seen.position.tolist()
        v_n, v_e, v_d = seen.velocity.tolist()
        obstacles = tuple(_obstacle(it) for it in _tracked(seen) if is_obstacle(it))
        left = self.length - seen.now
        view = HerdView(left, arena, (n, e, d), (v_n, v_e, v_d), robots, obstacles, chosen)
        choice = self._policy().choose(view)
        return on._replace(decided_at=seen.now, choice=choice, known=after, robots=robots)

    def _sight(self, seen: Estimate, on: Herding) -> Sight:
        from missionkit.planning.herding.remembered_herd import Sight  # noqa: PLC0415

        fresh = [
            it for it in _tracked(seen) if it.seen_at is not None and seen.now - it.seen_at < FRESH
        ]
        robots = [it for it in fresh if not is_obstacle(it)]
        known = tuple(it for it in robots if it.heading is not None)
        n, e, d = seen.position.tolist()
        radius = self.view * max(0.0, -d) if len(known) == len(robots) else 0.0
        return Sight(seen.now, known, (n, e), radius, on.met)

    def _up(self, seen: Estimate, on: Herding) -> Step:
        """Climb straight up: sideways it might be hit."""
        place = vec(float(seen.position[0]), float(seen.position[1]), -self.height)
        guidance = Guidance(place, self.speed, yaw=on.yaw, avoid=False)
        goal = Goal(place, None, seen.now, TRACKED)
        return Step(guidance, goal=goal, note="climbing", memory=on, lands=True)

    def _search(self, seen: Estimate, it: HerdRobot, on: Herding) -> Step:
        """Fly to where a robot out of view is expected."""
        place = vec(*it.position, -self.height)
        note = f"looking for {it.name}, found with {it.found:.2f} ({on.choice.text()})"
        guidance = Guidance(place, self.speed, yaw=on.yaw)
        return Step(guidance, goal=Goal(place, None, seen.now, TRACKED), note=note, memory=on)

    def _above(self, seen: Estimate, robot: Target, known: HerdRobot, on: Herding) -> Step:
        choice = on.choice
        over = choice.action == "top" or math.isinf(stands_for(robot))
        ahead = 0.0 if over else self.ahead
        reverses_in = self._reverses_first(seen, robot, known, on)
        met = robot if reverses_in is None else _reversed(robot, reverses_in)
        place = np.append(place_ahead(met, ahead, 0.0), met.position[2] - self.height)
        gap = math.dist(place[:2], seen.position[:2])
        stands = spins(robot) or reverses_in is not None
        along = np.append((0.0 if stands else ROBOT.speed) * way_out(robot), 0.0)
        due = choice.action != "wait" and seen.now - on.decided_at >= choice.start_in
        done = due and gap <= self.within and reverses_in is None
        if done:
            from missionkit.planning.herding.remembered_herd import Met  # noqa: PLC0415

            on = on._replace(met=Met(robot.name, choice.action, seen.now))
        return Step(
            Guidance(place, self.speed, along, yaw=on.yaw),
            done=done,
            events=(TURNS[choice.action],) if done else (),
            goal=Goal(place, None, seen.now, TRACKED),
            note=f"{gap:.2f} m off {robot.name}, {choice.action} in {choice.start_in:.0f} s "
            f"({choice.text()})",
            memory=on,
            chosen=robot.name,
        )

    def _reverses_first(
        self, seen: Estimate, robot: Target, known: HerdRobot, on: Herding
    ) -> float | None:
        """Return when (s) a robot that drives reverses by its clock, None: not before it is met.

        A meeting that began before that would end with it: on the wrong side of the robot.
        """
        since = seen.now - on.decided_at
        if on.choice.action == "wait" or spins(robot):
            return None
        if known.spin_left > since:
            return 0.0  # not noticed yet
        takes = self.touch if on.choice.action == "top" else self.land
        if known.reversal_in is None or known.reversal_in >= on.choice.start_in + takes:
            return None
        return max(0.0, known.reversal_in - since)


def _reversed(robot: Target, after: float) -> Target:
    """Return a robot as it is once it has reversed by its clock in `after` s."""
    place = np.append(place_ahead(robot, 0.0, after), robot.position[2])
    return robot._replace(position=place, heading=(robot.heading or 0.0) + math.pi)


def _best(choice: HerdChoice) -> str:
    """Return the robot that is chosen, or comes next to it."""
    values = choice.values
    return choice.robot or max(values, key=values.__getitem__, default="")


def _tracked(seen: Estimate) -> list[Target]:
    return [it for name, it in seen.targets.items() if names_a_track(name) and name != TRACKED]


def _obstacle(it: Target) -> HerdObstacle:
    north, east, _ = it.position.tolist()
    return HerdObstacle((north, east), it.heading or 0.0, ROBOT.speed, ROBOT.circle_rate)


def _rehearsed(arena: Arena, ahead: float, modes: Mapping[str, float]) -> Target:
    """Return a robot in view that makes a look compile all it needs."""
    place = vec(arena.north + 1.0 + ahead, arena.east, 0.0)
    return Target(
        "robot_1", place, 0.02, None, None, 0.0, heading=arena.goal, heading_sd=0.05, modes=modes
    )
