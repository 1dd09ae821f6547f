"""Ours: the turn of a robot that raises most the number of robots that come home."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from missionkit.geometry import Mat
from missionkit.ground_robot import GroundRobot
from missionkit.messages.herd import Arena, HerdChoice, HerdRobot, HerdView
from missionkit.planning.herding.arena_frame import to_arena
from missionkit.plugin import Plugin
from missionkit.units import Fraction, Metres, MetresPerSecond, MetresPerSecond2, Number, Seconds

if TYPE_CHECKING:
    from missionkit.planning.herding.gain import Outlook, Timing

Turn = tuple[float, float, int]  # value, delay (s), touches
TOUCHES = 3  # most, one after the other
DELAYS = np.arange(0.0, 11.0, 1.0)  # s
FEW_DELAYS = DELAYS[::2]  # for a robot of which not much is known
CERTAIN = 0.3  # m, a robot better known than this is taken for where it is
ANY_CLOCK = (7.5, 2.5, 12.5, 17.5)  # s, until a reversal of which nothing is known
KNOWN_POINTS = (
    (0.0, 0.0, 0.0, 2.0 / 3.0),
    *((0.0, 0.0, turn, 1.0 / 6.0) for turn in (-math.sqrt(3.0), math.sqrt(3.0))),
)
POINTS = (
    (0.0, 0.0, 0.0, 0.25),
    *((*sign * 2.0 * axis, 0.125) for axis in np.eye(3) for sign in (-1.0, 1.0)),
)
"""Standard deviations along x, y and heading, and weights."""
RANDOM_TURN = GroundRobot().turn_variance * GroundRobot().turn_every  # rad², of one turn


class DynamicProgramme(Plugin):
    """Choose the turn that gains most chances to come home for the vehicle's time.

    Each robot alone, turned at a price, is worth V(place, heading, time left): `value_iteration`
    (`bump_price`, `touch_price`). A turn at a certain moment gains V after it - V without it; less
    `time_price` for each second until the vehicle is free. The best robot, moment and kind of
    turn wins; the last choice stays until another is better by `stay`.

    `turns`: landing in front of a robot, or also touching its top, up to three times.
    A flight takes `speed` and `acceleration`; `land` is the time from above the robot's way to the
    bump, `touch` from above the robot to the touch, `climb` the way back up. It lands `lead` ahead
    of the robot, where no obstacle robot comes by, and flies `reach` level as it descends. A robot
    out of view counts by the chance that it is within `sight` of where it is expected.
    """

    kind: ClassVar[str] = "dynamic_programme"
    turns: Literal["front", "front_and_top"] = "front"
    bump_price: Annotated[Fraction, Field(gt=0)] = 0.2
    touch_price: Annotated[Fraction, Field(gt=0)] = 0.12
    time_price: Annotated[Number, Field(ge=0)] = 0.0133
    stay: Fraction = 0.03
    speed: Annotated[MetresPerSecond, Field(gt=0)] = 2.13
    acceleration: Annotated[MetresPerSecond2, Field(gt=0)] = 3.05
    land: Seconds = 1.9
    touch: Seconds = 1.4
    climb: Seconds = 1.0
    lead: Metres = 0.5
    reach: Annotated[Metres, Field(ge=0)] = 0.0
    sight: Annotated[Metres, Field(gt=0)] = 2.0
    length: Seconds = 600.0

    def choose(self, view: HerdView) -> HerdChoice:
        """Return the robot that is next."""
        from missionkit.planning.herding.gain import best_on_arrival, best_turn  # noqa: PLC0415

        if view.time_left <= 0.0:
            return HerdChoice(None, "wait")
        timing = self._timing()
        known = self._outlook(view.arena)._replace(others=_others(view))
        vehicle = np.array(to_arena(view.arena, view.position[:2]))
        touches = TOUCHES if self.turns == "front_and_top" else 0

        rest = view.time_left, touches, timing, known
        turns: dict[str, Turn] = {}
        for it in view.robots:
            states, weights = _states(view.arena, it)
            if it.in_view or not it.states:
                weights *= self._found(it)
                turns[it.name] = best_turn(states, weights, vehicle, DELAYS, *rest)
            else:
                turns[it.name] = best_on_arrival(states, it.found, vehicle, FEW_DELAYS, *rest)
        return self._chosen(view, turns)

    def prepare(self, arena: Arena) -> None:
        """Compute the table, or read it, before the first choice."""
        self._outlook(arena)

    def _timing(self) -> Timing:
        from missionkit.planning.herding.gain import Timing  # noqa: PLC0415

        return Timing(
            self.speed,
            self.acceleration,
            self.land,
            self.touch,
            self.climb,
            self.touch + self.climb,
            self.lead,
            self.reach,
            self.time_price,
        )

    def _outlook(self, arena: Arena) -> Outlook:
        from missionkit.planning.herding.gain import Outlook  # noqa: PLC0415
        from missionkit.planning.herding.value_table import value_table  # noqa: PLC0415

        half, robot = 0.5 * arena.side, GroundRobot()
        prices = (self.bump_price, self.touch_price if self.turns == "front_and_top" else math.inf)
        return Outlook(value_table(self.length, half, prices, robot), half, robot)

    def _chosen(self, view: HerdView, turns: Mapping[str, Turn]) -> HerdChoice:
        values = {name: turn[0] for name, turn in turns.items() if math.isfinite(turn[0])}
        best = max(values, key=values.__getitem__, default="")
        if values.get(best, 0.0) <= 0.0:
            return HerdChoice(None, "wait", values=MappingProxyType(values))
        if view.chosen in values and values[view.chosen] > max(0.0, values[best] - self.stay):
            best = view.chosen
        _, delay, touches = turns[best]
        return HerdChoice(best, "top" if touches else "front", delay, MappingProxyType(values))

    def _found(self, robot: HerdRobot) -> float:
        """Return the chance that a robot out of view is within sight of where it is expected."""
        if robot.in_view or robot.position_sd <= 0.0:
            return 1.0
        return 1.0 - math.exp(-0.5 * (self.sight / robot.position_sd) ** 2)


def _others(view: HerdView) -> Mat:
    """Return the obstacle robots (n, 5) of a view in the arena's axes."""
    rows = [
        (*to_arena(view.arena, it.position), it.heading - view.arena.goal, it.speed, it.turn_rate)
        for it in view.obstacles
    ]
    return np.array(rows).reshape(-1, 5)


def _states(arena: Arena, robot: HerdRobot) -> tuple[Mat, Mat]:
    """Return states of `robot_forecast` that a robot may be in, the likeliest first, and weights.

    The points of an unscented transform, over the heading alone of a robot whose place is known.
    """
    if robot.states:
        rows = [
            (*to_arena(arena, it.position), it.heading - arena.goal, it.spin_left, it.reversal_in)
            for it in robot.states
        ]
        return np.array(rows), np.full(len(rows), 1.0 / len(rows))
    x, y = to_arena(arena, robot.position)
    heading, variance = robot.heading - arena.goal, robot.heading_sd**2 + RANDOM_TURN
    known = robot.position_sd <= CERTAIN
    moved = KNOWN_POINTS if known else POINTS
    scale = (robot.position_sd, robot.position_sd, math.sqrt(variance))
    clocks = ANY_CLOCK if robot.reversal_in is None else (robot.reversal_in,)
    states = [
        (x + dx * scale[0], y + dy * scale[1], heading + turn * scale[2], robot.spin_left, clock)
        for dx, dy, turn, _ in moved
        for clock in clocks
    ]
    return np.array(states), np.repeat([it[3] for it in moved], len(clocks)) / len(clocks)
