"""A flight that is killed on its way and resumed after a gap, graded by the truth."""

from __future__ import annotations

import numpy as np
import pytest
from rehearsed import killed, short_stage

from missionkit.messages import Observation, Record
from missionkit.rehearsal.rehearse import Again, rehearse

CRUISE = """\
targets: {pole: {position: [60, 0, -6]}}
initial: up
states:
  up: {kind: idle, behavior: {use: take_off, height: 6}, transitions: [{to: out, when: done}]}
  out:
    kind: gps
    behavior: {use: go_to, target: pole, speed: 4.5}
    transitions: [{to: land, when: done}]
  land: {kind: land}
failsafes: [{name: lost, when: {use: estimate_bad}, for: 1.0, to: land}]
success: {visit: out}
"""


@pytest.mark.parametrize(("at", "gap"), [(7.2, 1.0), (8.2, 5.0), (9.2, 120.0)])
def test_a_resumed_flight_has_a_position_or_is_on_the_ground(at, gap):
    kept, before = killed(short_stage(CRUISE), lambda it: it.course.memory.now >= at)
    ready = short_stage(CRUISE)
    lost: list[np.ndarray] = []
    worst: list[float] = []

    def watch(record: Record, _: Observation) -> None:
        truth, seen = ready.vehicle.truth, record.estimate
        if seen.health.diverged:
            lost.append(truth.position)
        else:
            off = np.linalg.norm((seen.position - truth.position)[:2])
            worst.append(float(off / seen.health.position_sd))
        if record.command.setpoint is not None:
            assert not truth.on_ground

    done = rehearse(ready, [watch], again=Again(kept, before, gap))
    assert max(worst) < 4.0
    assert not lost or np.ptp(np.array(lost), axis=0).max() < 3.0
    assert done.succeeded
