"""One precision landing of a study, by one of four rules, judged by ground truth."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from missionkit.chart.load import parse
from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import builtin
from missionkit.geometry import Mat
from missionkit.messages import Observation, Record
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import stage, world_of
from missionkit.sim.fault_injection import parse_fault
from missionkit.sim.world import Wind, World
from studies.parallel import in_parallel

MISSION = Path(__file__).parents[1] / "missions" / "precision_landing.yaml"
CUT = "\ninitial: idle\n"
START = "ready"  # the state before the landing
TAKE_OFF = """
initial: idle
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: $height}
    transitions: [{to: ready, when: done}]
  ready:
    kind: custom
    behavior: {use: go_to, target: home, height: $height, within: 0.15, speed: 1.0}
    transitions: [{to: NEXT, when: done, for: 0.5}]
"""
ABOVE = """\
    kind: custom
    behavior:
      {use: land_on, target: pad, phase: deviate, least: $height, sigmas: 0,
       half_angle_deg: 3, speed: $speed}
"""
END = """\
    transitions: [{to: land, when: done}]
  land: {kind: land}
success: {visit: land}
"""
FIXED = f"""\
{TAKE_OFF.replace("NEXT", "over")}\
  over:
{ABOVE}\
    transitions: [{{to: pause, event: pad.below}}]
  pause:
{ABOVE}\
    transitions: [{{to: descend, after: PAUSE}}]
  descend:
    kind: custom
    behavior: {{use: land_on, target: pad, phase: descend, speed: $speed, descent: $descent}}
{END}"""
BLIND = f"""\
{TAKE_OFF.replace("NEXT", "glide")}\
  glide:
    kind: custom
    behavior: {{use: land_on, target: pad, phase: glide, sigmas: 0, least: 0,
               speed: $speed, descent: $descent}}
{END}"""


class Rule(NamedTuple):
    """When and how a strategy goes down."""

    states: str | None  # instead of the mission's
    descent: float  # m/s
    faults: tuple[str, ...] = ()


RULES = {
    "ours": Rule(None, 1.5),
    "conservative": Rule(FIXED.replace("PAUSE", "3"), 0.5),
    "brisk": Rule(FIXED.replace("PAUSE", "1"), 1.0),
    "blind": Rule(BLIND, 1.5, ("camera_off",)),
}
"""The mission's chart; 3 s over the pad and 0.5 m/s; 1 s and 1 m/s; the path with no camera."""

UNGUARDED = "unguarded"
DEVIATES = "      - {to: deviate, when: glide-no-longer}\n"
"""The transition of the mission's chart that its rule of Markov states takes."""

POOR_CASES = ((10.0, 2.0), (20.0, 3.0))
POOR_SD, POOR_SCALE, POOR_FLOW = 0.5, 1.5, 3.0
"""Of the pad's place (m) as the mission states it, what it is really; of the noise of the flow."""

CASES = ((10.0, 2.0), (10.0, 5.0), (20.0, 3.0), (5.0, 3.0))
"""Level distance and height (m) at the start."""


class Order(NamedTuple):
    """One flight to be flown."""

    rule: str
    case: tuple[float, float]
    wind: float  # m/s, mean
    seed: int
    camera: str = "rendered"
    poor: bool = False  # estimate, and a narrow camera that looks straight down


class Landing(NamedTuple):
    """Result of one flight, from the start of the landing to the first touch of the ground."""

    order: Order
    energy: float  # J
    duration: float  # s
    missed: float  # m, level, from the middle of the pad
    touched: float  # m/s, sinking
    seen: bool  # the pad, by the filter
    covered: bool  # its miss was within 2 sigma as the landing began
    succeeded: bool
    states: tuple[str, ...]
    path: Mat  # (N, 2), m: level distance left, height


def faults_of(rule: str) -> tuple[str, ...]:
    """Return the faults that a rule is flown with.

    Args:
        rule: one of `RULES`, or `UNGUARDED`, which has none.
    """
    return RULES[rule].faults if rule in RULES else ()


