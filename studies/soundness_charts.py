"""Random charts, and random flights through them, for the study of soundness."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
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
OUTSIDE = (*SHAPES[:2], ("both", 1, "kind: logic, parallel: true"))
STATES = tuple(name for name, _, _ in SHAPES)
FLOORS = ("0", "0.3", "0.5", "0.7", "1")
EVENTS = ("e", "f")
CHARGES = (0.0, 0.1, 0.3, 0.35, 0.45, 0.5, 0.55, 0.65, 0.8, 1.0, None)
OWN_EVENTS = tuple(f"{each}{number}" for number in range(3) for each in EVENTS)  # of regions
FLAGS = ("a", "a?", "b", "b?")
TICK = 0.05  # s
HEALTHY = Health(
    aligned=True, diverged=False, gnss_at=None, vision_at=None, position_sd=0.3, rejected=0
)


class Words(NamedTuple):
    """What a part of a random chart may speak of."""

    states: tuple[str, ...]  # that its transitions lead to
    asked: tuple[str, ...]  # states that its guards ask for
    variable: str
    events: tuple[str, str]
    timed: bool = True  # its guards may depend on when the state that commands was entered
    promising: float = 0.15  # share of states with an invariant
    safe: tuple[str, ...] = ("home", "land", "s1")  # that its failsafes lead to


ALL = Words(STATES, ("s1", "r1"), "n", ("e", "f"))
OF_OTHERS = {"asked": ("p0a", "p0b", "p1a", "p1b"), "variable": "n0", "events": ("e0", "f1")}


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
        of[random.choice(STATES)].append(f"{_way(random, ALL)}, name: t{number}}}")
    lines = _head(random, "s0", ("n",), ALL)
    states = (_state(random, name, shape, of[name], ALL) for name, _, shape in SHAPES)
    return "\n".join([*lines, *_nested(SHAPES, states)])


def chart_of_regions(random: Random) -> str:
    """Return a random mission file with parallel regions, most of which are independent."""
    stray = random.random() < 0.3  # a part may have to do with another
    ends = SHAPES[-2:] if random.random() < 0.1 else SHAPES[-1:]
    regions = [_region(number) for number in range(random.randint(2, 3))]
    shapes = (*OUTSIDE, *(shape for _, shapes in regions for shape in shapes), *ends)
    outer = tuple(name for name, depth, _ in shapes if depth == 1)
    outside = Words(outer, ("s1",), "n", EVENTS, timed=False, safe=("land", "s1"))
    words = dict.fromkeys(outer, outside)
    for of_region, parts in regions:
        words |= {name: of_region for name, depth, _ in parts if depth == 3}
    of: dict[str, list[str]] = {name: [] for name, _, _ in shapes}
    for number in range(random.randint(6, 14)):
        name = random.choice((*words, *(it for it in words if it not in outer)))
        known = words[name]
        if stray and random.random() < 0.3:
            known = known._replace(**OF_OTHERS)
        of[name].append(f"{_way(random, known)}, name: t{number}}}")
    variables = ("n", *(of_region.variable for of_region, _ in regions))
    lines = _head(random, random.choice(("s0", "both", "both")), variables, outside)
    states = (_state(random, name, shape, of[name], words.get(name)) for name, _, shape in shapes)
    return "\n".join([*lines, *_nested(shapes, states)])


def _region(number: int) -> tuple[Words, tuple[tuple[str, int, str], ...]]:
    """Return what a region speaks of, and its states; the first region commands."""
    inner = tuple(f"p{number}{letter}" for letter in "abc")
    kind = "kind: logic" if number else "kind: custom, behavior: hold"
    top = (f"p{number}", 2, f"kind: logic, initial: {inner[0]}")
    events = (f"e{number}", f"f{number}")
    words = Words(inner, inner, f"n{number}", events, number == 0, 0.02)
    return words, (top, *((name, 3, kind) for name in inner))


def _head(random: Random, initial: str, variables: Sequence[str], words: Words) -> list[str]:
    """Return the lines before the states."""
    dwell = random.choice(["0", "0.1", "0.3"])
    lines = ["missionkit: 1", "mission: random", "camera: {use: none}", f"dwell: {dwell}"]
    known = [f"{name}: {{initial: 0, max: {random.randint(1, 4)}}}" for name in variables]
    lines += [f"initial: {initial}", f"variables: {{{', '.join(known)}}}"]
    lines += ["guards: {a: {use: flag, name: a}, b: {use: flag, name: b}}", "failsafes:"]
    lines += [f"  - {_failsafe(random, number, words)}" for number in range(random.randint(0, 2))]
    if lines[-1] == "failsafes:":
        lines.pop()
    return [*lines, "states:"]


def _nested(
    shapes: Sequence[tuple[str, int, str]], states: Iterable[Iterable[str]]
) -> Iterator[str]:
    """Yield the lines of states, each indented by its depth."""
    for at, ((_, depth, _), lines) in enumerate(zip(shapes, states, strict=True)):
        yield from ("    " * depth + line for line in lines)
        if at + 1 < len(shapes) and shapes[at + 1][1] > depth:
            yield "    " * depth + "  states:"


def _state(
    random: Random, name: str, shape: str, ways: list[str], words: Words | None
) -> list[str]:
    lines = [f"{name}:", *(f"  {each}" for each in shape.split(", "))]
    if ways:
        lines += ["  transitions:", *(f"    - {way}" for way in ways)]
    if words is None:  # a region itself
        return lines
    if name != "land" and random.random() < words.promising:
        holds = _guard(random, words)
        lines.append(f"  invariant: {{holds: {holds}, exit: {random.choice(words.states)}}}")
    if random.random() < 0.1:
        lines.append(f"  entry: [{_act(random, words)}]")
    return lines


def _failsafe(random: Random, number: int, words: Words) -> str:
    lasting = ", for: 0.1" if random.random() < 0.2 else ""
    unknown = random.choice(["take", "ignore"])
    to = random.choice(words.safe)
    when = _guard(random, words)
    return f"{{name: x{number}, when: {when}{lasting}, unknown: {unknown}, to: {to}}}"


def _way(random: Random, words: Words) -> str:
    to, guard = random.choice(words.states), _guard(random, words)
    one, other = words.events
    return random.choice(
        (
            f"{{to: {to}, when: {guard}",
            f"{{to: {to}, when: {guard}",
            f"{{to: {to}, when: {guard}, for: 0.1",
            f"{{to: {to}, after: {random.choice(['0.3', '0.5', '1.2'])}",
            f"{{to: {to}, when: {guard}, after: 0.3",
            f"{{to: {to}, when: {guard}, event: {one}",
            f"{{to: {to}, event: [{one}, {other}]",
            f"{{to: {to}, when: {guard}, emergency: true",
            f"{{do: [{_act(random, words)}], when: {guard}",
            f"{{to: {to}, do: [{_act(random, words)}], event: {other}",
        )
    )


def _act(random: Random, words: Words) -> str:
    one, other = words.events
    return random.choice(
        (
            f"{{assign: {{{words.variable}: {{add: 1}}}}}}",
            f"{{assign: {{{words.variable}: 0}}}}",
            f"{{raise: {one}}}",
            f"{{raise: {{event: {other}, after: 0.4}}}}",
            f"{{cancel: {other}}}",
        )
    )


def _guard(random: Random, words: Words, depth: int = 2) -> str:
    if depth and random.random() < 0.4:
        if random.random() < 0.4:
            return f"{{not: {_guard(random, words, depth - 1)}}}"
        parts = ", ".join(_guard(random, words, depth - 1) for _ in range(random.randint(1, 3)))
        return f"{{{random.choice(['all', 'any'])}: [{parts}]}}"
    low = [f"{{use: battery_below, floor: {random.choice(FLOORS)}}}" for _ in range(2)]
    elapsed = f"{{use: elapsed, longer_than: {random.choice(['0.2', '0.6'])}}}"
    return random.choice(
        (
            *low,
            *((elapsed, "a", "b") if words.timed else ()),
            *(f"{{in: {state}}}" for state in words.asked),
            f"{{variable: {words.variable}, at_least: 2}}",
            "{hysteresis: {use: battery_below, floor: 0.5}, enter: 0.4, exit: 0.6}",
        )
    )


def requirements(random: Random) -> list[str]:
    """Return lines of random requirements, r0, r1 and so on."""

    def guard() -> str:
        return _guard(random, ALL, 1)

    def moment() -> str:
        entered = f"{{enter: {random.choice(STATES)}}}"
        return random.choice((entered, f"{{in: {random.choice(STATES)}}}", guard()))

    found = ["requirements:"]
    for number in range(3):
        scope = random.choice(("", "", f", after: {moment()}", f", while: {guard()}"))
        within = random.choice(("", "", ", within: 0.5"))
        answer = f"response: {{when: {moment()}, then: {moment()}{within}}}"
        pattern = random.choice(
            (
                f"never: {moment()}{within}",
                f"always: {guard()}{within}",
                f"existence: {moment()}{within}",
                f"precedence: {moment()}, before: {moment()}{within}",
                answer,
            )
        )
        found.append(f"  - {{name: r{number}, {pattern}{scope}}}")
    return found


def flight(random: Random, known: Sequence[str] = EVENTS) -> list[Seen]:
    """Return what a random flight of at most four seconds sees, with some known events."""
    found = []
    charge: float | None = 1.0
    flags: list[str] = []
    for _ in range(random.randint(10, 80)):
        if random.random() < 0.3:  # what is seen lasts for a while
            charge = random.choice(CHARGES)
        if random.random() < 0.3:
            flags = [each for each in FLAGS if random.random() < 0.25]
        events = [each for each in known if random.random() < 0.15]
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
