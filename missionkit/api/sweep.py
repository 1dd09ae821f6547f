"""At which values of a parameter a recorded flight would have decided differently."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from missionkit.api.missions import NO_SETTINGS, LoadedMission
from missionkit.api.recorded_mission import mission_flown
from missionkit.api.replay import journal_from_start
from missionkit.api.transition_change import ReplayedChart, replayed_chart
from missionkit.api.what_if import plain_section
from missionkit.chart.model.mission import Mission
from missionkit.chart.semantics.chart_compiler import compile_mission
from missionkit.engine.prepared_mission import prepare
from missionkit.errors import FileError, UsageError, nearest
from missionkit.messages import Fired
from missionkit.recorder.journal_reader import Journal
from missionkit.replays.chart_replay import first_difference
from missionkit.replays.decision_sweep import (
    AS_FLOWN,
    DecisionAt,
    SweptPart,
    decision_at,
    difference,
    swept,
)
from missionkit.replays.replayed_flight import replayed

CHART_SECTIONS = frozenset(("guards", "failsafes", "states", "requirements", "params", "dwell"))


class Sweep(NamedTuple):
    """The decisions of a flight over a range of a parameter.

    Attributes:
        journal: file of the flight.
        parameter: its name.
        flown: its value in flight.
        parts: of the range, in each of which the flight decides the same.
        notes: sentences: what of this does not hold.
    """

    journal: Path
    parameter: str
    flown: float
    parts: tuple[SweptPart, ...]
    notes: tuple[str, ...]


class _Flight(NamedTuple):
    journal: Journal
    mission: LoadedMission
    chart: ReplayedChart
    fired: tuple[Fired, ...]


def sweep(
    run: str | Path,
    parameter: str,
    low: float,
    high: float,
    *,
    settings: Mapping[str, object] = NO_SETTINGS,
    plugins: Sequence[str | Path] = (),
) -> Sweep:
    """Find the values of a parameter at which a recorded flight would have decided differently.

    Args:
        run: folder of a run, or a journal. Of a resumed flight the first part counts.
        parameter: a number among the mission's `params`.
        low: begin of the range.
        high: its end.
        settings: values of other parameters that differ from those of the flight.
        plugins: plug-in files that the mission uses.

    Raises:
        FileError: the mission cannot be used by this version of missionkit.
        UsageError: there is no journal, no such parameter, or the range is empty.
    """
    journal = journal_from_start(run)
    files = [Path(it) for it in plugins]
    with tempfile.TemporaryDirectory() as folder:
        mission = mission_flown(journal, Path(folder), files)
        value = _parameter(mission, parameter)
        if not low < high:
            raise UsageError(f"{parameter}={low:g}:{high:g}: the range is empty")
        whole = isinstance(value, int)
        chart = replayed_chart(mission, journal)
        fired = tuple(it for tick in chart.ticks for it in tick.fired)
        flight = _Flight(journal, mission, chart, fired)

        def decide(tried: float) -> DecisionAt:
            given = {**settings, parameter: int(tried) if whole else tried}
            return _decided(flight, lambda: _loaded(journal, given, files))

        parts = swept(decide, low, high, whole=whole)
    return Sweep(
        journal.path, parameter, value, tuple(parts), (journal.ends,) if journal.ends else ()
    )


def _parameter(mission: LoadedMission, name: str) -> float:
    if name not in mission.parameters:
        raise UsageError(f"{name}: no such parameter; {nearest(name, mission.parameters)}")
    value = mission.parameters[name]
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise UsageError(f"{name}: a sweep needs a number, and it is {value!r}")
    return value


def _loaded(
    journal: Journal, settings: Mapping[str, object], plugins: Sequence[Path]
) -> LoadedMission:
    with tempfile.TemporaryDirectory() as folder:
        return mission_flown(journal, Path(folder), plugins, settings)


def _decided(flight: _Flight, load: Callable[[], LoadedMission]) -> DecisionAt:
    try:
        other = load()
    except FileError as error:
        return DecisionAt(f"cannot be flown: {error.problems[0].message}")
    if not _chart_only(flight.mission.model, other.model):
        plan = prepare(other.model, other.catalogue)
        return decision_at(replayed(plan, flight.journal), flight.fired)
    chart = compile_mission(other.model, other.catalogue)
    found = first_difference(chart, flight.chart.ticks)
    if found is None:
        return DecisionAt(AS_FLOWN)
    return DecisionAt(difference(found.fired, found.flown, flight.fired), found.now)


def _chart_only(one: Mission, other: Mission) -> bool:
    """Say whether two missions differ in guards and times alone: estimates stay as they were."""
    sections = (name for name in type(one).model_fields if name not in CHART_SECTIONS)
    alike = all(
        plain_section(getattr(one, name)) == plain_section(getattr(other, name))
        for name in sections
    )
    behaviors = [
        {it.name: (it.state.kind, plain_section(it.state.behavior)) for it in mission.walk()}
        for mission in (one, other)
    ]
    return alike and behaviors[0] == behaviors[1]
