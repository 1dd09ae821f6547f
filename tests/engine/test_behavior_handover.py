"""Whose behaviour commands, and what the others remember meanwhile."""

from __future__ import annotations

from typing import Any, ClassVar

from rehearsed import short
from samples import calm
from typing_extensions import override

from missionkit.chart.plugin_catalogue import builtin
from missionkit.chart.semantics.quick_step import decide
from missionkit.engine.act import act
from missionkit.engine.behavior_handover import handed_over
from missionkit.engine.prepared_mission import begin, prepare
from missionkit.geometry import norm
from missionkit.messages import Action, Command, Estimate, Step, VehicleStatus
from missionkit.plugin import Behavior
from missionkit.plugin_containment import Containment


class Counting(Behavior):
    """Counts its own steps; done at three."""

    kind: ClassVar[str] = "counting"
    word: str

    @override
    def begin(self, seen: Estimate) -> int:
        return 0

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        count = int(memory) + 1
        events = (f"counted.{self.word}",) if count == 2 else ()
        return Step(note=f"{self.word} {count}", memory=count, done=count >= 3, events=events)


CATALOGUE = builtin().extended("behaviors", (Counting,))
CHART = """\
initial: outer
dwell: 0
states:
  outer:
    kind: custom
    behavior: {use: counting, word: outer}
    initial: alone
    transitions: [{to: pause, event: pause}, {to: moved, internal: true, event: move}]
    states:
      alone: {transitions: [{to: inner, event: in}], kind: logic}
      inner:
        kind: custom
        behavior: {use: counting, word: inner}
        transitions: [{to: alone, event: out}, {to: inner, event: again}]
      moved: {kind: logic}
      back: {history: deep, default: alone}
  pause:
    kind: logic
    transitions: [{to: back, event: resume}, {to: outer, event: restart}]
    entry: [{vehicle: disarm}]
  land: {kind: land}
"""


class Crew:
    """A chart and its behaviours; says who counted how far at each tick."""

    def __init__(self, chart: str = CHART) -> None:
        self.plan = prepare(short(chart, CATALOGUE), CATALOGUE)
        memory = begin(self.plan)
        self.chart, self.acting, self.contain = memory.chart, memory.acting, Containment()
        self.command = Command()
        self.now = 0.0

    def tick(self, *events: str, **changes: Any) -> str:
        self.now += 0.05
        before = self.chart.pilot
        seen = calm(now=self.now, events=(*events, *self.acting.events), **changes)
        self.chart, decision = decide(self.plan.chart, self.chart, seen, self.contain)
        if decision.entered:
            moves = decision.moves
            self.acting = handed_over(self.plan.chart, self.acting, before, self.chart.pilot, moves)
        seen = calm(now=self.now, state=self.chart.state, **changes)
        self.acting, self.command, step = act(
            self.plan, self.acting, seen, decision.orders, self.contain
        )
        return step.note

    def said(self, *events: str) -> list[str]:
        return [self.tick(*([event] if event else [])) for event in events]


def test_a_behaviour_lives_on_while_states_inside_change():
    assert Crew().said("", "", "move", "") == ["outer 1", "outer 2", "outer 3", "outer 4"]


def test_the_behaviour_around_pauses_while_one_inside_commands():
    notes = Crew().said("", "in", "", "out", "in", "again")
    assert notes == ["outer 1", "inner 1", "inner 2", "outer 2", "inner 1", "inner 1"]


def test_a_history_gives_the_memory_back():
    crew = Crew()
    assert crew.said("", "", "in", "", "") == [
        "outer 1",
        "outer 2",
        "inner 1",
        "inner 2",
        "inner 3",
    ]
    assert crew.acting.done
    assert crew.said("pause", "") == ["holding: no state commands"] * 2
    assert crew.acting.past.keys() == {"outer", "inner"}
    assert crew.said("resume") == ["inner 4"]
    assert crew.acting.past == {}
    assert crew.said("out") == ["outer 3"]


def test_without_the_history_everything_restarts():
    crew = Crew()
    crew.said("", "", "in", "", "pause")
    assert crew.said("restart", "in") == ["outer 1", "inner 1"]


def test_where_no_state_commands_the_vehicle_holds():
    crew = Crew()
    crew.said("", "pause")
    assert norm(crew.command.setpoint.velocity) == 0.0


def test_nothing_disarms_in_the_air():
    crew = Crew()
    crew.said("", "pause")
    assert crew.command.action is None
    on_ground = VehicleStatus(0.0, armed=True, in_air=False, ready=True, mode="hold")
    crew = Crew()
    crew.tick("pause", status=on_ground)
    assert crew.command.action is Action.DISARM


def test_a_behaviours_event_is_handled_at_the_next_tick():
    crew = Crew(CHART.replace("event: move}", "event: counted.outer}"))
    crew.said("", "")
    assert "moved" not in crew.chart.active
    assert crew.tick() == "outer 3"
    assert "moved" in crew.chart.active
