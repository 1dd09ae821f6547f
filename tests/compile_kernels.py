"""Compile what shipped missions fly with: once, beside the type checker, before the tests.

`python -m compile_kernels docking` compiles for `missions/docking.yaml`.
"""

import sys

from documents import ROOT

import missionkit
from missionkit.rehearsal import stage, world_of

if __name__ == "__main__":
    for name in sys.argv[1:]:
        path = ROOT / "missions" / f"{name}.yaml"
        mission = missionkit.load(path)
        stage(mission.model, mission.catalogue, world_of(mission.model, path.parent), 0)