@cache
def mission_of(rule: str, case: tuple[float, float], *, poor: bool = False) -> Mission:
    """Return the mission with the states of a rule.

    Args:
        rule: one of `RULES`, or `UNGUARDED`: the mission without its rule to deviate.
        case: level distance and height (m) at the start.
        poor: with a pad less well surveyed, more noise of the flow, and a camera of 60 by 47 deg
            that looks straight down.
    """
    text = MISSION.read_text(encoding="utf-8")
    chosen = RULES["ours" if rule == UNGUARDED else rule]
    if chosen.states is not None:
        text = text.partition(CUT)[0] + chosen.states
    if rule == UNGUARDED:
        before, _, after = text.partition(DEVIATES)
        text = before + after
    distance, height = case
    settings = {
        "north": f"{distance:g}",
        "height": f"{height:g}",
        "descent": f"{chosen.descent:g}",
    }
    if not poor:
        return parse(text, str(MISSION), builtin(), settings)
    settings |= {"pad_sd": f"{POOR_SD:g}", "flow_sd": f"{0.045 * POOR_FLOW:g}"}
    mission = parse(text, str(MISSION), builtin(), settings)
    mount = mission.camera.mount.model_copy(update={"tilt_deg": 90.0})
    eye = mission.camera.model_copy(update={"focal": 554.0, "mount": mount})
    return mission.model_copy(update={"camera": eye})


def world_for(order: Order, mission: Mission) -> World:
    """Return the world of a seed: the same pad and wind for every rule.

    The pad lies off its surveyed place as the mission says it may (a poor one by half as much
    again), and the wind comes from anywhere.
    """
    world, rng = world_of(mission, MISSION.parent), np.random.default_rng((13, order.seed))
    pad = mission.targets["pad"]
    north, east = rng.normal(0.0, pad.position_sd * (POOR_SCALE if order.poor else 1.0), 2)
    turn = rng.uniform(-math.pi, math.pi)
    middle = world.markers[-1].position
    markers = tuple(
        marker.model_copy(
            update={
                "position": (
                    pad.position[0] + north + marker.position[0] - middle[0],
                    pad.position[1] + east + marker.position[1] - middle[1],
                    marker.position[2],
                )
            }
        )
        for marker in world.markers
    )
    mean = (order.wind * math.cos(turn), order.wind * math.sin(turn), 0.0)
    wind = Wind(mean=mean, gust=world.wind.gust + 0.1 * order.wind)
    world = world.model_copy(update={"markers": markers, "wind": wind})
    if not order.poor:
        return world
    across, along = world.sensors.flow.sd
    noisy = (POOR_FLOW * across, POOR_FLOW * along)
    flow = world.sensors.flow.model_copy(update={"sd": noisy})
    sensors = world.sensors.model_copy(update={"flow": flow})
    return world.model_copy(update={"sensors": sensors})


def flown(order: Order) -> Landing:
    """Fly once."""
    mission = mission_of(order.rule, order.case, poor=order.poor)
    eye = mission.camera.model_copy(update={"use": order.camera})
    mission = mission.model_copy(update={"camera": eye})
    faults = [parse_fault(text) for text in faults_of(order.rule)]
    ready = stage(mission, builtin(), world_for(order, mission), order.seed, faults)
    pad = np.array(ready.world.markers[-1].position[:2])
    states: list[str] = []
    begun: list[tuple[float, float]] = []  # s, and by how many sd the estimate is off
    sightings: list[float] = []

    def watch(record: Record, _: Observation) -> None:
        target = record.estimate.targets["pad"]
        if not states or states[-1] != record.state:
            states.append(record.state)
            if len(states) > 1 and states[-2] == START:
                gap = pad - ready.vehicle.truth.position[:2]
                off = gap - (target.position - record.estimate.position)[:2]
                begun.append((record.now, float(np.hypot(*off)) / target.position_sd))
        if target.seen_at is not None:
            sightings.append(target.seen_at)

    try:
        result = rehearse(ready, (watch,))
    except Exception as error:
        error.add_note(f"in {order}")
        raise
    rows = ready.vehicle.track.rows
    first = int(np.searchsorted(rows[:, 0], begun[0][0]))
    last = int(np.flatnonzero(rows[:, 14] == 0.0)[-1])
    touch = min(last + 1, len(rows) - 1)
    way = rows[first : touch + 1]
    left = np.hypot(way[:, 1] - pad[0], way[:, 2] - pad[1])
    return Landing(
        order,
        energy=float(rows[touch, 20] - rows[first, 20]),
        duration=float(rows[touch, 0] - rows[first, 0]),
        missed=float(left[-1]),
        touched=float(rows[last, 6]),
        seen=any(at <= rows[touch, 0] for at in sightings),
        covered=begun[0][1] <= math.sqrt(2.0) * 2.0,
        succeeded=result.succeeded,
        states=tuple(states),
        path=np.column_stack([left, -way[:, 3]])[::2].copy(),
    )


def fly_all(orders: Sequence[Order], workers: int) -> Iterator[Landing]:
    """Fly each order, in order, `workers` at a time; with one worker in this process."""
    return in_parallel(flown, orders, workers, chunk=4)
