"""What a vehicle remembers of ten robots of which it sees a few at a time: who is where.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from missionkit.geometry import Mat
from missionkit.ground_robot import GroundRobot
from missionkit.messages.herd import Arena, HerdRobot, HerdState
from missionkit.planning.herding import herd_particles as hp
from missionkit.planning.herding.arena_frame import from_arena, to_arena
from missionkit.planning.herding.robot_forecast import HEADING, REVERSAL_IN, SPIN_LEFT, X, Y

PARTICLES = 96
HYPOTHESES = 8  # states of a robot that a policy sees
SURE_SIGHT = 0.85  # of the radius that is in view: a robot there would be found
LEAST_SHARE = 0.1  # of its particles that a robot must have near a place to be looked for there
CLOCK_KNOWN = 1.5  # s, between the clocks of all particles
ROBOT = GroundRobot()
Key = int | str


@dataclass(frozen=True, slots=True)
class Seen:
    """A robot in view: its track, and where it is in the arena's axes."""

    track: Key
    state: tuple[float, float, float]  # m, m, rad
    spins: float = 0.0  # s for which it has spun, 0: it drives; NaN: it spins, but since when?
    caused: float = 0.0  # s that the spin takes which a bump or a touch began, 0: its own clock


@dataclass(slots=True)
class HerdMemory:
    """Particles of each robot, and which track is which robot."""

    particles: Mat  # (robots, PARTICLES, hp.SIZE)
    seeds: hp.Seeds
    half: float  # m, of the arena's side
    who: dict[Key, int] = field(default_factory=dict)  # robot of each track that lives

    def advance(self, dt: float) -> None:
        """Let `dt` (s) pass."""
        hp.move(self.particles, dt, self.half, ROBOT, self.seeds)

    def turn(self, robot: int, lasts: float) -> None:
        """Let a robot have been turned, in every other particle: perhaps it has not.

        Args:
            robot: that was met.
            lasts: s, the spin.
        """
        drives = self.particles[robot, :, SPIN_LEFT] == 0.0
        drives[::2] = False
        self.particles[robot, drives, SPIN_LEFT] = lasts

    def look(self, seen: Sequence[Seen], spot: tuple[float, float], sight: float) -> None:
        """Take in what is in view.

        Args:
            seen: all robots in view.
            spot: m, arena axes, of the vehicle.
            sight: m, radius of what it sees around it.
        """
        tracks = {it.track for it in seen}
        self.who = {track: robot for track, robot in self.who.items() if track in tracks}
        for it in self._assigned([it for it in seen if it.track not in self.who]):
            hp.found(self.particles[self.who[it.track]], np.array(it.state), ROBOT, self.seeds)
        for it in seen:
            robot = self.who.get(it.track)
            if robot is not None:
                hp.follow(
                    self.particles[robot],
                    np.array(it.state),
                    it.spins,
                    it.caused,
                    ROBOT,
                    self.seeds,
                )
        below = np.array(spot)
        for robot in set(range(len(self.particles))) - set(self.who.values()):
            hp.unseen(
                self.particles[robot], below, SURE_SIGHT * sight, self.half, ROBOT, self.seeds
            )

    def _assigned(self, new: Sequence[Seen]) -> Sequence[Seen]:
        """Give each new track the robot that agrees with it best; return those that got one."""
        rows = []
        for it in new:
            state = np.array(it.state)
            for robot, P in enumerate(self.particles):
                rows.append((hp.agreement(P, state), robot, it))
        rows.sort(key=lambda row: -row[0])
        assigned = []
        for _, robot, it in rows:
            if it.track not in self.who and robot not in self.who.values():
                self.who[it.track] = robot
                assigned.append(it)
        return assigned

    def clock(self, robot: int) -> float | None:
        """Return the time (s) until a robot reverses, None if it is not known."""
        clocks = self.particles[robot, :, REVERSAL_IN]
        least, most = float(clocks.min()), float(clocks.max())
        return max(0.0, 0.5 * (least + most)) if most - least < CLOCK_KNOWN else None

    def robots(self, arena: Arena, names: Mapping[int, str], sight: float) -> tuple[HerdRobot, ...]:
        """Return what a policy sees of the robots that may still be in the arena.

        Args:
            arena: in which axes.
            names: of robots.
            sight: m, radius of what the vehicle sees.
        """
        in_view = set(self.who.values())
        found = (
            self._robot(arena, robot, names[robot], sight, in_view=robot in in_view)
            for robot in range(len(self.particles))
        )
        return tuple(it for it in found if it is not None)

    def _robot(
        self, arena: Arena, robot: int, name: str, sight: float, *, in_view: bool
    ) -> HerdRobot | None:
        P = self.particles[robot]
        best, share = hp.densest(P, sight)
        if share < LEAST_SHARE:
            return None
        first, *others = [_state(arena, it) for it in hp.near(P, best, sight, HYPOTHESES).tolist()]
        return HerdRobot(
            name,
            *first[:3],
            self.clock(robot),
            in_view=in_view,
            states=tuple(others),
            found=share,
        )


def _state(arena: Arena, it: Sequence[float]) -> HerdState:
    return HerdState(
        from_arena(arena, (it[X], it[Y])),
        it[HEADING] + arena.goal,
        it[SPIN_LEFT],
        max(0.0, it[REVERSAL_IN]),
    )


def at_start(count: int, arena: Arena, seed: int = 0, particles: int = PARTICLES) -> HerdMemory:
    """Return the memory at the start: robots on a circle of 1 m in the middle, heading out.

    Args:
        count: of robots.
        arena: that they are in.
        seed: of the particles' chance.
        particles: of each robot.
    """
    seeds = np.array([seed], dtype=np.uint64)
    P = np.zeros((count, particles, hp.SIZE))
    clocks = ROBOT.reversal_every * (np.arange(particles) + 0.5) / particles
    for robot in range(count):
        heading = 2.0 * math.pi * robot / count
        x, y = to_arena(arena, (arena.north + math.cos(heading), arena.east + math.sin(heading)))
        P[robot, :, :3] = x, y, heading - arena.goal
        P[robot, :, REVERSAL_IN] = clocks
    return HerdMemory(P, seeds, 0.5 * arena.side)
