"""Flying several missions together in the built-in simulator."""

from __future__ import annotations

import asyncio
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from missionkit.engine.clock import Pace, processor_time
from missionkit.engine.flight_end import AT_REST
from missionkit.engine.flight_loop import Keeper, Observer, Operator, fly, keep_nothing
from missionkit.engine.timed_containment import TimedContainment
from missionkit.errors import UsageError
from missionkit.messages import Observation, Record
from missionkit.plugin_containment import described, marking_interrupts
from missionkit.rehearsal.airspace import Airspace, FleetPort
from missionkit.rehearsal.grading import Rehearsal, Witness, graded_flight
from missionkit.rehearsal.lockstep import Lockstep
from missionkit.rehearsal.stage import Stage
from missionkit.sim.separation import Encounter, encounters
from missionkit.sim.simulated_vehicle import SimulatedVehicle
from missionkit.sim.world import World

SHARED = ("ground", "wind", "obstacles", "markers", "arena")
"""Parts of a world that the vehicles of a fleet have in common."""


class FleetFlight(NamedTuple):
    """What became of the vehicles of a fleet."""

    flights: Mapping[str, Rehearsal | str]  # by name; why a flight broke off
    encounters: tuple[Encounter, ...]
    collisions: tuple[tuple[float, str, str], ...]  # s, and both names


def member_seed(seed: int, number: int) -> int:
    """Return the seed of one vehicle: each has its own gusts and noise.

    Args:
        seed: of the fleet.
        number: of the vehicle, from 0.
    """
    return int(np.random.SeedSequence((seed, number)).generate_state(1)[0])


def check_fit(stages: Mapping[str, Stage]) -> None:
    """Refuse vehicles that cannot fly together.

    Raises:
        UsageError: they are not of one world, or not multicopters.
    """
    (first, one), *others = stages.items()
    for name, ready in stages.items():
        if not isinstance(ready.world, World):
            raise UsageError(f"{name}: a fleet is of multicopters, not {ready.mission.vehicle.use}")
        if ready.world.target_starts or ready.world.obstacle_starts:
            raise UsageError(f"{name}: ground robots in a world react to one vehicle, not a fleet")
    for name, ready in others:
        differing = [it for it in SHARED if getattr(one.world, it) != getattr(ready.world, it)]
        if differing:
            raise UsageError(
                f"{first} and {name} fly in worlds that differ in {', '.join(differing)}: "
                "let both missions name one world"
            )
        if one.mission.origin != ready.mission.origin:
            raise UsageError(
                f"{first} and {name} have different origins: metres mean the same places only with "
                "one origin"
            )


def rehearse_fleet(
    stages: Mapping[str, Stage],
    observers: Mapping[str, Sequence[Observer]],
    *,
    separation: float,
    keepers: Mapping[str, Keeper] = MappingProxyType({}),
    operator: Operator | None = None,
    pace: Pace | None = None,
) -> FleetFlight:
    """Fly all missions at once, and grade each by ground truth.

    Args:
        stages: by the vehicle's name.
        observers: of each vehicle, called after its ticks.
        separation: m, nearer than which two vehicles in the air are in conflict.
        keepers: of each vehicle, called after every tick but the last.
        operator: may request a landing of all.
        pace: lets mission time pass; as fast as possible by default.

    Raises:
        UsageError: the vehicles cannot fly together.
    """
    check_fit(stages)
    vehicles = {
        name: ready.vehicle
        for name, ready in stages.items()
        if isinstance(ready.vehicle, SimulatedVehicle)
    }
    airspace = Airspace(vehicles)
    steps = Lockstep(len(stages), pace, airspace.settle)
    contain, operator = TimedContainment(processor_time), operator or Operator()
    flights: dict[str, Rehearsal | str] = {}

    async def flight(number: int, name: str, ready: Stage, vehicle: SimulatedVehicle) -> None:
        seen = Witness(ready)

        def report(record: Record, _: Observation) -> None:
            airspace.tell(name, record)

        try:
            flown = await fly(
                ready.plan,
                FleetPort(vehicle, airspace, name),
                (seen, report, *observers.get(name, ())),
                operator=operator,
                pace=steps.pace(number),
                time_limit=ready.mission.settings.time_limit,
                shared=contain,
                keeper=keepers.get(name, keep_nothing),
            )
            flights[name] = graded_flight(ready, flown, seen)
            if flown.end in AT_REST:
                airspace.ended(name)
        except Exception as error:  # noqa: BLE001 - one vehicle lost never stops the others
            flights[name] = described(error)
        finally:
            steps.leave(number)

    async def together() -> None:
        numbered = enumerate(stages.items())
        await asyncio.gather(
            *(flight(n, name, ready, vehicles[name]) for n, (name, ready) in numbered)
        )

    with marking_interrupts(), contain.interrupting():
        asyncio.run(together())
    tracks = {name: vehicle.track.rows for name, vehicle in vehicles.items()}
    ordered = {name: flights[name] for name in stages}
    return FleetFlight(ordered, encounters(tracks, separation), tuple(airspace.collisions))
