"""The mission whose trust in the camera is a Markov chain's, flown in the simulator."""

from __future__ import annotations

from functools import cache

import pytest
from rehearsed import MISSIONS, Flight, flown

from missionkit.chart.checks import findings
from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import builtin
from missionkit.rehearsal.stage import stage, world_of
from missionkit.sim.fault_injection import parse_fault

GUARD = "camera-share"


@cache
def inspected(*faults: str, seed: int = 1) -> Flight:
    catalogue = builtin()
    mission = load(MISSIONS / "marker_inspection.yaml", catalogue)
    eye = mission.camera.model_copy(update={"use": "corners"})
    mission = mission.model_copy(update={"camera": eye})
    world = world_of(mission, MISSIONS)
    return flown(stage(mission, catalogue, world, seed, tuple(map(parse_fault, faults))))


def test_it_validates_without_a_warning_and_its_chain_has_live_entries():
    catalogue = builtin()
    mission = load(MISSIONS / "marker_inspection.yaml", catalogue)
    assert findings(mission, catalogue) == []
    chain = mission.guards[GUARD].plugin
    assert sum(entry.live for row in chain.matrix for entry in row) == 4


@pytest.mark.parametrize("seed", [1, 2])
def test_it_goes_to_the_camera_once_the_chain_trusts_it(seed):
    flight = inspected(seed=seed)
    assert flight.result.succeeded
    assert [to for to, _ in flight.went()] == ["gps", "visual", "inspect", "return", "land"]
    entered = flight.entered("visual")
    share = [(r.now, dict(r.verdicts)[GUARD]) for r in flight.records if GUARD in dict(r.verdicts)]
    before = [verdict for now, verdict in share if now < entered and verdict.value is not None]
    assert min(verdict.value for verdict in before) < 0.3
    at = next(verdict for now, verdict in share if now >= entered)
    assert at.value >= 0.6
    assert at.why.startswith("satellites to camera ")


def test_a_covered_camera_takes_the_trust_away():
    flight = inspected("camera_off@17+8")
    states = [to for to, _ in flight.went()]
    assert states[:3] == ["gps", "visual", "search"]
    last = [dict(r.verdicts).get(GUARD) for r in flight.records if r.now < flight.entered("search")]
    assert last[-1].value < 0.3
    assert states[-1] == "land"
