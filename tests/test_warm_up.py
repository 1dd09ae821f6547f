"""No tick waits for a compiler: whatever a flight runs is ready once it is staged."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from rehearsed import MISSIONS, flown, precise_stage

from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import builtin
from missionkit.rehearsal.stage import Stage, stage, world_of

FAULTS = ("wind_gust=5@30+5", "gnss_lost@40+5", "gnss_jump=8@visual+10")
CHECK = "import {0} as test; assert test.compiled_in_flight(test.{1}()) == []"


def kernels() -> dict[str, int]:
    """Count for how many kinds of arguments each kernel is compiled in this process."""
    return {
        f"{module}.{name}": len(thing.signatures)
        for module, contents in list(sys.modules.items())
        if module.startswith("missionkit.")
        for name, thing in vars(contents).items()
        if hasattr(thing, "py_func")
    }


def faulty() -> Stage:
    return precise_stage(*FAULTS)


def landing() -> Stage:
    catalogue = builtin()
    mission = load(MISSIONS / "precision_landing.yaml", catalogue)
    eye = mission.camera.model_copy(update={"use": "corners"})
    mission = mission.model_copy(update={"camera": eye})
    return stage(mission, catalogue, world_of(mission, MISSIONS), 1)


def compiled_in_flight(ready: Stage) -> list[str]:
    before = kernels()
    assert before
    flown(ready)
    after = kernels()
    return [name for name in after if after[name] != before.get(name)]


@pytest.mark.parametrize("flight", [faulty, landing])
def test_a_flight_compiles_nothing(flight):
    check = CHECK.format(Path(__file__).stem, flight.__name__)
    subprocess.run([sys.executable, "-c", check], cwd=Path(__file__).parent, check=True)
