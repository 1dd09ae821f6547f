"""The filter, fed again with what one precision task sensed."""

from __future__ import annotations

from benchmarks.flights import ready, warm_up
from benchmarks.measure import Table, seconds, spread, timed
from missionkit.messages import Observation, Record, Sighting
from missionkit.rehearsal.rehearse import rehearse


def tables() -> list[Table]:
    """Time propagation, fusion and reading, tick by tick."""
    warm_up()
    at = ready("corners")
    ticks: list[tuple[Observation, tuple[Sighting, ...]]] = []

    def keep(record: Record, observation: Observation) -> None:
        ticks.append((observation, record.estimate.sightings))

    rehearse(at, [keep])
    navigator = at.plan.navigator
    memory = navigator.begin()
    propagate: list[float] = []
    fuse: list[float] = []
    read: list[float] = []
    for observation, sightings in ticks:
        memory, took = timed(navigator.propagate, memory, observation)
        propagate.append(took.cpu)
        if sightings:
            memory, took = timed(navigator.fuse, memory, sightings)
            fuse.append(took.cpu)
        read.append(seconds(navigator.read, memory))
    rows = [
        ("propagate: inertial, fix, height, heading", str(len(propagate)), *_us(propagate)),
        ("fuse: delayed sightings", str(len(fuse)), *_us(fuse)),
        ("read", str(len(read)), *_us(read)),
    ]
    note = f"{len(ticks)} ticks of 50 ms: five inertial samples each. Processor time."
    return [Table("Estimation", ("work", "ticks", "p50, us", "p99, us"), rows, note)]


def _us(times: list[float]) -> tuple[str, str]:
    return spread(times, 1e6, 0)
