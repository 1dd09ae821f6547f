"""Compile what shipped missions fly with: once, beside the type checker, before the tests.

`python -m compile_kernels docking` compiles for `missions/docking.yaml`, `detectors` what searches
images for robots and what trains that.
"""

import sys

import numpy as np
from documents import ROOT

import missionkit
from missionkit.perception.haar import kernels
from missionkit.perception.haar.features import SIDE, pool
from missionkit.perception.haar.gentle_boost import StageGoal, boosted
from missionkit.perception.haar.warm_up import warm_up
from missionkit.rehearsal.stage import stage, world_of


def detectors() -> None:
    """Search an empty image, and train one stage on noise."""
    warm_up()
    patches = np.random.default_rng(0).integers(0, 256, (8, SIDE, SIDE)).astype(np.uint8)
    values = kernels.values(patches, *pool(12, 12), 1.0)
    boosted(values, np.repeat([1.0, -1.0], 4), StageGoal(most_stumps=1))


if __name__ == "__main__":
    for name in sys.argv[1:]:
        if name == "detectors":
            detectors()
            continue
        path = ROOT / "missions" / f"{name}.yaml"
        mission = missionkit.load(path)
        stage(mission.model, mission.catalogue, world_of(mission.model, path.parent), 0)
