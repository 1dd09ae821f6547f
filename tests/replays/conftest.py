"""A short flight with drawn images, its journal, and the plan that comes out of it."""

from __future__ import annotations

import pytest

import missionkit
from missionkit.api.recorded_mission import mission_flown
from missionkit.engine.prepared_mission import prepare
from missionkit.recorder.journal_reader import read_journal

LOOK = """
missionkit: 1
mission: look
params: {height: 2.0}
dwell: 0.1
world: worlds/here.yaml
camera: {use: rendered, width: 160, height: 120, focal: 120, rate: 10}
targets: {pad: {position: [3.0, 0.0, -2.0], position_sd: 0.5, facing_deg: 180}}
perception: [{use: aruco, target: pad, dictionary: DICT_4X4_50, id: 3, size: 0.6}]
initial: idle
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: $height}
    transitions: [{to: wait, when: done}]
  wait:
    kind: gps
    behavior: {use: hold}
    transitions:
      - {to: land, when: {use: aruco_confidence, target: pad, window: 10, enter: 0.7, exit: 0.5}}
      - {to: land, after: 20}
  land: {kind: land}
"""
WORLD = """
world: here
markers:
  - {dictionary: DICT_4X4_50, id: 3, size: 0.6, position: [3.0, 0.0, -2.0], facing_deg: 180}
"""


@pytest.fixture(scope="package")
def run(tmp_path_factory):
    """The folder of a flight that lands because a marker appeared in drawn images."""
    root = tmp_path_factory.mktemp("flown")
    (root / "worlds").mkdir()
    (root / "worlds" / "here.yaml").write_text(WORLD)
    (root / "look.yaml").write_text(LOOK)
    mission = missionkit.load(root / "look.yaml", settings={"height": 2.2})
    summary = missionkit.rehearse(
        mission, seed=5, faults=["marker_hidden@0+5"], folder=root / "run"
    )
    assert summary.transitions[-1].reason.startswith("when aruco confidence")
    (root / "worlds" / "here.yaml").unlink()  # a replay needs the journal alone
    (root / "look.yaml").unlink()
    return root / "run"


@pytest.fixture(scope="package")
def journal(run):
    return read_journal(run / "journal.mcap")


@pytest.fixture(scope="package")
def plan(journal, tmp_path_factory):
    mission = mission_flown(journal, tmp_path_factory.mktemp("files"))
    return prepare(mission.model, mission.catalogue)
