"""What `herd` remembers of robots out of view, as an immutable value: who is where.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from missionkit.geometry import Mat
from missionkit.ground_robot import GroundRobot
from missionkit.messages import Target
from missionkit.messages.herd import Arena, HerdRobot, Interaction
from missionkit.messages.robot_modes import spins
from missionkit.planning.herding.arena_frame import to_arena
from missionkit.planning.herding.herd_memory import HerdMemory, Seen, at_start
from missionkit.planning.herding.herd_particles import Seeds

ROBOT = GroundRobot()
LONGEST = 2.0  # s, that robots are moved at once
NOTICED = 0.2  # s after its begin a spin is noticed
BACK_UP = 1.0  # s after the turn, before which a vehicle that made it sees nothing


class Turn(NamedTuple):
    """The spin that a meeting brings, and how long (s) after the meeting began that begins."""

    lasts: float  # s
    shortest: float
    longest: float
    usual: float


TURNS: Mapping[Interaction, Turn] = MappingProxyType(
    {
        "front": Turn(ROBOT.spin_time, 2.0, 6.0, 3.4),
        "top": Turn(0.25 * ROBOT.spin_time, 2.0, 4.5, 3.0),
    }
)


class Met(NamedTuple):
    """The last meeting."""

    robot: str  # its track
    action: Interaction
    at: float  # s, when it began


class RememberedHerd(NamedTuple):
    """Particles of each robot, and which track is which robot."""

    particles: Mat  # (robots, particles, SIZE)
    seeds: Seeds
    at: float = 0.0  # s
    who: Mapping[int | str, int] = MappingProxyType({})  # robot of each track in view
    spun_since: Mapping[str, float] = MappingProxyType({})  # s, of each track that spins


class Sight(NamedTuple):
    """What the vehicle sees at one look."""

    now: float  # s
    robots: tuple[Target, ...]  # in view, with headings
    spot: tuple[float, float]  # m, north and east, of the vehicle
    radius: float  # m, around it, in which a robot would be seen; 0: do not conclude from absence
    met: Met | None = None  # the last meeting


def beginning(count: int, arena: Arena) -> RememberedHerd:
    """Return the memory at the start: robots on a circle of 1 m in the middle, heading out.

    Args:
        count: of robots.
        arena: that they are in.
    """
    known = at_start(count, arena)
    return RememberedHerd(known.particles, known.seeds)


def looked(known: RememberedHerd, sight: Sight, arena: Arena) -> RememberedHerd:
    """Return the memory after a look.

    Args:
        known: the memory.
        sight: what is in view.
        arena: that they are in.
    """
    memory = _opened(known, arena)
    at, met = known.at, _met_unseen(known, sight)
    if met is not None:
        turn = TURNS[met.action]
        _pass(memory, met.at + turn.usual - at)
        memory.turn(known.who[met.robot], turn.lasts)
        at = met.at + turn.usual
    _pass(memory, sight.now - at)
    spinning = {it.name: _since(it, known, sight) for it in sight.robots if spins(it)}
    seen = [_seen(it, spinning.get(it.name), sight, arena) for it in sight.robots]
    memory.look(seen, to_arena(arena, sight.spot), sight.radius)
    return RememberedHerd(memory.particles, memory.seeds, sight.now, memory.who, spinning)


def robots(known: RememberedHerd, arena: Arena, sight: float) -> tuple[HerdRobot, ...]:
    """Return what a policy sees of the robots that may still be in the arena.

    Args:
        known: the memory.
        arena: that they are in.
        sight: m, radius of what the vehicle sees from where it cruises.
    """
    return _opened(known, arena).robots(arena, _names(known), sight)


def number_of(known: RememberedHerd, name: str | None) -> int | None:
    """Return which robot is called by a name now; None: none is."""
    return next((robot for robot, it in _names(known).items() if it == name), None)


def name_of(known: RememberedHerd, robot: int | None) -> str | None:
    """Return how a robot is called now: by its track, or `unseen_N`."""
    return None if robot is None else _names(known)[robot]


def _names(known: RememberedHerd) -> dict[int, str]:
    names = {robot: f"unseen_{robot + 1}" for robot in range(len(known.particles))}
    return names | {robot: str(track) for track, robot in known.who.items()}


def _opened(known: RememberedHerd, arena: Arena) -> HerdMemory:
    return HerdMemory(known.particles.copy(), known.seeds.copy(), 0.5 * arena.side, dict(known.who))


def _pass(memory: HerdMemory, left: float) -> None:
    """Let time (s) pass."""
    while left > 0.0:
        memory.advance(min(left, LONGEST))
        left -= LONGEST


def _met_unseen(known: RememberedHerd, sight: Sight) -> Met | None:
    """Return the meeting since the last look that took long enough to turn a remembered robot."""
    met = sight.met
    if met is None or met.robot not in known.who or known.at > met.at:
        return None
    return met if sight.now > met.at + TURNS[met.action].usual + BACK_UP else None


def _since(it: Target, known: RememberedHerd, sight: Sight) -> float:
    """Return when (s) the spin began that a robot is in, NaN if that was not seen.

    By its tracker, or by the looks at it; a spin of the robot that was met began with the meeting.
    """
    if it.spin_left is not None:
        return sight.now - (ROBOT.spin_time - it.spin_left)
    if it.name in known.spun_since:
        return known.spun_since[it.name]
    if it.name in known.who:
        return sight.now - NOTICED
    if sight.met is not None and it.name == sight.met.robot:
        turn = TURNS[sight.met.action]
        if sight.now - sight.met.at < turn.longest + turn.lasts:
            return sight.met.at + turn.usual
    return math.nan


def _seen(it: Target, since: float | None, sight: Sight, arena: Arena) -> Seen:
    north, east, _ = it.position.tolist()
    x, y = to_arena(arena, (north, east))
    state = x, y, (it.heading or 0.0) - arena.goal
    if since is None:
        return Seen(it.name, state)
    return Seen(it.name, state, max(sight.now - since, NOTICED), _caused(it, since, sight.met))


def _caused(it: Target, since: float, met: Met | None) -> float:
    """Return how long (s) a spin takes which the last meeting began, 0: it is the robot's own."""
    if met is None or it.name != met.robot:
        return 0.0
    turn = TURNS[met.action]
    return turn.lasts if turn.shortest <= since - met.at <= turn.longest else 0.0
