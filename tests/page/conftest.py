"""A short recorded flight, flown once."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from browsing import Browser, port_of, served
from samples import HOP

import missionkit
from missionkit.page.recording.recorded_run import RecordedRun, recorded_run
from missionkit.page.recording.recording_source import RecordingSource


@pytest.fixture(scope="session")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("page")
    mission = folder / "mission.yaml"
    mission.write_text(HOP)
    missionkit.rehearse(missionkit.load(mission), folder=folder / "run")
    return folder / "run"


@pytest.fixture(scope="session")
def recorded(run: Path) -> Iterator[RecordedRun]:
    found = recorded_run(run)
    with closing(found.images):
        yield found


@pytest.fixture(scope="module")
def browser(recorded: RecordedRun):
    with served(RecordingSource(recorded)) as address:
        it = Browser(port_of(address))
        assert it.enter() == 200
        yield it
