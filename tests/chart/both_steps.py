"""A step taken both ways: the short cut must do what the general step does, bit for bit."""

from __future__ import annotations

from missionkit.chart.semantics import quick_step, step
from missionkit.chart.semantics.chart_memory import ChartMemory, Decision
from missionkit.chart.semantics.compiled_chart import Chart
from missionkit.messages import Estimate
from missionkit.plugin_containment import Containment


def both(
    chart: Chart, memory: ChartMemory, seen: Estimate, contain: Containment
) -> tuple[ChartMemory, Decision]:
    """Return the outcome of a tick; fail if the two steps differ in anything, order included."""
    noted = len(contain.failures)
    quick = quick_step.decide(chart, memory, seen, contain)
    reference = Containment()
    general = step.decide(chart, memory, seen, reference)
    assert quick == general
    assert shown(quick) == shown(general)
    assert contain.failures[noted:] == reference.failures
    return quick


def shown(outcome: tuple[ChartMemory, Decision]) -> str:
    """Return what equality leaves open: the order of answers, the signs of zeros, types."""
    memory, decision = outcome
    return repr((memory, *decision._replace(moves=())))
