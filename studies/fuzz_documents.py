"""Broken mission files: a family of generators, each the same document for the same seed."""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import yaml

Rng = np.random.Generator
ROOT = Path(__file__).parents[1]
LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
PIECES = [*"{}[]:,-&*!|>'\"%@`#\t\n $?~\0é\r\u2028\ufeff", ": ", "- ", "<<: ", "---\n", "...\n"]
VALUES: list[Any] = [
    *(None, True, -1, 0, 1e-300, 1e308, 2**70, float("nan"), float("inf"), "", "x", "$cruise"),
    *([], {}, [[1]], {"use": "x"}, {"all": []}, {"not": {"not": "done"}}, "yes", "1e3", "land"),
    *("../" * 9, "\0", "é" * 400, {"history": "deep"}, {"states": {}}, ["a"] * 50),
]
KEYS = [
    *("use", "all", "any", "not", "to", "when", "for", "after", "event", "do", "kind", "states"),
    *("initial", "parallel", "final", "history", "default", "entry", "exit", "guards", "params"),
    *("failsafes", "variables", "targets", "hysteresis", "enter", "variable", "in", "invariant"),
]
_WORD = re.compile(rb"(?<=[:,[] )[A-Za-z_][A-Za-z0-9_-]*")  # a value
_NUMBER = re.compile(rb"(?<![A-Za-z0-9_.])[0-9]+(?:\.[0-9]+)?")
_BLOCK = re.compile(rb"^```yaml\n(.*?)^```", re.MULTILINE | re.DOTALL)


@cache
def seeds() -> tuple[bytes, ...]:
    """Return what is broken: the missions of the project and of its pages, and broken ones."""
    pages = sorted([ROOT / "README.md", *(ROOT / "docs").rglob("*.md")])
    blocks = [block for page in pages for block in _BLOCK.findall(page.read_bytes())]
    examples = [block for block in blocks if block.startswith(b"missionkit:")]
    good = [*(path.read_bytes() for path in sorted((ROOT / "missions").glob("*.yaml"))), *examples]
    broken = sorted((ROOT / "tests" / "broken").glob("*.yaml"))
    return (*good * 30, *(path.read_bytes() for path in broken))


def document(family: str, seed: int, number: int) -> bytes:
    """Return document `number` of a family."""
    rng = np.random.default_rng([seed, number, sorted(FAMILIES).index(family)])
    return FAMILIES[family](rng)


def spliced(rng: Rng) -> bytes:
    """Return a mission with bytes cut out, doubled, swapped or put in."""
    data = bytearray(_one(rng, seeds()))
    for _ in range(int(rng.geometric(0.4))):
        at, end = sorted(int(i) for i in rng.integers(0, len(data) + 1, 2))
        end = min(end, at + int(rng.integers(0, 60)))
        put = _one(
            rng,
            [
                rng.bytes(int(rng.integers(1, 6))),
                str(_one(rng, PIECES)).encode(),
                bytes(data[at:end]) * int(rng.integers(1, 4)),
                b"",
            ],
        )
        data[at:end] = put
    return bytes(data)


def reworded(rng: Rng) -> bytes:
    """Return a mission in which names and numbers stand where others should."""
    data = _one(rng, seeds())
    for _ in range(int(rng.geometric(0.6))):
        words = list(_one(rng, [_WORD, _NUMBER]).finditer(data))
        if not words:
            continue
        old = words[int(rng.integers(len(words)))]
        new = words[int(rng.integers(len(words)))][0]
        data = data[: old.start()] + new + data[old.end() :]
    return bytes(data)


def restructured(rng: Rng) -> bytes:
    """Return a mission whose tree has branches cut, moved, doubled or of a wrong type."""
    tree = copy.deepcopy(_one(rng, _trees()))
    for _ in range(int(rng.geometric(0.5))):
        places = list(_places(tree))
        holder, key = places[int(rng.integers(len(places)))]
        other, from_key = places[int(rng.integers(len(places)))]
        match int(rng.integers(5)):
            case 0:
                holder[key] = copy.deepcopy(_one(rng, VALUES))
            case 1:
                holder[key] = copy.deepcopy(other[from_key])
            case 2:
                holder[key] = [holder[key]] * int(rng.integers(0, 4))
            case 3 if isinstance(holder, dict):
                holder[str(_one(rng, KEYS))] = holder.pop(key)
            case _:
                del holder[key]
    return _dumped(tree)


