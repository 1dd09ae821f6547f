"""Flight along a planned path over a known map."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cached_property
from itertools import product
from typing import Any, ClassVar, Literal, NamedTuple

from pydantic import Field
from typing_extensions import override

from missionkit.behaviors.go_to import HOME
from missionkit.geometry import norm, vec
from missionkit.messages import Estimate, Goal, Guidance, Occupancy, Spot, Step
from missionkit.number_text import beside
from missionkit.planning import path_following
from missionkit.plugin import Behavior
from missionkit.units import Metres, MetresPerSecond, MetresPerSecond2, Number, Seconds

RESPONSE_TIME = 0.3  # s; the vehicle answers so late
LOOK_AHEAD = 1.0  # m ahead on the path, where the nose points
REPLAN_INTERVAL = 0.5  # s between two plans
PLANNING_SPEED = 0.1  # m/s, slow enough to plan
AWAY = 0.3  # m along a path; nearer it has not left the place where it stood
START: Spot = (0.0, 0.0)  # take-off point: the origin of the map
NO_PATH = "path.none"
PLANNED = "path.planned"


class OnPath(NamedTuple):
    """Memory of `follow_path`."""

    yaw: float  # rad, when it began
    down: float  # m, height to keep
    spots: tuple[Spot, ...] = ()  # the path; none yet, or stopping to plan
    along: float = 0.0  # m, how far it has been flown
    sensed: tuple[Spot, ...] = ()  # what stood in the way and is not on the map
    held: Spot | None = None  # where it stands without one, or stood last
    again: float = -math.inf  # s, not to be planned before
    why: str = "stopping to plan"


class FollowPath(Behavior):
    """Fly to `target` by the shortest path over the mission's map; done `within` of it.

    A* plans over the map with its walls thickened by

        r = body + clearance + sigmas sqrt(map_sd² + σ²)   (P2, section V: 0.5 m and 0.1 m)

    with σ the filter's own horizontal uncertainty, or 0 if nothing so wide leads to the target;
    the scan is not in doubt by σ. `neighbours` 4 with the Manhattan distance is
    P2's classical variant, 8 with the Euclidean its modified one; without a `heuristic` the
    tightest is taken. `smooth` replaces corners by lines of sight.

    The path is flown at `speed`, slower before its corners, at `height` above the take-off point
    or the height it began with; the nose looks along it, or stays with `heading` free. What the
    scan sees within `look_ahead` nearer to the path than half-way between `clearance` and what was
    planned for, or a wall that is new on the map, stops the vehicle; standing, it plans a new path
    round it. While it stands it keeps the clearance to what the scan sees, however much its
    position drifts; a path that is blocked before it was flown does not move the place where it
    stands. Raises the events `path.planned`, and `path.none` when there is no way; it then tries
    again every `patience`.
    """

    kind: ClassVar[str] = "follow_path"
    target: str
    height: Metres | None = None
    speed: MetresPerSecond = Field(default=0.5, gt=0)
    neighbours: Literal[4, 8] = 8
    heuristic: Literal["manhattan", "euclidean", "octile"] | None = None
    smooth: bool = False
    heading: Literal["path", "free"] = "path"
    clearance: Metres = Field(default=0.5, ge=0)
    body: Metres = Field(default=0.35, ge=0)
    map_sd: Metres = Field(default=0.1, ge=0)
    sigmas: Number = Field(default=2.0, ge=0)
    deceleration: MetresPerSecond2 = Field(default=0.5, gt=0)
    look_ahead: Metres = Field(default=3.0, gt=0)
    patience: Seconds = 2.0
    within: Metres = Field(default=0.3, gt=0)

    @override
    def begin(self, seen: Estimate) -> OnPath:
        down = float(seen.position[2]) if self.height is None else -self.height
        return OnPath(seen.yaw, down)

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        on: OnPath = memory
        goal = self._goal(seen)
        if goal is None or seen.map is None:
            lacking = (
                "there is no map"
                if seen.map is None
                else f"the position of {self.target} is unknown"
            )
            return Step(note=lacking, memory=on)
        towards = Goal(vec(*goal, on.down), None, seen.now)
        events: tuple[str, ...] = ()
        if not on.spots:
            standing = math.hypot(seen.velocity[0], seen.velocity[1]) < PLANNING_SPEED
            on = on._replace(held=self._kept_off(seen, on.held or _braked(seen)))
            if not standing or seen.now < on.again:
                return self._waiting(on, towards)
            on = self._planned(seen, seen.map, goal, on)
            events = (PLANNED if on.spots else NO_PATH,)
        path = path_following.legs(on.spots)
        if not path:
            return self._waiting(on, towards, events)
        here = _spot(seen)
        on = on._replace(along=path_following.nearest(path, on.along, here))
        if self._blocked(seen, seen.map, path, on.along):
            held = on.held if on.along < AWAY and on.held is not None else _braked(seen)
            on = on._replace(spots=(), held=held, why="the path is blocked: stopping")
            return self._waiting(on, towards, events)
        arrived = math.dist(here, goal) <= self.within and norm(seen.velocity) < 0.3
        guidance = self._guidance(path, on, here)
        left = path[-1].begins + path[-1].length - on.along
        note = f"{left:.1f} m of the path left"
        return Step(guidance, done=arrived, goal=towards, note=note, memory=on, events=events)

    @override
    def targets(self) -> tuple[str, ...]:
        return () if self.target == HOME else (self.target,)

    @override
    def unfit(self, known: Occupancy | None, targets: Mapping[str, Spot]) -> str:
        if self.neighbours == 8 and self.heuristic == "manhattan":
            return "'manhattan' overestimates diagonal moves; use 'octile' or 'euclidean'"
        if known is None:
            return "needs the mission's 'map'"
        if wrong := known.unfit_start(START):
            return f"the take-off point is {wrong}"
        goal = START if self.target == HOME else targets.get(self.target)
        return "" if goal is None else self._unfit_goal(known, goal)

    def _unfit_goal(self, known: Occupancy, goal: Spot) -> str:
        if not known.covers(goal):
            return f"its target {self.target!r} is outside the map"
        gap, radius = known.gap(goal), self._radius(0.0)
        if gap < radius:
            shown, limit = beside(gap, radius, 2)
            return (
                f"its target {self.target!r} is {shown} m from a wall, less than the {limit} m to "
                "keep"
            )
        return ""

    def _goal(self, seen: Estimate) -> Spot | None:
        if self.target == HOME:
            return None if seen.home is None else (float(seen.home[0]), float(seen.home[1]))
        target = seen.targets.get(self.target)
        return None if target is None else (float(target.position[0]), float(target.position[1]))

    def _radius(self, position_sd: float) -> float:
        """Return the distance (m) that the path keeps from walls on the map."""
        return self._keep + self.sigmas * math.hypot(self.map_sd, position_sd)

    @cached_property
    def _keep(self) -> float:
        return self.body + self.clearance

    def _planned(self, seen: Estimate, known: Occupancy, goal: Spot, on: OnPath) -> OnPath:
        """Return the memory with a path, round what was sensed; or with why there is none."""
        from missionkit.planning.route_planning import NoRouteError, Way, plan  # noqa: PLC0415

        now = _sensed(seen, known)
        tried = product(
            dict.fromkeys((_joined(on.sensed, now), now)),  # all, or what is there still
            dict.fromkeys(map(self._radius, (seen.health.position_sd, 0.0))),
        )
        why = ""
        for sensed, radius in tried:
            way = Way(radius, self.neighbours, self.heuristic, self.smooth)
            try:
                route = plan(known.with_walls(sensed), _spot(seen), goal, way)
            except NoRouteError as error:
                why = str(error)
            else:
                after = seen.now + REPLAN_INTERVAL
                return on._replace(spots=route.spots, along=0.0, sensed=sensed, again=after)
        return on._replace(again=seen.now + self.patience, why=why)

    def _blocked(
        self, seen: Estimate, known: Occupancy, path: tuple[path_following.Leg, ...], along: float
    ) -> bool:
        from missionkit.planning.path_blockage import in_the_way, walled  # noqa: PLC0415

        ahead = tuple(path_following.pieces(path, along, self.look_ahead))
        if walled(known, ahead):
            return True
        return seen.obstacles is not None and in_the_way(
            seen.obstacles, ahead, 0.5 * (self._keep + self._radius(0.0)), _spot(seen)
        )

    def _kept_off(self, seen: Estimate, held: Spot) -> Spot:
        """Return where to stand, with the clearance to what the scan sees: reckoning drifts."""
        from missionkit.planning.path_blockage import backed_off  # noqa: PLC0415

        return held if seen.obstacles is None else backed_off(held, seen.obstacles, self._keep)

    def _waiting(self, on: OnPath, towards: Goal, events: tuple[str, ...] = ()) -> Step:
        """Stop while there is no path yet."""
        guidance = None
        if on.held is not None:
            guidance = Guidance(vec(*on.held, on.down), self.speed, yaw=on.yaw)
        return Step(guidance, goal=towards, note=on.why, memory=on, events=events)

    def _guidance(self, path: tuple[path_following.Leg, ...], on: OnPath, here: Spot) -> Guidance:
        spot = path_following.leg_at(path, on.along).at(on.along)
        speed = path_following.allowed_speed(path, on.along, self.speed, self.deceleration)
        way = path_following.leg_at(path, on.along + RESPONSE_TIME * speed).way
        left = path[-1].begins + path[-1].length - on.along
        if left < RESPONSE_TIME * speed:
            spot, speed = path[-1].at(math.inf), 0.0
        ahead = path_following.leg_at(path, on.along + LOOK_AHEAD).at(on.along + LOOK_AHEAD)
        yaw: float | None = on.yaw
        if self.heading == "path":
            turned = ahead[0] - here[0], ahead[1] - here[1]
            yaw = math.atan2(turned[1], turned[0]) if math.hypot(*turned) > LOOK_AHEAD / 2 else None
        velocity = vec(speed * way[0], speed * way[1], 0.0)
        return Guidance(vec(*spot, on.down), self.speed, velocity, yaw)


def _spot(seen: Estimate) -> Spot:
    return float(seen.position[0]), float(seen.position[1])


def _braked(seen: Estimate) -> Spot:
    """Return where the vehicle comes to rest if it stops now."""
    return (
        float(seen.position[0] + RESPONSE_TIME * seen.velocity[0]),
        float(seen.position[1] + RESPONSE_TIME * seen.velocity[1]),
    )


def _sensed(seen: Estimate, known: Occupancy) -> tuple[Spot, ...]:
    """Return the middle of every cell in which the scan sees something."""
    if seen.obstacles is None:
        return ()
    spots = [(north, east) for north, east, _ in seen.obstacles.tolist()]
    cells = {tuple(map(math.floor, known.cell(spot))) for spot in spots}
    return tuple(known.spot(row + 0.5, column + 0.5) for row, column in sorted(cells))


def _joined(one: tuple[Spot, ...], other: tuple[Spot, ...]) -> tuple[Spot, ...]:
    return tuple(dict.fromkeys((*one, *other)))
