"""A vehicle that leans in the wind, as PX4's simulated one does; judged by the truth."""

from __future__ import annotations

from rehearsed import flown, precise_stage

from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import stage
from missionkit.sim.fault_injection import parse_fault
from studies.flight import builtin
from studies.leaning import knowing_noise, sih, with_small_markers
from studies.watch import Watch

STEADY = (1.5, 1.0, 0.0)  # m/s


def test_small_markers_are_seen_at_arms_length_at_any_tilt() -> None:
    ready = precise_stage()
    mission, world = knowing_noise(ready.mission), sih(ready.world, STEADY, 0.0)
    mission, world = with_small_markers(mission, world)
    faults = [parse_fault("velocity_bias"), parse_fault("control_slow")]
    ready = stage(mission, builtin(), world, 21, faults)
    watch = Watch(ready)
    result = rehearse(ready, [watch])
    assert ("task", "return") in [(change.source, change.to) for change in watch.changes]
    assert "search" not in [change.to for change in watch.changes]
    assert result.succeeded


def test_noise_that_does_not_fit_is_a_problem_once() -> None:
    ready = precise_stage(limit=50.0)
    world = sih(ready.world, (0.0, 0.0, 0.0), 0.0)
    flight = flown(stage(ready.mission, builtin(), world, 21))
    problems = [problem for problem in flight.problems() if "filter's noise" in problem]
    (problem,) = problems
    assert "accel_noise" in problem
