"""A run's folder as the page reads it: its journals to tick again, its record for the overview."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from missionkit.api.recorded_mission import mission_flown
from missionkit.api.replay import journals
from missionkit.chart.semantics.requirement_watch import PREFIX
from missionkit.engine.prepared_mission import prepare
from missionkit.messages import Fired
from missionkit.page.facts.chart_ids import FiredIds
from missionkit.page.facts.flown_track import FlownTrack
from missionkit.page.facts.guard_series import GuardSeries
from missionkit.page.facts.mission_facts import FlownMission
from missionkit.page.facts.requirement_facts import VERDICTS
from missionkit.page.facts.timeline import Timeline
from missionkit.page.recording.recorded_images import RecordedImages
from missionkit.recorder import problem_log
from missionkit.recorder.journal_reader import Journal, read_journal
from missionkit.recorder.problem_log import Noted
from missionkit.recorder.record_reader import RecordEntry, raw_messages, read
from missionkit.recorder.requirement_check import HOLDS
from missionkit.recorder.scenery import scenery_of
from missionkit.rehearsal.stage import world_of, world_over_mavlink

SIMULATOR = "simulator"
IMAGE, POSE = "/camera/image", "/pose"


class RecordedRun(NamedTuple):
    """Everything that the page shows of a run."""

    mission: FlownMission
    journals: tuple[Journal, ...]  # in the order they were flown
    timeline: Timeline
    series: GuardSeries
    images: RecordedImages
    track: FlownTrack
    path: Path  # folder of the run, or its journal

    @property
    def end(self) -> float:
        """Mission time (s) of the last tick."""
        times = [journal.ticks[-1][0] for journal in self.journals if journal.ticks]
        return max(times, default=0.0)


def recorded_run(run: Path, plugins: Sequence[Path] = ()) -> RecordedRun:
    """Read a run.

    Args:
        run: folder of a run, or a journal.
        plugins: plug-in files that the flight used.

    Raises:
        FileError: the mission cannot be used by this version of missionkit.
        UsageError: there is no journal, it cannot be read, or a plug-in file is not named.
    """
    found = tuple(read_journal(path) for path in journals(run))
    mission = _mission(found[0], plugins)
    timeline, series, images, track = Timeline(), GuardSeries(), RecordedImages(), FlownTrack()
    folder = run.parent if run.is_file() else run
    overview = _Overview(mission, timeline, series)
    for path in _records(folder):
        for entry in read(path, "/state", "/transitions", "/guards"):
            overview.take(entry)
        for topic, at, data in raw_messages(path):
            if topic == IMAGE:
                images.add(at * 1e-9, data)
            elif topic == POSE:
                place = json.loads(data)["pose"]["position"]
                track.add(at * 1e-9, [place["x"], place["y"], place["z"]])
    overview.finish()
    return RecordedRun(mission, found, timeline, series, images, track, run)


def _mission(journal: Journal, plugins: Sequence[Path]) -> FlownMission:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        loaded = mission_flown(journal, folder, plugins)
        simulated = journal.head.vehicle == SIMULATOR
        world = (world_of if simulated else world_over_mavlink)(loaded.model, loaded.path.parent)
        plan = prepare(loaded.model, loaded.catalogue)
    scenery = scenery_of(world, loaded.model)
    return FlownMission(loaded.model, loaded.catalogue, plan, scenery)


def _records(folder: Path) -> list[Path]:
    parts = sorted(folder.glob("flight-*.mcap"), key=lambda it: (len(it.name), it.name))
    return [it for it in (folder / "flight.mcap", *parts) if it.is_file()]


class _Overview:
    """Reads timeline and curves out of the messages of a record."""

    def __init__(self, mission: FlownMission, timeline: Timeline, series: GuardSeries) -> None:
        self._ids = FiredIds(mission.plan.chart)
        self._period = mission.plan.period
        self._timeline = timeline
        self._series = series
        self._problems: list[Noted] = []
        self._before = 0.0

    def take(self, entry: RecordEntry) -> None:
        """Take in one message."""
        readers = {"/state": self._state, "/transitions": self._fired, "/guards": self._guards}
        readers[entry.topic](entry.at, entry.data)

    def finish(self) -> None:
        """Hand on the problems, whose counts are known now."""
        rows = [{"at": it.at, "says": it.says, "times": it.times} for it in self._problems]
        self._timeline.happened((), rows)

    def _state(self, at: float, data: Mapping[str, Any]) -> None:
        self._timeline.stands(at, data["state"])
        problem_log.note(self._problems, data["problems"], at, self._before)
        self._before = at

    def _fired(self, at: float, data: Mapping[str, Any]) -> None:
        fired = Fired(data["source"], data["to"], data["reason"], (), ())
        row = {
            "at": at,
            "tick": round(at / self._period) - 1,
            "id": self._ids.of(fired),
            "source": fired.source,
            "to": fired.to,
            "reason": fired.reason,
        }
        self._timeline.happened((row,), ())

    def _guards(self, at: float, data: Mapping[str, Any]) -> None:
        rows = [{**it, "holds": HOLDS[it["holds"]]} for it in data["guards"]]
        required = [it for it in rows if it["name"].startswith(PREFIX)]
        named = [
            {"name": it["name"].removeprefix(PREFIX), "verdict": VERDICTS[it["holds"]]}
            for it in required
        ]
        self._timeline.required(at, named)
        self._series.add(at, rows)
