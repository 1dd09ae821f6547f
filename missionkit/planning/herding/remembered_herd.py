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
from missionkit.messages.herd import Arena, HerdRobot
from missionkit.messages.robot_modes import spins
from missionkit.planning.herding.arena_frame import to_arena
from missionkit.planning.herding.herd_memory import HerdMemory, Seen, at_start
from missionkit.planning.herding.herd_particles import Seeds

ROBOT = GroundRobot()
LONGEST = 2.0  # s, that robots are moved at once
NOTICED = 0.2  # s after its begin a spin is noticed
TAKES = (2.0, 6.0)  # s, shortest and longest from the begin of a meeting to the turn it brings
USUAL = 3.4  # s, the same in most meetings


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
    turned: str | None = None  # the robot that was met last
    turned_at: float = 0.0  # s, when that began


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
    left = sight.now - known.at
    while left > 0.0:
        memory.advance(min(left, LONGEST))
        left -= LONGEST
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
    if it.name == sight.turned and sight.now - sight.turned_at < TAKES[1] + ROBOT.spin_time:
        return sight.turned_at + USUAL
    return math.nan


def _seen(it: Target, since: float | None, sight: Sight, arena: Arena) -> Seen:
    north, east, _ = it.position.tolist()
    x, y = to_arena(arena, (north, east))
    state = x, y, (it.heading or 0.0) - arena.goal
    if since is None:
        return Seen(it.name, state)
    caused = it.name == sight.turned and TAKES[0] <= since - sight.turned_at <= TAKES[1]
    lasts = ROBOT.spin_time if caused else 0.0
    return Seen(it.name, state, max(sight.now - since, NOTICED), lasts)
