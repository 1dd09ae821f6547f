"""Cost of a campaign: its flights, and how many run in parallel."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from itertools import islice
from statistics import median

from benchmarks.flights import KNOWN_MAP, past_two_walls, ready
from benchmarks.measure import Table, seconds, timed
from missionkit.campaigns.process_pool import flown
from missionkit.campaigns.run_row import Case, RunOrder
from missionkit.messages import Command, Observation, Record
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import Stage
from missionkit.sim.simulated_vehicle import SimulatedVehicle

REPEATS = 5
RUNS = 200


def tables() -> list[Table]:
    """Time flights on one core, then campaigns on one worker and on two, in turns."""
    return [_flights(), _workers()]


def _flights() -> Table:
    rows = [
        _row("to the tree and back, no camera", lambda: ready("none")),
        _row("known map, no camera", past_two_walls),
    ]
    note = (
        f"x real time on one core: flown time over processor time, medians of {REPEATS}. The first "
        "flies again what a flight commanded: no chart, no guards, no planning, no record."
    )
    header = ("mission", "flown, s", "physics, sensors, filter", "whole flight")
    return Table("Campaigns: one run", header, rows, note)


def _row(name: str, staged: Callable[[], Stage]) -> tuple[str, ...]:
    commands: list[Command] = []

    def keep(record: Record, _: Observation) -> None:
        commands.append(record.command)

    duration = rehearse(staged(), [keep]).flown.duration
    below = median(seconds(_flown_again, staged(), commands) for _ in range(REPEATS))
    whole = median(seconds(rehearse, staged()) for _ in range(REPEATS))
    return name, f"{duration:.0f}", f"{duration / below:.0f}", f"{duration / whole:.0f}"


def _flown_again(at: Stage, commands: list[Command]) -> None:
    """Let the same commands act on the vehicle, and the filter follow it."""
    vehicle: SimulatedVehicle = at.vehicle
    navigator, period = at.plan.navigator, at.plan.period
    memory = navigator.begin()
    for count, command in enumerate(commands, 1):
        memory = navigator.propagate(memory, vehicle.advance(count * period))
        navigator.read(memory)
        vehicle.apply(command)


def _workers() -> Table:
    order = RunOrder(str(KNOWN_MAP), {})
    _flown(order, 2, 4)  # the fork server imports and compiles once
    times = {workers: [_flown(order, workers, RUNS) for _ in range(2)] for workers in (1, 2)}
    one, two = (min(times[workers]) for workers in (1, 2))
    rows = [
        (str(workers), f"{took:.1f}", f"{RUNS / took:.1f}", f"{one / took:.2f}")
        for workers, took in ((1, one), (2, two))
    ]
    note = f"{RUNS} runs of the known map, start of the workers included; the faster of 2, wall."
    return Table(
        "Campaigns: workers", ("workers", "s", "runs a second", "x one worker"), rows, note
    )


def _flown(order: RunOrder, workers: int, runs: int) -> float:
    cases = (Case(n, 0, n, {}) for n in range(runs))
    with closing(flown(order, cases, workers=workers)) as rows:
        ended, took = timed(list, islice(rows, runs))
    assert len(ended) == runs  # noqa: S101
    return took.wall
