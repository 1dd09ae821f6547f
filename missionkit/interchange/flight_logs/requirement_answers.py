"""The requirements of a mission on a flight that missionkit did not fly.

Guards are asked of each estimate of the log. A log does not say which state a chart was in: what a
requirement says of states stays open.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from missionkit.chart.semantics.chart_memory import ChartMemory, begin
from missionkit.chart.semantics.compiled_chart import Chart, GuardContext
from missionkit.chart.semantics.requirement_monitor import MonitorMemory
from missionkit.chart.semantics.requirement_watch import RequirementResult, results, watched
from missionkit.chart.semantics.step import advance
from missionkit.messages import Estimate, Verdict
from missionkit.plugin_containment import Containment


@dataclass
class RequirementAnswers:
    """Asks the guards of the requirements, tick by tick."""

    chart: Chart
    contain: Containment = field(default_factory=Containment)
    memory: ChartMemory = field(init=False)
    monitors: tuple[MonitorMemory, ...] = field(init=False)

    def __post_init__(self) -> None:
        """Begin with nothing seen."""
        self.memory = begin(self.chart, 0.0)
        self.monitors = tuple(MonitorMemory() for _ in self.chart.watch.requirements)

    def of(self, seen: Estimate) -> tuple[tuple[str, Verdict], ...]:
        """Return what the guards say, and let the requirements see it."""
        memory, watch = self.memory, self.chart.watch
        question = GuardContext(seen, memory.windows, self.contain, memory.active, memory.variables)
        if self.chart.slots:
            advance(self.chart, question)
            self.memory = memory._replace(windows=tuple(question.windows))
        for _, ask in watch.guards:
            ask(question)
        self.monitors = tuple(
            watched(each, monitor, question.answers, seen.now)
            for each, monitor in zip(watch.requirements, self.monitors, strict=True)
        )
        self.contain.take()
        return tuple(question.answers.items())

    def results(self) -> tuple[RequirementResult, ...]:
        """Return what came of each requirement by the end of the log."""
        return results(self.chart.watch.requirements, self.monitors, over=True)
