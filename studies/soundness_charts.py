"""Random charts, and random flights through them, for the study of soundness."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from typing import ClassVar, NamedTuple

import numpy as np
from typing_extensions import override

from missionkit.chart.plugin_catalogue import Catalogue, builtin
from missionkit.messages import ABORT, Battery, Estimate, Health, VehicleStatus, Verdict
from missionkit.plugin import Guard


class Flag(Guard):
    """Opaque: holds while an event of its name comes, unknown while one with a mark does."""

    kind: ClassVar[str] = "flag"
    name: str

    @override
    def check(self, seen: Estimate) -> Verdict:
        if f"{self.name}?" in seen.events:
            return Verdict.unknown("asked for")
        return Verdict(self.name in seen.events)


CATALOGUE: Catalogue = builtin().extended("guards", (Flag,))
SHAPES = (  # name, indent, what it is
    ("s0", 1, "kind: custom, behavior: hold"),
    ("s1", 1, "kind: custom, behavior: hold"),
    ("s2", 1, "kind: logic, initial: in0"),
    ("in0", 2, "kind: custom, behavior: hold"),
    ("in1", 2, "kind: custom, behavior: hold"),
    ("s3", 1, "kind: logic, parallel: true"),
    ("left", 2, "kind: logic, initial: l0"),
    ("l0", 3, "kind: custom, behavior: hold"),
    ("l1", 3, "kind: custom, behavior: hold"),
    ("right", 2, "kind: logic, initial: r0"),
    ("r0", 3, "kind: logic"),
    ("r1", 3, "kind: logic"),
    ("home", 1, "kind: return, behavior: hold"),
    ("land", 1, "kind: land"),
)
STATES = tuple(name for name, _, _ in SHAPES)
FLOORS = ("0", "0.3", "0.5", "0.7", "1")
EVENTS = ("e", "f")
CHARGES = (0.0, 0.1, 0.3, 0.35, 0.45, 0.5, 0.55, 0.65, 0.8, 1.0, None)
FLAGS = ("a", "a?", "b", "b?")
TICK = 0.05  # s
HEALTHY = Health(
    aligned=True, diverged=False, gnss_at=None, vision_at=None, position_sd=0.3, rejected=0
)


class Seen(NamedTuple):
    """What the chart sees in a tick."""

    charge: float | None  # None: it is not known
    events: tuple[str, ...]
    failing: bool = False  # a plug-in
    in_air: bool = True


def chart(random: Random) -> str:
    """Return a random mission file, in which transition n is named tn."""
    of: dict[str, list[str]] = {name: [] for name in STATES}
    for number in range(random.randint(3, 12)):
        of[random.choice(STATES)].append(f"{_way(random)}, name: t{number}}}")
    dwell = random.choice(["0", "0.1", "0.3"])
    lines = ["missionkit: 1", "mission: random", "camera: {use: none}", f"dwell: {dwell}"]
    lines += ["initial: s0", f"variables: {{n: {{initial: 0, max: {random.randint(1, 4)}}}}}"]
    lines += ["guards: {a: {use: flag, name: a}, b: {use: flag, name: b}}", "failsafes:"]
    lines += [f"  - {_failsafe(random, number)}" for number in range(random.randint(0, 2))]
    if lines[-1] == "failsafes:":
        lines.pop()
    lines.append("states:")
    for at, (name, depth, shape) in enumerate(SHAPES):
        lines += _state(random, name, shape, of[name], "    " * depth)
        if at + 1 < len(SHAPES) and SHAPES[at + 1][1] > depth:
            lines.append(f"{'    ' * depth}  states:")
    return "\n".join(lines)


def _state(random: Random, name: str, shape: str, ways: list[str], indent: str) -> Iterator[str]:
    yield f"{indent}{name}:"
    yield from (f"{indent}  {each}" for each in shape.split(", "))
    if ways:
        yield f"{indent}  transitions:"
        yield from (f"{indent}    - {way}" for way in ways)
    if name != "land" and random.random() < 0.15:
        yield f"{indent}  invariant: {{holds: {_guard(random)}, exit: {random.choice(STATES)}}}"
    if random.random() < 0.1:
        yield f"{indent}  entry: [{_act(random)}]"


def _failsafe(random: Random, number: int) -> str:
    lasting = ", for: 0.1" if random.random() < 0.2 else ""
    unknown = random.choice(["take", "ignore"])
    to = random.choice(["home", "land", "s1"])
    when = _guard(random)
    return f"{{name: x{number}, when: {when}{lasting}, unknown: {unknown}, to: {to}}}"


def _way(random: Random) -> str:
    to, guard = random.choice(STATES), _guard(random)
    return random.choice(
        (
            f"{{to: {to}, when: {guard}",
            f"{{to: {to}, when: {guard}",
            f"{{to: {to}, when: {guard}, for: 0.1",
            f"{{to: {to}, after: {random.choice(['0.3', '0.5', '1.2'])}",
            f"{{to: {to}, when: {guard}, after: 0.3",
            f"{{to: {to}, when: {guard}, event: e",
            f"{{to: {to}, event: [e, f]",
            f"{{to: {to}, when: {guard}, emergency: true",
            f"{{do: [{_act(random)}], when: {guard}",
            f"{{to: {to}, do: [{_act(random)}], event: f",
        )
    )


def _act(random: Random) -> str:
    return random.choice(
        (
            "{assign: {n: {add: 1}}}",
            "{assign: {n: 0}}",
            "{raise: e}",
            "{raise: {event: f, after: 0.4}}",
            "{cancel: f}",
        )
    )


def _guard(random: Random, depth: int = 2) -> str:
    if depth and random.random() < 0.4:
        if random.random() < 0.4:
            return f"{{not: {_guard(random, depth - 1)}}}"
        parts = ", ".join(_guard(random, depth - 1) for _ in range(random.randint(1, 3)))
        return f"{{{random.choice(['all', 'any'])}: [{parts}]}}"
    return random.choice(
        (
            f"{{use: battery_below, floor: {random.choice(FLOORS)}}}",
            f"{{use: battery_below, floor: {random.choice(FLOORS)}}}",
            f"{{use: elapsed, longer_than: {random.choice(['0.2', '0.6'])}}}",
            *("a", "b", "{in: s1}", "{in: r1}", "{variable: n, at_least: 2}"),
            "{hysteresis: {use: battery_below, floor: 0.5}, enter: 0.4, exit: 0.6}",
        )
    )


def requirements(random: Random) -> list[str]:
    """Return lines of random requirements, r0, r1 and so on."""

    def moment() -> str:
        entered = f"{{enter: {random.choice(STATES)}}}"
        return random.choice((entered, f"{{in: {random.choice(STATES)}}}", _guard(random, 1)))

    found = ["requirements:"]
    for number in range(3):
        scope = random.choice(("", "", f", after: {moment()}", f", while: {_guard(random, 1)}"))
        within = random.choice(("", "", ", within: 0.5"))
        answer = f"response: {{when: {moment()}, then: {moment()}{within}}}"
        pattern = random.choice(
            (
                f"never: {moment()}{within}",
                f"always: {_guard(random, 1)}{within}",
                f"existence: {moment()}{within}",
                f"precedence: {moment()}, before: {moment()}{within}",
                answer,
            )
        )
        found.append(f"  - {{name: r{number}, {pattern}{scope}}}")
    return found


def flight(random: Random) -> list[Seen]:
    """Return what a random flight of at most four seconds sees."""
    found = []
    charge: float | None = 1.0
    flags: list[str] = []
    for _ in range(random.randint(10, 80)):
        if random.random() < 0.3:  # what is seen lasts for a while
            charge = random.choice(CHARGES)
        if random.random() < 0.3:
            flags = [each for each in FLAGS if random.random() < 0.25]
        events = [each for each in EVENTS if random.random() < 0.15]
        events += [ABORT] if random.random() < 0.005 else []
        found.append(Seen(charge, (*flags, *events)))
    return found


def estimate(seen: Seen, now: float, state: str, entered_at: float) -> Estimate:
    """Return what the engine is given in a tick."""
    battery = None if seen.charge is None else Battery(now, seen.charge, 16.0)
    return Estimate(
        now=now,
        position=np.array([0.0, 0.0, -5.0]),
        velocity=np.zeros(3),
        attitude=np.array([1.0, 0.0, 0.0, 0.0]),
        rates=np.zeros(3),
        health=HEALTHY._replace(gnss_at=now),
        battery=battery,
        status=VehicleStatus(now, armed=True, in_air=seen.in_air, ready=True, mode="offboard"),
        home=np.zeros(3),
        events=seen.events,
        state=state,
        entered_at=entered_at,
        failing=("a plug-in",) if seen.failing else (),
    )
