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
    assert repr(quick) == repr(general)
    assert quick == general
    assert contain.failures[noted:] == reference.failures
    return quick
