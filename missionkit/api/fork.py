"""Another mission in a recorded rehearsal, flown on in the simulator from where it parts."""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from typing_extensions import override

from missionkit.api.event_loop import outside_loop
from missionkit.api.missions import NO_SETTINGS, LoadedMission
from missionkit.api.recorded_mission import origin_of
from missionkit.api.replay import journals
from missionkit.api.run_origin import Origin
from missionkit.api.simulation import fault_of
from missionkit.api.what_if import mission_asked, question_of
from missionkit.engine.flight_loop import Operator
from missionkit.errors import UsageError
from missionkit.messages import ABORT, Observation, Record
from missionkit.outcome import outcome
from missionkit.recorder import value_codec
from missionkit.recorder.flight_journal import SIMULATOR, JournalTick, rows, without_samples
from missionkit.recorder.journal_reader import read_journal, tick_of
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import stage, world_of
from missionkit.replays.decision_difference import same
from missionkit.replays.decision_table import DecisionTable, Taken, tabulated, taken_at

REFUSED = "_refused"  # ends the events of the simulated autopilot itself


class Fork(NamedTuple):
    """A flight and what another mission makes of it, in the simulator from where they part.

    Attributes:
        journal: file of the flight.
        table: its transitions, in flight and now; all of them are evidence if `exact`.
        outcome: how the other flight ended.
        exact: up to where they part the simulator repeats the flight bit by bit.
        notes: sentences: what of this does not hold.
    """

    journal: Path
    table: DecisionTable
    outcome: str
    exact: bool
    notes: tuple[str, ...]


class _RecordedOperator(Operator):
    """Sends what the operator of a flight sent, at the same ticks."""

    def __init__(self, events: Mapping[int, tuple[str, ...]]) -> None:
        super().__init__()
        self._recorded, self._tick = events, -1

    @override
    def take(self) -> tuple[str, ...]:
        self._tick += 1
        sent = self._recorded.get(self._tick, ())
        if ABORT in sent:
            self.land()
        return tuple(it for it in sent if it != ABORT)


class _Comparison:
    """Compares what the simulator gives with what was recorded, until a command differs."""

    def __init__(self, ticks: Sequence[JournalTick]) -> None:
        self._ticks, self._count = ticks, 0
        self.taken: list[Taken] = []
        self.parted: float | None = None
        self.strayed: float | None = None  # s, when the simulator first gave something else
        self.until = 0.0

    def __call__(self, record: Record, observation: Observation) -> None:
        """See one tick; an observer of the flight."""
        self.until = record.now
        self.taken += taken_at(record.now, record.fired)
        if self.parted is None and self._count < len(self._ticks):
            flown = self._ticks[self._count]
            if self.strayed is None and not _alike(flown, observation):
                self.strayed = record.now
            if not same(flown.decision.command, record.command):
                self.parted = record.now
        self._count += 1


def _alike(flown: JournalTick, observation: Observation) -> bool:
    now = (without_samples(observation), rows(observation))
    return value_codec.written((flown.observation, flown.imu)) == value_codec.written(now)


def fork(
    run: str | Path,
    mission: str | Path | None = None,
    *,
    settings: Mapping[str, object] = NO_SETTINGS,
    plugins: Sequence[str | Path] = (),
) -> Fork:
    """Fly another mission in the simulator of a recorded rehearsal, and compare the transitions.

    The simulator starts from the seed and the faults of the rehearsal, and the operator's events
    come at the same ticks. Until the first command that differs it repeats the flight bit by bit,
    which is checked: from there on it is what this mission would have flown.

    Args:
        run: folder of a rehearsal, or a journal. Of a resumed flight the first part counts.
        mission: file of the other mission; the one that was flown if absent.
        settings: values of parameters that differ from those of the flight.
        plugins: plug-in files that the mission uses.

    Raises:
        FileError: the mission has errors, or the world cannot be used.
        UsageError: there is no journal, it cannot be read, or is of a flight over MAVLink.
    """
    journal = read_journal(journals(Path(run))[0])
    head = journal.head
    if head.vehicle != SIMULATOR or not head.begins:
        what = "a resumed part" if head.vehicle == SIMULATOR else f"flown at {head.vehicle}"
        raise UsageError(f"{journal.path}: {what}: only a rehearsal from its start can be forked")
    question = question_of(mission, settings, plugins)
    with tempfile.TemporaryDirectory() as folder:
        other = mission_asked(question, journal, Path(folder))
        ticks = [tick_of(journal, text) for _, text in journal.ticks]
        watch = _Comparison(ticks)
        ended = _flown(other, origin_of(journal), watch, _operator(ticks))
    flown = [it for tick in ticks for it in taken_at(tick.observation.now, tick.decision.fired)]
    table = tabulated(flown, watch.taken, None, watch.until)._replace(parted=watch.parted)
    notes = [journal.ends] if journal.ends else []
    if watch.strayed is not None:
        notes.append(
            f"at {watch.strayed:.2f} s the simulator gave something else than in flight: another "
            "version of missionkit, world or camera; the rest is approximate"
        )
    return Fork(journal.path, table, ended, watch.strayed is None, tuple(notes))


def _flown(mission: LoadedMission, origin: Origin, watch: _Comparison, operator: Operator) -> str:
    """Fly from the seed and the faults of a rehearsal, and return how it ended."""
    model = mission.model
    world = world_of(model, mission.path.parent)
    faults = [fault_of(text, model, world) for text in origin.faults]
    ready = stage(model, mission.catalogue, world, origin.seed, faults)
    return str(outcome(outside_loop(lambda: rehearse(ready, (watch,), operator=operator))))


def _operator(ticks: Sequence[JournalTick]) -> _RecordedOperator:
    events = {it.number: it.observation.events for it in ticks if it.observation.events}
    return _RecordedOperator(
        {
            number: tuple(event for event in sent if not event.endswith(REFUSED))
            for number, sent in events.items()
        }
    )
