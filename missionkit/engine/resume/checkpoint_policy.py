"""When a flight is saved, and what of it: plug-ins may remember what cannot be written down."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from enum import Enum
from typing import Any

from missionkit.chart.semantics.compiled_chart import Chart
from missionkit.engine.flight_state import (
    BehaviorState,
    FlightMemory,
    FlightState,
    PausedBehavior,
)
from missionkit.messages import Record

Fits = Callable[[Any], bool]
Save = Callable[[FlightState, tuple[str, ...]], None]  # with a sentence for each part left out

CHECKPOINT_PERIOD = 1.0 - 1e-6  # s of mission time between two checkpoints


class StartsAgain(Enum):
    """Stands for a memory that was not saved."""

    BEGIN = "restart"


def now_and_then(chart: Chart, fits: Fits, save: Save) -> Callable[[FlightState, Record], None]:
    """Return what saves a flight at every transition and once a second.

    Args:
        chart: that is flown.
        fits: says whether a value can be saved.
        save: writes a course down, fit to be saved.
    """
    last = -math.inf

    def keep(course: FlightState, record: Record) -> None:
        nonlocal last
        if not record.fired and record.now - last < CHECKPOINT_PERIOD:
            return
        last = record.now
        memory, lost = keepable(chart, course.memory, fits)
        save(course._replace(memory=memory), lost)

    return keep


def keepable(
    chart: Chart, memory: FlightMemory, fits: Fits
) -> tuple[FlightMemory, tuple[str, ...]]:
    """Return the memory without what cannot be saved, and a sentence for each part left out.

    Args:
        chart: whose memory it is.
        memory: as the tick left it.
        fits: says whether a value can be saved.
    """
    acting, lost = _hands(chart, memory, fits)
    windows = tuple(each if fits(each) else StartsAgain.BEGIN for each in memory.chart.windows)
    for slot, window in zip(chart.slots, windows, strict=True):
        if window is StartsAgain.BEGIN:
            lost.append(f"the memory of {slot.name} cannot be saved: it will restart on resume")
    senses = memory.senses
    if not fits(senses.tracking):
        senses = senses._replace(tracking=None)
        lost.append("the memory of the tracker cannot be saved: it will restart on resume")
    chart_memory = memory.chart._replace(windows=windows)
    return memory._replace(acting=acting, chart=chart_memory, senses=senses), tuple(lost)


def _hands(chart: Chart, memory: FlightMemory, fits: Fits) -> tuple[BehaviorState, list[str]]:
    acting, lost = memory.acting, []
    paused, past = _fitting(acting.paused, fits), _fitting(acting.past, fits)
    gone = [*(acting.paused.keys() - paused.keys()), *(acting.past.keys() - past.keys())]
    if not fits(acting.behavior):
        gone.append(memory.chart.state)
        acting = acting._replace(behavior=None, begun=False, done=False, goal=None)
    for name in sorted(gone):
        behavior = chart.states[name].behavior
        what = name if behavior is None else behavior.kind
        lost.append(f"the memory of {what} in {name} cannot be saved: it will restart on resume")
    return acting._replace(paused=paused, past=past), lost


def _fitting(kept: Mapping[str, PausedBehavior], fits: Fits) -> dict[str, PausedBehavior]:
    return {name: paused for name, paused in kept.items() if fits(paused.behavior)}
