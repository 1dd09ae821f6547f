"""No tick waits for a compiler: whatever a flight runs is ready once it is staged."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from rehearsed import flown, precise_stage

FAULTS = ("wind_gust=5@30+5", "gnss_lost@40+5", "gnss_jump=8@visual+10")
CHECK = f"import {Path(__file__).stem} as test; assert test.compiled_in_flight() == []"


def kernels() -> dict[str, int]:
    """Count for how many kinds of arguments each kernel is compiled in this process."""
    return {
        f"{module}.{name}": len(thing.signatures)
        for module, contents in list(sys.modules.items())
        if module.startswith("missionkit.")
        for name, thing in vars(contents).items()
        if hasattr(thing, "py_func")
    }


def compiled_in_flight() -> list[str]:
    ready = precise_stage(*FAULTS)
    before = kernels()
    assert before
    flown(ready)
    after = kernels()
    return [name for name in after if after[name] != before[name]]


def test_a_flight_compiles_nothing():
    subprocess.run([sys.executable, "-c", CHECK], cwd=Path(__file__).parent, check=True)
