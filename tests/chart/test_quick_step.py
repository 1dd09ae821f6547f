"""The short cut of the step: random charts with everything in them, and hostile names."""

from __future__ import annotations

import ast
import json
from pathlib import Path
from random import Random
from typing import Any, ClassVar

import numpy as np
import pytest
from both_steps import both
from samples import calm
from stepping import Flag, Tally
from typing_extensions import override

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.chart.semantics import step
from missionkit.chart.semantics.chart_compiler import compile_mission
from missionkit.chart.semantics.compiled_chart import Chart
from missionkit.chart.semantics.quick_step import begin
from missionkit.messages import Battery, Estimate, Goal, Target, VehicleStatus, Verdict
from missionkit.plugin import Guard
from missionkit.plugin_containment import Containment

Data = dict[str, Any]
TICKS = 40
CHARTS = 60


class Moody(Guard):
    """Fails, answers oddly or with numbers of numpy, as the battery's charge says."""

    kind: ClassVar[str] = "moody"

    @override
    def check(self, seen: Estimate) -> Verdict:
        charge = 0.5 if seen.battery is None else seen.battery.charge
        if charge < 0.2:
            raise ValueError("too low")
        if charge < 0.3:
            return Verdict.below(float("nan"), 0.5)
        if charge < 0.4:
            return Verdict(np.bool_(True), "", np.float64(charge), 0.5, 0.1)  # type: ignore[arg-type]
        return Verdict.above(charge, 0.9)


CATALOGUE = builtin().extended("guards", (Flag, Tally, Moody))
LEAVES: tuple[Any, ...] = (
    *({"use": "battery_below", "floor": each} for each in (0.3, 0.6)),
    *({"use": "elapsed", "longer_than": each} for each in (0.2, 0.5)),
    {"use": "link_lost", "longer_than": 0.3},
    {"use": "gnss_lost", "longer_than": 5.0},
    {"use": "within", "of": "pole", "radius": 4.0},
    {"use": "near_goal", "radius": 3.0},
    {"use": "target_seen", "target": "pole"},
    {"use": "converged"},
    {"use": "ready"},
    "done",
    "moody",
    {"use": "tally", "name": "a", "count": 2},
    {"use": "goal_unreachable", "longer_than": 0.3},
    {"hysteresis": {"use": "battery_below", "floor": 0.5}, "enter": 0.1, "exit": 0.0},
    {"variable": "n", "at_least": 2},
    {"in": "in0"},
    "named",
)
STATES = ("s0", "s1", "s2", "s3", "in0", "in1", "left", "right", "home")


class Writer:
    """One random mission."""

    def __init__(self, pick: Random) -> None:
        self.pick = pick
        self.plain = pick.random() < 0.4  # the package's own guards alone, and nothing else

    def guard(self, depth: int = 2) -> Any:
        if self.plain:
            return self.pick.choice(LEAVES[:12])
        form = self.pick.choice(("leaf", "leaf", "leaf", "all", "any", "not"))
        if form == "leaf" or depth == 0:
            return self.pick.choice(LEAVES)
        if form == "not":
            return {"not": self.guard(depth - 1)}
        return {form: [self.guard(depth - 1) for _ in range(2)]}

    def transition(self) -> Data:
        chosen: Data = {"to": self.pick.choice(STATES)}
        form = self.pick.choice(("when", "when", "when", "after", "for", "event", "event", "do"))
        if form == "after":
            return chosen | {"after": self.pick.choice((0.3, 1.0))}
        chosen["when"] = self.guard()
        if form == "for":
            chosen["for"] = 0.15
        elif form == "event":
            chosen["event"] = self.pick.choice(("a", "late", ["a.b", "b"], "*"))
            if self.pick.random() < 0.6:
                del chosen["when"]
        elif form == "do" and not self.plain:
            acts = [
                {"assign": {"n": {"add": 1}}},
                {"raise": {"event": "late", "after": 0.2}},
                {"raise": "a"},
                {"log": "hello"},
            ]
            chosen["do"] = [self.pick.choice(acts)]
        return chosen

    def state(self, **others: Any) -> Data:
        made: Data = {"kind": "custom", "behavior": "hold", **others}
        made["transitions"] = [self.transition() for _ in range(self.pick.randint(0, 3))]
        if not self.plain and "states" not in made and self.pick.random() < 0.15:
            made["invariant"] = {"holds": self.guard(1), "exit": "home"}
        return made

    def mission(self) -> Data:
        wild = not self.plain
        inner = {"in0": self.state(), "in1": self.state()}
        if wild:
            inner["back"] = {"history": "shallow", "default": "in1"}
        beside = {"left": self.state(), "right": {**self.state(), "kind": "logic"}}
        del beside["right"]["behavior"]
        states = {
            "s0": self.state(),
            "s1": self.state(),
            "s2": {**self.state(initial="in0", states=inner), "kind": "logic"},
            "s3": {**self.state(parallel=True, states=beside), "kind": "logic"},
            "home": {
                "kind": "return",
                "behavior": {"use": "go_to", "target": "home", "height": 5},
                "transitions": [{"to": "land", "when": "done"}],
            },
            "land": {"kind": "land"},
        }
        for name in ("s2", "s3"):
            states[name].pop("behavior")
        made: Data = {
            **{"missionkit": 1, "mission": "random", "dwell": self.pick.choice((0, 0.1))},
            **{"variables": {"n": {"initial": 0, "max": 3}}, "initial": "s0"},
            "targets": {"pole": {"position": [3, 0, 0]}},
            "guards": {"named": {"any": ["done", {"use": "battery_below", "floor": 0.4}]}},
            "states": states,
        }
        if self.pick.random() < 0.6:
            made["failsafes"] = [self.failsafe(number) for number in range(self.pick.randint(1, 2))]
        if wild and self.pick.random() < 0.4:
            made["requirements"] = [
                {"name": "one", "never": {"in": "s1"}, "while": self.guard(0)},
                {
                    "name": "two",
                    "always": self.guard(0),
                    "broken": {"to": "home", "after": 0.2},
                },
            ]
        return made

    def failsafe(self, number: int) -> Data:
        rare = {"use": "battery_below", "floor": 0.15}
        guard = rare if self.pick.random() < 0.6 else self.guard(1)
        made: Data = {"name": f"f{number}", "when": guard, "to": self.pick.choice(("home", "land"))}
        made["unknown"] = self.pick.choice(("take", "ignore"))
        return made if self.pick.random() < 0.6 else made | {"for": 0.2}


