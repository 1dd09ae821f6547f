"""The requirements of a mission on the record of any flight, of this mission or another.

A record holds the answers of every guard that was asked in flight, ten times a second and whenever
one changed. A requirement made of other guards stays open. Which state was active and which was
entered is read from the states and transitions where no guard says so.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from missionkit.chart.semantics.compiled_chart import Chart, Shape
from missionkit.chart.semantics.requirement_monitor import MonitorMemory
from missionkit.chart.semantics.requirement_watch import RequirementResult, results, watched
from missionkit.messages import Verdict
from missionkit.recorder.checkpoint import NEWEST
from missionkit.recorder.record_reader import read

HOLDS: Mapping[str, bool | None] = {"yes": True, "no": False, "unknown": None}


class CheckedRecord(NamedTuple):
    """What a record says of the requirements."""

    results: tuple[RequirementResult, ...]
    missing: tuple[str, ...]  # guards that the record never answers
    ended: bool  # the flight, as far as the record shows


def check_record(chart: Chart, path: Path) -> CheckedRecord:
    """Return what came of each requirement of a chart in a recorded flight.

    Args:
        chart: compiled, with requirements.
        path: the `flight.mcap` of a run. Beside a checkpoint it is of a flight that has not ended:
            what has not happened there may still do so.

    Raises:
        UsageError: it is not a flight record.
    """
    watch, standing = chart.watch, _Standing(chart)
    monitors = tuple(MonitorMemory() for _ in watch.requirements)
    unanswered = {name for name, _ in watch.guards}
    for entry in read(path, "/state", "/transitions", "/guards"):
        if entry.topic != "/guards":
            standing.note(entry.topic, entry.data)
            continue
        answers = {**standing.answers(), **_answers(entry.data)}
        unanswered -= answers.keys()
        monitors = tuple(
            watched(each, monitor, answers, entry.at)
            for each, monitor in zip(watch.requirements, monitors, strict=True)
        )
    ended = not (path.parent / NEWEST).exists()
    found = results(watch.requirements, monitors, over=ended)
    return CheckedRecord(found, tuple(sorted(unanswered)), ended)


def _answers(data: Mapping[str, Any]) -> dict[str, Verdict]:
    return {
        it["name"]: Verdict(
            HOLDS[it["holds"]],
            it.get("why", ""),
            it.get("value"),
            it.get("threshold"),
            it.get("margin"),
        )
        for it in data["guards"]
    }


class _Standing:
    """Where the chart stood, as the record shows it."""

    def __init__(self, chart: Chart) -> None:
        self.chart = chart
        self.parallel = any(state.shape is Shape.PARALLEL for state in chart.states.values())
        self.active: frozenset[str] = frozenset()
        self.entered: set[str] = set()

    def note(self, topic: str, data: Mapping[str, Any]) -> None:
        """Take in a transition or the state that commands."""
        if topic == "/transitions":
            for name in data["to"].split(", "):
                self.entered |= self._around(name) - self.active
                self.entered.add(name)
            return
        active = self._around(data["state"])
        self.entered |= active - self.active
        self.active = active

    def answers(self) -> dict[str, Verdict]:
        """Return what is known of states; entries since the last call."""
        known = dict(self._in())
        for name, state in self.chart.watch.entries:
            holds = True if state in self.entered else None if self.parallel else False
            known[name] = Verdict(holds)
        self.entered = set()
        return known

    def _in(self) -> Iterator[tuple[str, Verdict]]:
        for name, state in self.chart.watch.states:
            if state in self.active:
                yield name, Verdict(holds=True)
            elif not self.parallel:
                yield name, Verdict(holds=False)

    def _around(self, name: str) -> frozenset[str]:
        state = self.chart.states.get(name)
        return frozenset((name,)) if state is None else frozenset((name, *state.ancestors))
