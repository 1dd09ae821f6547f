"""One ten-minute run of the herding mission at the kinematic level."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from missionkit.ground_robot import GroundRobot
from missionkit.messages.herd import Arena, HerdChoice, HerdObstacle, HerdRobot, HerdView
from missionkit.planning.herding import robot_forecast as fc
from missionkit.planning.herding.herd_memory import PARTICLES, HerdMemory, Seen, at_start
from missionkit.plugin_protocols import HerdingPolicyProtocol
from missionkit.sim import ground_robots as gr
from studies import herding_kernels as hk
from studies.herding_kernels import Facts, Order, Scene

ROBOT = GroundRobot()
TARGETS, OBSTACLES = 10, 4
LENGTH = 600.0  # s
EVERY = 0.5  # s, between two decisions
SELDOM = 1.0  # s, the same of a vehicle that sees a few robots
LOOK = 0.5  # s, between two looks at what is in view
SWAPPED = 0.02  # chance that the tracker swaps two robots that meet
MEET = 0.35  # m
ARENA = Arena()
Watch = Callable[[float, Scene], None]
NAMES = {i: f"robot_{i}" for i in range(TARGETS)}


class Run(NamedTuple):
    """How a run ended."""

    home: int
    removed: int
    remained: int
    bumps: int
    touches: int
    mistakes: int  # touches when it meant to land in front
    vain: int  # landings that no robot hit
    hit: bool  # a tower


def start(seed: int) -> Scene:
    """Return the begin: robots on a circle of 1 m, heading out; obstacle robots at 5 m."""
    rng = np.random.default_rng((14, seed))
    around = 2.0 * math.pi * np.arange(TARGETS) / TARGETS
    circling = 2.0 * math.pi * (np.arange(OBSTACLES) / OBSTACLES + rng.uniform())
    places = np.vstack(
        (
            np.column_stack((np.cos(around), np.sin(around))),
            ROBOT.circle_radius * np.column_stack((np.cos(circling), np.sin(circling))),
        )
    )
    headings = np.concatenate((around, circling + 0.5 * math.pi))
    phases = rng.uniform(0.0, ROBOT.reversal_every, TARGETS + OBSTACLES)
    seen = np.zeros((TARGETS, hk.SEEN_SIZE))
    seen[:, fc.REVERSAL_IN] = math.nan
    return Scene(
        np.array([-9.0, 0.0, 1.5, 0.0, 0.0, hk.CRUISE, 0.0]),
        gr.placed(places, headings, phases, ROBOT, obstacles=OBSTACLES),
        np.zeros(TARGETS + OBSTACLES),
        gr.random_offsets(rng, TARGETS + OBSTACLES, LENGTH + 60.0, ROBOT),
        seen,
        np.zeros((TARGETS, 3)),
        np.zeros(TARGETS),
        np.zeros(5),
    )


def run(
    seed: int,
    policy: HerdingPolicyProtocol,
    facts: Facts,
    particles: int = PARTICLES,
    watch: Watch | None = None,
) -> Run:
    """Fly ten minutes.

    Args:
        seed: of all that is random.
        policy: that chooses.
        facts: of vehicle and arena; with a limited sight the vehicle remembers the robots.
        particles: of each robot that it remembers.
        watch: called with the time (s) of each look at what is in view.
    """
    scene, rng = start(seed), np.random.default_rng((15, seed))
    if math.isinf(facts.sight):
        _seeing_all(scene, policy, facts, rng)
    else:
        memory = at_start(TARGETS, ARENA, particles=particles)
        _seeing_some(scene, policy, facts, rng, memory, watch)
    ends = scene.fate[:TARGETS]
    home, lost = int((ends == fc.HOME).sum()), int((ends == fc.LOST).sum())
    counts = [int(it) for it in scene.counts]
    return Run(home, lost, TARGETS - home - lost, *counts[:4], bool(counts[hk.HITS]))


def _seeing_all(
    scene: Scene, policy: HerdingPolicyProtocol, facts: Facts, rng: np.random.Generator
) -> None:
    now, order, chosen = hk.STEP, Order(), None
    hk.fly(scene, _still(scene), facts, ROBOT, (0.0, now), rng)
    while now < LENGTH:
        inside = np.flatnonzero(scene.fate[:TARGETS] == fc.INSIDE).tolist()
        choice = policy.choose(view(now, scene, [_seen(scene, i) for i in inside], chosen))
        chosen = choice.robot
        order = _still(scene) if chosen is None else _order(choice, int(chosen[6:]), now)
        now = hk.fly(scene, order, facts, ROBOT, (now, min(LENGTH, now + EVERY)), rng)


def _still(scene: Scene) -> Order:
    return Order(x=float(scene.vehicle[hk.PX]), y=float(scene.vehicle[hk.PY]))


def _order(choice: HerdChoice, target: int, now: float) -> Order:
    action = hk.TOP if choice.action == "top" else hk.FRONT
    begin = math.inf if choice.action == "wait" else now + choice.start_in - 0.5 * EVERY
    return Order(action, target, begin)


def _seen(scene: Scene, i: int) -> HerdRobot:
    x, y, heading, spin_left, clock = scene.seen[i, : fc.SIZE].tolist()
    known = None if math.isnan(clock) else max(0.0, clock)
    return HerdRobot(NAMES[i], (x, y), heading, spin_left, known)


def view(now: float, scene: Scene, robots: Iterable[HerdRobot], chosen: str | None) -> HerdView:
    """Return what a policy sees.

    Args:
        now: s.
        scene: all that moves.
        robots: what is known of them.
        chosen: the last choice.
    """
    x, y, height, vx, vy = scene.vehicle[:5].tolist()
    obstacles = tuple(
        HerdObstacle((it[gr.NORTH], it[gr.EAST]), it[gr.HEADING], ROBOT.speed, ROBOT.circle_rate)
        for it in scene.truth[TARGETS:]
    )
    return HerdView(
        LENGTH - now, ARENA, (x, y, -height), (vx, vy, 0.0), tuple(robots), obstacles, chosen
    )


def _seeing_some(
    scene: Scene,
    policy: HerdingPolicyProtocol,
    facts: Facts,
    rng: np.random.Generator,
    memory: HerdMemory,
    watch: Watch | None,
) -> None:
    tracks, now, decided = Tracks(rng), 0.0, -math.inf
    order, chosen = _still(scene), None
    while now < LENGTH:
        now = hk.fly(scene, order, facts, ROBOT, (now, now + LOOK), rng)
        if watch is not None:
            watch(now, scene)
        memory.advance(LOOK)
        sight = facts.sight * max(0.4, float(scene.vehicle[hk.HEIGHT]) / facts.cruise)
        spot = float(scene.vehicle[hk.PX]), float(scene.vehicle[hk.PY])
        memory.look(tracks.update(scene, spot, sight), spot, sight)
        for track, robot in memory.who.items():
            clock = memory.clock(robot)
            scene.seen[tracks.robots[track], fc.REVERSAL_IN] = math.nan if clock is None else clock
        if scene.vehicle[hk.MODE] == hk.CRUISE and now - decided >= SELDOM - 1e-6:
            decided = now
            robots = memory.robots(ARENA, NAMES, facts.sight)
            choice = policy.choose(view(now, scene, robots, chosen))
            chosen = choice.robot
            order = _ordered(choice, robots, memory, tracks, scene, now)


def _ordered(
    choice: HerdChoice,
    robots: tuple[HerdRobot, ...],
    memory: HerdMemory,
    tracks: Tracks,
    scene: Scene,
    now: float,
) -> Order:
    """Return the order to fly to a robot in view, or to where one is expected."""
    name = choice.robot or max(choice.values, key=choice.values.__getitem__, default=None)
    it = next((it for it in robots if it.name == name), None)
    if it is None:
        return _still(scene)
    if it.in_view:
        robot = next(key for key, value in NAMES.items() if value == name)
        track = next(key for key, value in memory.who.items() if value == robot)
        if choice.robot is None:
            choice = choice._replace(action="wait")
        return _order(choice, tracks.robots[track], now)
    return Order(x=it.position[0], y=it.position[1])


class Tracks:
    """A tracker: a number for each robot as long as it is in view, sometimes swapped."""

    def __init__(self, rng: np.random.Generator) -> None:
        self.robots: dict[int, int] = {}  # true robot of each track
        self._next = 0
        self._met: set[tuple[int, int]] = set()
        self._rng = rng

    def update(self, scene: Scene, spot: tuple[float, float], sight: float) -> list[Seen]:
        """Return what is in view within `sight` (m) of a spot (m)."""
        away = np.hypot(*(scene.truth[:TARGETS, :2] - spot).T)
        visible = set(np.flatnonzero((away < sight) & (scene.fate[:TARGETS] == fc.INSIDE)).tolist())
        self.robots = {track: it for track, it in self.robots.items() if it in visible}
        for robot in sorted(visible - set(self.robots.values())):
            self.robots[self._next] = robot
            self._next += 1
        self._swap(scene)
        return [
            Seen(
                track,
                tuple(scene.seen[it, :3].tolist()),
                float(scene.seen[it, hk.SPUN_FOR]),
                float(scene.caused[it]),
            )
            for track, it in self.robots.items()
        ]

    def _swap(self, scene: Scene) -> None:
        tracks = sorted(self.robots)
        pairs = [(a, b) for i, a in enumerate(tracks) for b in tracks[i + 1 :]]
        met = set()
        for a, b in pairs:
            i, j = self.robots[a], self.robots[b]
            if np.hypot(*(scene.truth[i, :2] - scene.truth[j, :2])) < MEET:
                met.add((a, b))
                if (a, b) not in self._met and self._rng.random() < SWAPPED:
                    self.robots[a], self.robots[b] = j, i
        self._met = met