class Sky:
    """What a vehicle sees, drifting at random."""

    def __init__(self, pick: Random) -> None:
        self.pick = pick
        self.charge, self.heard, self.at = 0.9, 0.0, np.zeros(3)

    def seen(self, now: float, **stands: Any) -> Estimate:
        pick = self.pick
        if pick.random() < 0.1:
            self.charge = pick.choice((0.1, 0.25, 0.35, 0.45, 0.55, 0.8, 1.0, float("nan")))
        if pick.random() < 0.8:
            self.heard = now
        self.at = self.at + np.array([pick.gauss(0.0, 0.5), 0.0, 0.0])
        flying = pick.random() < 0.8
        status = VehicleStatus(self.heard, flying, flying, True, "offboard")
        battery = Battery(now, self.charge, 16.0)
        goal = Goal(np.array([1.0, 0.0, 0.0]), None, now)
        pole = Target("pole", np.array([3.0, 0.0, 0.0]), 0.1, None, None, now - 1.0)
        return calm(
            now=now,
            position=self.at,
            battery=battery if pick.random() < 0.95 else None,
            status=status if pick.random() < 0.95 else None,
            targets={"pole": pole} if pick.random() < 0.95 else {},
            events=self.events(),
            failing=("x",) if pick.random() < 0.03 else (),
            done=pick.random() < 0.2,
            goal=goal if pick.random() < 0.8 else None,
            **stands,
        )

    def events(self) -> tuple[str, ...]:
        """Events of one tick: none, one or several, heard or not; seldom an abort."""
        if self.pick.random() < 0.6:
            return ()
        some = self.pick.choices(("a", "a.b", "late", "b"), k=self.pick.randint(1, 3))
        return (*some, "abort") if self.pick.random() < 0.03 else tuple(some)


def compared(seed: int, ticks: int) -> int:
    """Step a random chart both ways; return how often it moved."""
    pick = Random(seed)  # noqa: S311
    chart, sky, moved = chart_of(Writer(pick).mission()), Sky(pick), 0
    memory, contain = begin(chart, 0.0), Containment()
    for tick in range(1, ticks + 1):
        seen = sky.seen(tick * 0.05, state=memory.state, entered_at=memory.entered_at)
        memory, decision = both(chart, memory, seen, contain)
        moved += bool(decision.moves)
    return moved


def chart_of(document: Data) -> Chart:
    return compile_mission(parse(json.dumps(document), "random.yaml", CATALOGUE), CATALOGUE)


def test_the_short_cut_does_what_the_general_step_does():
    assert sum(compared(seed, TICKS) for seed in range(CHARTS)) > CHARTS


HOSTILE = (
    'x"; raise SystemExit #',
    "{answers[0]}",
    "__import__('os')",
    "%s%n",
    "a\\n'b\n",
    "ünï☃",
)


@pytest.mark.parametrize("text", HOSTILE)
@pytest.mark.parametrize("name", ["import", "lambda", "exec", "x0", "None"])
def test_what_a_mission_says_is_never_more_than_text(name, text):
    low: Data = {"use": "battery_below", "floor": 0.5}
    lead: Data = {"name": name, "to": name, "when": name, "do": [{"log": text}]}
    states = {
        "s0": {"kind": "custom", "behavior": "hold", "transitions": [lead]},
        name: {"kind": "custom", "behavior": "hold", "transitions": [{"to": "land", "when": name}]},
        "land": {"kind": "land"},
    }
    chart = chart_of(
        {
            **{"missionkit": 1, "mission": "hostile", "initial": "s0", "dwell": 0},
            **{"guards": {name: low}, "states": states},
            "failsafes": [{"name": name, "when": {"use": "link_lost"}, "to": "land"}],
        }
    )
    memory = begin(chart, 0.0)
    for tick, charge in enumerate((0.9, 0.9, 0.4), 1):
        seen = calm(now=tick * 0.05, battery=Battery(0.0, charge, 16.0))
        memory, decision = both(chart, memory, seen, Containment())
    assert decision.answers[name].value == 0.4
    assert [fired.to for fired in decision.fired] == [name, "land"]
    assert f"log {text}" in decision.fired[0].outputs


def test_no_code_is_made_while_a_mission_is_loaded_or_flown():
    makers = {"exec", "eval", "compile", "__import__"}
    for file in Path(step.__file__).parent.glob("*.py"):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        called = {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
        assert not makers & called, file.name
