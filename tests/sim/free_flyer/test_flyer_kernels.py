"""Kernels give the numbers of plain Python, and none is compiled after `warm_up`."""

from __future__ import annotations

import json
import os
import subprocess
import sys

import numpy as np

FLIGHT = """
import json, sys
import numpy as np
from missionkit.messages import Action, Command, Wrench
from missionkit.sim.free_flyer.body_model import FreeFlyerBody
from missionkit.sim.free_flyer.free_flyer import FreeFlyer
from missionkit.sim.free_flyer.warm_up import warm_up
from missionkit.sim.free_flyer.world import FlyerStart, FreeFlyerWorld

def kernels():
    return [(m, name, len(it.signatures)) for m, module in sorted(sys.modules.items())
            if m.startswith("missionkit.") for name, it in vars(module).items()
            if hasattr(it, "py_func")]

warm_up()
before = kernels()
start = FlyerStart(position=(1.02, 1.8, 1.0), attitude_deg=(-93.0, 2.0, -85.0))
anchors = {"a": (0.0, 0.0, 0.0), "b": (1.0, 0.0, 0.0)}
world = FreeFlyerWorld(world="w", vehicle=FreeFlyerBody(), start=start, anchors=anchors)
flyer = FreeFlyer(world, 7)
ranges, points = [], []
for tick in range(1, 141):
    seen = flyer.advance(tick * 0.05)
    ranges += [it.distance for it in seen.ranges]
    points += [it.points.tolist()[:6] for it in seen.features]
    if tick == 21:
        flyer.apply(Command(action=Action.ARM))
    elif tick > 22:
        push = Wrench(np.array([0.001, 0.0, 0.03]), np.array([2e-6, -1e-6, 3e-6]))
        flyer.apply(Command(push if tick < 60 else None, payload="camera"))
print(json.dumps([flyer.track.rows.tolist(), ranges, points, kernels() == before, len(before)]))
"""


def flown(disabled: str) -> list[list[float]]:
    run = subprocess.run(
        [sys.executable, "-c", FLIGHT],
        env={**os.environ, "NUMBA_DISABLE_JIT": disabled},
        capture_output=True,
        text=True,
        check=True,
    )
    *results, nothing_compiled, kernels = json.loads(run.stdout.replace("Infinity", "1e308"))
    assert nothing_compiled
    assert (kernels > 10) is (disabled == "0")
    return results


def test_compiled_kernels_give_the_numbers_of_plain_python():
    compiled, plain = flown("0"), flown("1")
    rows = np.array(compiled[0])
    assert rows[-1, 2] > 1.89  # it touched the target's face
    assert abs(rows[-1, 5]) < 1e-3
    for one, other in zip(compiled, plain, strict=True):
        assert len(one) > 100
        np.testing.assert_allclose(one, other, rtol=1e-10, atol=1e-12)
