"""Random charts of nested states, as the documents of missions."""

from __future__ import annotations

from collections.abc import Iterator
from random import Random
from typing import Any

Data = dict[str, Any]
Lines = dict[str, tuple[str, ...]]  # state -> the states around it, the innermost first

DEPTH = 3
EVENTS = ("a", "b", "a.b", "c.d.e")
DESCRIPTORS = (*EVENTS * 4, *("a.*", "c.d", "c.", "r", "r.x", "r.y", "done.state", "*"))
WITHOUT_END = {"r", "r.x", "r.y", "done.state", "*"}  # what a transition may bring about itself
COUNT: Data = {"assign": {"count": {"add": 1}}}
RAISED = ("r", "r.x", "r.y")


def random_chart(pick: Random) -> Data:
    """Return a legal document."""
    states = _Builder(pick).states(DEPTH, alone=True)
    writer = _Writer(pick, states)
    writer.write()
    return {
        "missionkit": 1,
        "mission": "random",
        "dwell": 0,
        "variables": {"count": 0},
        "initial": writer.start(None),
        "states": states,
    }


def walk(states: Data) -> Iterator[tuple[str, Data]]:
    """Yield every state in document order."""
    for name, data in states.items():
        yield name, data
        yield from walk(data.get("states", {}))


def lines(states: Data, around: tuple[str, ...] = ()) -> Lines:
    """Return the states around each state."""
    found: Lines = {}
    for name, data in states.items():
        found[name] = around
        found |= lines(data.get("states", {}), (name, *around))
    return found


class _Builder:
    """The tree alone."""

    def __init__(self, pick: Random) -> None:
        self.pick = pick
        self.count = 0

    def states(self, depth: int, *, alone: bool) -> Data:
        """Return the states inside a compound one; `alone`: they may have behaviours."""
        inside: Data = {}
        for _ in range(self.pick.randint(1, 3)):
            inside |= self.state(depth - 1, alone=alone)
        if depth < DEPTH:
            inside |= self.histories()
        if self.pick.random() < (0.5 if depth < DEPTH else 0.1):
            inside[self.name("f")] = {"final": True}
        return inside

    def state(self, depth: int, *, alone: bool) -> Data:
        data: Data = {"kind": "logic"}
        name = self.name("s")
        shape = self.pick.choice(("atomic", "compound", "parallel"))
        if depth <= 0:
            shape = "atomic"
        if alone and self.pick.random() < 0.3:
            data["behavior"] = "hold"
        if shape == "compound":
            data["states"] = self.states(depth, alone=alone)
        elif shape == "parallel":
            data |= {"parallel": True, "states": self.regions(depth, alone=alone)}
        return {name: data}

    def regions(self, depth: int, *, alone: bool) -> Data:
        inside: Data = {}
        for at in range(self.pick.randint(2, 3)):
            inside |= self.state(depth - 1, alone=alone and at == 0)
        return inside | self.histories()

    def histories(self) -> Data:
        if self.pick.random() < 0.5:
            return {}
        return {self.name("h"): {"history": self.pick.choice(("shallow", "deep"))}}

    def name(self, letter: str) -> str:
        self.count += 1
        return f"{letter}{self.count}"


class _Writer:
    """All that names other states: beginnings, transitions, actions."""

    def __init__(self, pick: Random, states: Data) -> None:
        self.pick = pick
        self.lines = lines(states)
        self.all = dict(walk(states))

    def write(self) -> None:
        for name, data in self.all.items():
            if "history" in data:
                data["default"] = self.start(self.lines[name][0], histories=False)
                continue
            data |= {"entry": self.actions(), "exit": self.actions()}
            if "final" not in data:
                data["transitions"] = [self.transition() for _ in range(self.pick.randint(0, 3))]
            if "states" in data and "parallel" not in data:
                data["initial"] = self.start(name)

    def start(self, around: str | None, *, histories: bool = True) -> Data:
        fit = [
            name
            for name, line in self.lines.items()
            if (around is None or around in line) and (histories or "history" not in self.all[name])
        ]
        return {"to": self.together(fit), "do": self.actions()}

    def together(self, names: list[str]) -> list[str]:
        """Return one of the states, or two that can be active together."""
        first = self.pick.choice(names)
        partners = [name for name in names if self.orthogonal(first, name)]
        if partners and self.pick.random() < 0.5:
            return [first, self.pick.choice(partners)]
        return [first]

    def orthogonal(self, one: str, other: str) -> bool:
        """Say whether two states are in two regions; a history stands for the state around it."""
        one, other = self.place(one), self.place(other)
        here, there = (one, *self.lines[one]), (other, *self.lines[other])
        common = next((name for name in here if name in there), None)
        return common not in {None, one, other} and "parallel" in self.all[str(common)]

    def place(self, name: str) -> str:
        return self.lines[name][0] if "history" in self.all[name] else name

    def transition(self) -> Data:
        data: Data = {"internal": self.pick.random() < 0.3, "do": self.actions()}
        if self.pick.random() < 0.85:
            data["event"] = self.pick.choices(DESCRIPTORS, k=self.pick.choice((1, 1, 2)))
        if self.pick.random() < 0.4:
            data["when"] = self.condition()
        if not WITHOUT_END.isdisjoint(data.get("event", WITHOUT_END)) and self.pick.random() < 0.95:
            enough = {"variable": "count", "at_least": self.pick.randint(1, 12)}
            data |= {"when": {"not": enough}, "do": [*data["do"], COUNT]}
        if "event" not in data and "when" not in data:
            data["after"] = 0
        if self.pick.random() < 0.85 or not data["do"]:
            data["to"] = self.together(list(self.all))
        return data

    def condition(self) -> Data:
        names = [name for name, data in self.all.items() if "history" not in data]
        inside = {"in": self.pick.choice(names)}
        counted = {"variable": "count", "at_least": self.pick.randint(1, 5)}
        return self.pick.choice((inside, {"not": inside}, counted, {"not": counted}))

    def actions(self) -> list[Data]:
        return [self.action() for _ in range(self.pick.choice((0, 0, 1, 2)))]

    def action(self) -> Data:
        return self.pick.choice((self.log(), COUNT, COUNT, {"raise": self.pick.choice(RAISED)}))

    def log(self) -> Data:
        return {"log": f"said-{self.pick.randint(0, 10**6)}"}
