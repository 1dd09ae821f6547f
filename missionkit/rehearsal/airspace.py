"""What simulated vehicles of a fleet share: reports of where they are, and the air."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import combinations

from missionkit.errors import UsageError
from missionkit.estimation.own_report import own_report
from missionkit.geometry import norm
from missionkit.messages import Command, Observation, OtherVehicle, Record
from missionkit.sim.simulated_vehicle import SimulatedVehicle

REPORTS_EVERY = 0.1  # s


class Airspace:
    """Reports of the vehicles, and collisions of those that come too near.

    A report is the vehicle's own estimate, ten times a second; the others hear it at their next
    tick. Vehicles that touch in the air crash.

    Args:
        vehicles: by name.

    Raises:
        UsageError: two of them start in the same place.
    """

    def __init__(self, vehicles: Mapping[str, SimulatedVehicle]) -> None:
        self._vehicles = vehicles
        self._said = {name: OtherVehicle(name) for name in vehicles}
        self._heard = dict(self._said)
        self.collisions: list[tuple[float, str, str]] = []  # s, and both names
        for one, other in combinations(vehicles, 2):
            apart = norm(vehicles[one].truth.position - vehicles[other].truth.position)
            if apart <= self._touching(one, other):
                raise UsageError(
                    f"{one} and {other} start {apart:.2f} m apart: give each mission a "
                    "'vehicle: {start: [north, east]}' of its own"
                )

    def tell(self, name: str, record: Record) -> None:
        """Report a vehicle after its tick, if it is time and it knows where it is."""
        before = self._said[name].report
        if before is not None and record.now - before.at < REPORTS_EVERY - 1e-6:
            return
        report = own_report(record.estimate)
        if report is not None and not self._vehicles[name].traffic_lost:
            self._said[name] = OtherVehicle(name, report)

    def ended(self, name: str) -> None:
        """Say that the flight of a vehicle, which is on the ground, is over."""
        self._said[name] = self._said[name]._replace(ended=True)
        self._heard[name] = self._said[name]

    def others(self, name: str) -> tuple[OtherVehicle, ...]:
        """Return what a vehicle has heard of the others."""
        return tuple(it for who, it in self._heard.items() if who != name)

    def settle(self, now: float) -> None:
        """Deliver what was reported, and let vehicles that touch crash.

        Args:
            now: s, mission time that all have reached.
        """
        self._heard = dict(self._said)
        truths = {name: vehicle.truth for name, vehicle in self._vehicles.items()}
        flying = [name for name, it in truths.items() if not it.on_ground and not it.crashed]
        for one, other in combinations(flying, 2):
            apart = norm(truths[one].position - truths[other].position)
            if apart > self._touching(one, other):
                continue
            self.collisions.append((now, one, other))
            self._vehicles[one].collide()
            self._vehicles[other].collide()

    def _touching(self, one: str, other: str) -> float:
        """Return the distance (m) at which two vehicles touch."""
        return sum(self._vehicles[it].world.quadrotor.radius for it in (one, other))


class FleetPort:
    """The port of a simulated vehicle that also hears the others of its fleet."""

    def __init__(self, vehicle: SimulatedVehicle, airspace: Airspace, name: str) -> None:
        self._vehicle = vehicle
        self._airspace = airspace
        self._name = name
        self._last: tuple[OtherVehicle, ...] = airspace.others(name)

    async def connect(self) -> None:
        """Reach the vehicle."""
        await self._vehicle.connect()

    async def observe(self, until: float) -> Observation:
        """Return what was sensed, and what was heard of the others."""
        seen = await self._vehicle.observe(until)
        if not self._vehicle.traffic_lost:
            self._last = self._airspace.others(self._name)
        return replace(seen, traffic=self._last)

    async def send(self, command: Command) -> None:
        """Carry out `command`."""
        await self._vehicle.send(command)

    async def close(self) -> None:
        """Let go of the vehicle."""
        await self._vehicle.close()