def rewired(rng: Rng) -> bytes:
    """Return a mission that reads well and flies badly: ways, guards and times at random."""
    names = [f"s{number}" for number in range(int(rng.integers(2, 14)))]
    states = {name: _state(rng, names) for name in names}
    states["land"] = {"kind": "land"}
    if rng.random() < 0.6:
        inner = names[1 + int(rng.integers(len(names) - 1)) :]
        held = {name: states.pop(name) for name in inner}
        states["group"] = {"states": held, "initial": inner[0], "transitions": [_way(rng, names)]}
    return _dumped(
        {
            "missionkit": 1,
            "mission": "rewired",
            "dwell": float(_one(rng, [0, 0.5, 2])),
            "variables": {"n": 0, "b": False},
            "targets": {"pole": {"position": [9, 0, -2]}},
            "failsafes": [
                {"name": f"f{i}", "when": _guard(rng, 2), "to": _one(rng, [*names, "land"])}
                for i in range(int(rng.integers(0, 4)))
            ],
            "initial": names[0],
            "states": states,
        }
    )


def _state(rng: Rng, names: Sequence[str]) -> dict[str, Any]:
    kind = _one(rng, ["idle", "gps", "hover", "custom", "return", "logic"])
    target = {"use": "go_to", "target": _one(rng, ["pole", "home"]), "height": 5}
    behavior = target if kind in {"gps", "return"} else "hold"
    state: dict[str, Any] = {
        "kind": kind,
        "transitions": [_way(rng, names) for _ in range(int(rng.integers(0, 5)))],
    }
    return state if kind == "logic" else {**state, "behavior": behavior}


def _way(rng: Rng, names: Sequence[str]) -> dict[str, Any]:
    way: dict[str, Any] = {"to": _one(rng, [*names, "land"])}
    if rng.random() < 0.8:
        way["when"] = _guard(rng, 3)
        if rng.random() < 0.4:
            way["for"] = float(_one(rng, [0, 0.5, 3, 100]))
    if "when" not in way or rng.random() < 0.3:
        way["after"] = float(_one(rng, [0, 1, 30]))
    if rng.random() < 0.1:
        way["event"] = _one(rng, ["go", "*", "done.state.group"])
    if rng.random() < 0.2:
        way["do"] = [{"assign": {"n": {"add": 1}}}]
    return way


def _guard(rng: Rng, depth: int) -> Any:
    form = int(rng.integers(9 if depth else 6))
    if form >= 6:
        inner = [_guard(rng, depth - 1) for _ in range(int(rng.integers(1, 5)))]
        return [{"all": inner}, {"any": inner}, {"not": inner[0]}][form - 6]
    floor = round(float(rng.random()), 2)
    return [
        "done",
        "link_lost",
        {"use": "battery_below", "floor": floor},
        {"use": "within", "of": "pole", "radius": 1 + 9 * floor},
        {"variable": "n", _one(rng, ["at_least", "below", "equals"]): int(rng.integers(0, 5))},
        {
            "hysteresis": {"use": "within", "of": "pole", "radius": 5},
            "enter": 4,
            "exit": 3 + 0.9 * floor,
        },
    ][form]


def punctuation(rng: Rng) -> bytes:
    """Return YAML's own signs in any order, with words between them."""
    words = [
        *PIECES,
        *KEYS,
        "a: ",
        "&x ",
        "*x",
        "\n  ",
        "\n    ",
        "!!int ",
        "? ",
        "|\n",
        "missionkit: 1\n",
    ]
    return "".join(str(_one(rng, words)) for _ in range(int(rng.integers(0, 400)))).encode()


def binary(rng: Rng) -> bytes:
    """Return bytes that mean nothing, sometimes after a good beginning."""
    head = _one(
        rng, [b"", b"missionkit: 1\nmission: m\n", b"\xef\xbb\xbf", b"\xff\xfe", b"states:\n"]
    )
    return bytes(head) + rng.bytes(int(rng.integers(0, 3000)))


