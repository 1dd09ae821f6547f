"""Small charts, stepped by hand."""

from __future__ import annotations

from typing import Any, ClassVar

from both_steps import both
from samples import calm
from typing_extensions import override

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import Catalogue, builtin
from missionkit.chart.semantics.chart_compiler import compile_mission
from missionkit.chart.semantics.compiled_chart import Chart
from missionkit.chart.semantics.step import Decision, begin
from missionkit.messages import Estimate, Verdict
from missionkit.plugin import WindowGuard
from missionkit.plugin_containment import Containment
from studies.soundness_charts import Flag

TICK = 0.05


class Tally(WindowGuard):
    """Holds once an event of that name has come `count` times."""

    kind: ClassVar[str] = "tally"
    name: str
    count: int

    @override
    def begin(self) -> int:
        return 0

    @override
    def advance(self, memory: Any, seen: Estimate) -> int:
        return int(memory) + (self.name in seen.events)

    @override
    def check(self, memory: Any, seen: Estimate) -> Verdict:
        return Verdict.at_least(float(memory), float(self.count))


def with_flags() -> Catalogue:
    return builtin().extended("guards", (Flag, Tally))


CATALOGUE = with_flags()
HEAD = """\
missionkit: 1
mission: small
guards: {a: {use: flag, name: a}, b: {use: flag, name: b}, c: {use: flag, name: c}}
"""


def chart_of(text: str, catalogue: Catalogue = CATALOGUE, head: str = HEAD) -> Chart:
    return compile_mission(parse(head + text, "m.yaml", catalogue), catalogue)


class Walk:
    """A chart under way; `trace` keeps what fired as (time, from, to, reason)."""

    def __init__(self, chart: Chart | str, **always: Any) -> None:
        self.chart = chart_of(chart) if isinstance(chart, str) else chart
        self.memory = begin(self.chart, 0.0)
        self.always = always
        self.contain = Containment()
        self.count = 0
        self.trace: list[tuple[float, str, str, str]] = []
        self.problems: list[tuple[float, str]] = []

    @property
    def state(self) -> str:
        return self.memory.state

    def seen(self, *events: str, **changes: Any) -> Estimate:
        """Return the estimate of the next tick."""
        stands = {
            "now": (self.count + 1) * TICK,
            "state": self.memory.state,
            "entered_at": self.memory.entered_at,
        }
        return calm(events=events, **(stands | self.always | changes))

    def tick(self, *events: str, **changes: Any) -> Decision:
        seen = self.seen(*events, **changes)
        self.count += 1
        self.memory, decision = both(self.chart, self.memory, seen, self.contain)
        at = round(seen.now, 6)
        for fired in decision.fired:
            self.trace.append((at, fired.source, fired.to, fired.reason))
        self.problems += [(at, problem) for problem in decision.problems]
        return decision

    def run(self, until: float, *events: str, **changes: Any) -> None:
        """Tick up to and including mission time `until` (s)."""
        while (self.count + 1) * TICK <= until + 1e-9:
            self.tick(*events, **changes)

    def went(self) -> list[tuple[float, str]]:
        """When each state was entered."""
        return [(at, to) for at, _, to, _ in self.trace]
