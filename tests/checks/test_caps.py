"""However large or odd a mission is, it gets its findings, always the same, in bounded work."""

from __future__ import annotations

import random
from pathlib import Path
from typing import ClassVar

import pytest
from typing_extensions import override

from missionkit.chart import checks
from missionkit.chart.checks import findings, landing_guarantee
from missionkit.chart.load import load, parse
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.errors import FileError
from missionkit.messages import Estimate, Verdict
from missionkit.plugin import Guard

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "missions" / "precision_task.yaml"
HEAD = "missionkit: 1\nmission: large\n"
END = "  land: {kind: land}\n"


class Flag(Guard):
    kind: ClassVar[str] = "flag"
    name: str

    @override
    def check(self, seen: Estimate) -> Verdict:
        return Verdict(self.name in seen.events)


def chain(count: int) -> str:
    lines = [HEAD, "initial: s0\nstates:\n"]
    for at in range(count):
        to = f"s{at + 1}" if at + 1 < count else "land"
        guard = f"{{use: battery_below, floor: 0.{at % 9 + 1}}}"
        lines.append(
            f"  s{at}: {{kind: custom, transitions: [{{to: land, when: {guard}}}, "
            f"{{to: {to}, when: plugin_failed}}, {{to: {to}, after: 9}}]}}\n"
        )
    return "".join([*lines, END])


def codes(text: str, catalogue: Catalogue) -> list[str]:
    return [problem.code for problem in findings(parse(text, "m.yaml", catalogue), catalogue)]


@pytest.mark.parametrize("path", sorted(EXAMPLE.parent.glob("*.yaml")), ids=lambda it: it.name)
def test_missions_of_the_project_have_nothing_wrong(path, catalogue):
    assert findings(load(path, catalogue), catalogue) == []


def test_a_thousand_states(catalogue):
    assert codes(chain(1000), catalogue) == []


@pytest.mark.parametrize(("do", "unproven"), [("", False), (", do: [{raise: e%d}]", True)])
def test_a_hundred_regions_are_proved_unless_they_depend_on_each_other(do, unproven, catalogue):
    regions = "".join(
        f"      r{at}:\n        initial: a{at}\n        states:\n"
        f"          a{at}: {{kind: logic, transitions: [{{to: b{at}, event: e{at}"
        f"{do and do % (at + 1)}}}]}}\n"
        f"          b{at}: {{kind: logic}}\n"
        for at in range(100)
    )
    text = (
        f"{HEAD}initial: work\nstates:\n  work:\n    kind: custom\n    parallel: true\n"
        f"    transitions: [{{to: land, after: 9}}]\n    states:\n{regions}{END}"
    )
    found = codes(text, catalogue)
    assert ("unproven" in found) is unproven
    assert not {"never-fires", "unreachable-state"} & set(found)


def test_guards_built_on_guards_do_not_explode(catalogue):
    named = "".join(
        f"  g{at}: {{any: [{{all: [g{at - 1}, a{at}]}}, {{not: {{all: [g{at - 1}, b{at}]}}}}]}}\n"
        for at in range(1, 40)
    )
    flags = "".join(
        f"  {word}{at}: {{use: flag, name: {word}{at}}}\n" for at in range(1, 40) for word in "ab"
    )
    text = (
        f"{HEAD}guards:\n  g0: done\n{flags}{named}initial: up\nstates:\n"
        "  up: {kind: custom, transitions: [{to: land, when: g39}, {to: land, after: 5}]}\n" + END
    )
    assert "never-true" not in codes(text, catalogue.extended("guards", (Flag,)))


def test_many_transitions_in_one_state_are_not_all_compared(catalogue, monkeypatch):
    monkeypatch.setattr(checks.shadowed_transitions, "MOST_COMPARED", 100)
    ways = ", ".join(
        f"{{to: land, when: {{use: within, of: t, radius: {n}}}}}" for n in range(1, 50)
    )
    text = (
        f"{HEAD}targets: {{t: {{position: [0, 0, -5]}}}}\ninitial: up\nstates:\n"
        f"  up: {{kind: custom, transitions: [{ways}]}}\n{END}"
    )
    assert codes(text, catalogue).count("too-many-to-compare") == 1


def test_the_same_file_gives_the_same_findings(catalogue):
    path = ROOT / "tests" / "checks" / "11-contradictory-timers.yaml"
    first, second = (findings(load(path, catalogue), catalogue) for _ in range(2))
    assert first == second != []
    assert first == sorted(first, key=lambda it: (it.place.line, it.place.column, it.code))


def mutated(text: str, dice: random.Random) -> str:
    """Return a mission with values exchanged between its lines, so that many still load."""
    lines = text.splitlines()
    for _ in range(dice.randint(1, 3)):
        at, other = dice.randrange(len(lines)), dice.randrange(len(lines))
        what = dice.choice(("drop", "double", "swap", "number"))
        if what == "drop":
            lines[at] = ""
        elif what == "double":
            lines.insert(at, lines[at])
        elif what == "swap":
            lines[at], lines[other] = lines[other], lines[at]
        else:
            new = dice.choice(("0", "1", "0.5", "1000000"))
            lines[at] = lines[at].replace(dice.choice("0123456789"), new)
    return "\n".join(lines)


def test_mutated_missions_are_refused_or_checked(catalogue):
    text, checked = EXAMPLE.read_text(), 0
    for seed in range(24):
        try:
            mission = parse(mutated(text, random.Random(seed)), "m.yaml", catalogue)  # noqa: S311
        except FileError:
            continue
        findings(mission, catalogue)
        checked += 1
    assert checked > 2


def test_bounds_are_the_timers_on_the_way(catalogue):
    found = {
        (it.danger, it.state): it.seconds
        for it in landing_guarantee.escapes(load(EXAMPLE, catalogue), catalogue)
    }
    assert found["link", "gps"] == 3.0
    assert found["position", "task"] == 1.0
    assert found["plug-in", "search"] == 3.0
    # lost for 2 s, searched for 30 s, 120 s on the way to the trunk, 20 s of hovering there
    assert found["camera", "visual"] == pytest.approx(172.0)