def deep(rng: Rng) -> bytes:
    """Return something nested far too deep: lists, mappings, guards, states."""
    depth = int(_one(rng, [10, 40, 62, 63, 64, 65, 66, 300, 3000, 30_000]))
    opened, closed = _one(
        rng,
        [("[", "]"), ("{not: ", "}"), ("{all: [", "]}"), ("{a: ", "}"), ("{states: {s: ", "}}")],
    )
    core = (
        opened * depth + str(_one(rng, ["done", "1", ""])) + closed * int(rng.integers(depth + 1))
    )
    where = _one(rng, ["", "states: {x: ", "guards: {x: ", "params: {x: ", "failsafes: [{when: "])
    return f"missionkit: 1\nmission: m\ninitial: x\n{where}{core}".encode()


def aliased(rng: Rng) -> bytes:
    """Return anchors that multiply, lead into themselves or are merged."""
    levels, fan = int(rng.integers(1, 12)), int(rng.integers(1, 12))
    lines = ["a0: &a0 {to: land, when: done}"]
    opened, closed = _one(rng, ["[]", "{}"])
    for level in range(1, levels + 1):
        items = [f"k{i}: *a{level - 1}" if opened == "{" else f"*a{level - 1}" for i in range(fan)]
        lines.append(f"a{level}: &a{level} {opened}{', '.join(items)}{closed}")
    lines.append(
        _one(rng, ["r: &r [*r]", "r: &r {r: *r}", "<<: *a0", f"states: *a{levels}", "r: *no"])
    )
    order = rng.permutation(len(lines)) if rng.random() < 0.2 else range(len(lines))
    return "\n".join(["missionkit: 1", *(lines[int(i)] for i in order)]).encode()


def wide(rng: Rng) -> bytes:
    """Return very many states, ways, guards or letters."""
    count = int(rng.integers(50, 900))
    names = [f"s{i}" for i in range(count)]
    match int(rng.integers(4)):
        case 0:
            states: dict[str, Any] = {
                name: {"kind": "hover", "transitions": [_way(rng, names) for _ in range(2)]}
                for name in names
            }
        case 1:
            ways = [_way(rng, ["s0"]) for _ in range(count)]
            states = {"s0": {"kind": "hover", "transitions": ways}}
        case 2:
            both = {"any": [_guard(rng, 1) for _ in range(count // 4)]}
            ways = [{"to": "land", "when": both}, {"to": "s0", "when": {"not": both}}]
            states = {"s0": {"kind": "hover", "transitions": ways}}
        case _:
            states = {"s0": {"kind": "hover", "summary": "word " * 200 * count, "sumary": 1}}
    states["land"] = {"kind": "land"}
    head = {"missionkit": 1, "mission": "wide", "initial": "s0", "variables": {"n": 0, "b": False}}
    return _dumped({**head, "targets": {"pole": {"position": [9, 0, -2]}}, "states": states})


def _one(rng: Rng, choices: Sequence[Any]) -> Any:
    return choices[int(rng.integers(len(choices)))]


@cache
def _trees() -> tuple[dict[str, Any], ...]:
    trees = []
    for data in seeds():
        try:
            tree = yaml.load(data, LOADER)  # noqa: S506 - a safe one
        except (yaml.YAMLError, ValueError):
            continue
        if isinstance(tree, dict) and len(tree) > 3:
            trees.append(tree)
    return tuple(trees)


def _places(tree: Any) -> Iterator[tuple[Any, Any]]:
    """Yield every mapping or list with each of its keys."""
    keys = list(tree) if isinstance(tree, dict) else range(len(tree))
    for key in keys:
        yield tree, key
        if isinstance(tree[key], dict | list):
            yield from _places(tree[key])


def _dumped(tree: Any) -> bytes:
    return yaml.safe_dump(tree, sort_keys=False, allow_unicode=True).encode()


FAMILIES: Mapping[str, Callable[[Rng], bytes]] = {
    "spliced": spliced,
    "reworded": reworded,
    "restructured": restructured,
    "rewired": rewired,
    "punctuation": punctuation,
    "binary": binary,
    "deep": deep,
    "aliased": aliased,
    "wide": wide,
}
