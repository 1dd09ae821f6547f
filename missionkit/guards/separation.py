"""Separation from the other vehicles of a fleet."""

from __future__ import annotations

import math
from typing import ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.geometry import Vec3, norm
from missionkit.messages import Estimate, OtherVehicle, TrafficReport, Verdict
from missionkit.messages.region import Interval, Quantity, Region
from missionkit.plugin import Guard
from missionkit.units import Metres, Seconds


class SeparationBelow(Guard):
    """Holds while another vehicle of the fleet is, or will soon be, nearer than `distance`.

    The others are where they last reported themselves, moved on at the velocity they reported.
    With `ahead` the least distance within that time counts, if both vehicles keep their
    velocities. Vehicles on the ground do not count. Unknown in a mission that flies alone, and
    while a vehicle has not been heard for `max_age`, unless another one is too near.
    """

    kind: ClassVar[str] = "separation_below"
    distance: Metres = Field(gt=0)
    vehicle: str | None = Field(default=None, description="name of one vehicle; all if absent")
    ahead: Seconds = Field(default=0.0, ge=0, le=60, description="of time")
    max_age: Seconds = Field(default=1.0, gt=0, le=10, description="of what another reported")

    @override
    def check(self, seen: Estimate) -> Verdict:
        others = [it for it in seen.traffic if self.vehicle in {None, it.name}]
        if not others:
            named = "vehicle" if self.vehicle is None else f"vehicle {self.vehicle!r}"
            return Verdict.unknown(f"no other {named} is known: fly it in a fleet")
        expected = [it for it in others if not it.ended]
        silence = next(filter(None, (self._silence(it, seen.now) for it in expected)), "")
        near = [
            (self._least_distance(it.report, seen), it.name)
            for it in expected
            if it.report is not None and it.report.in_air and not self._silence(it, seen.now)
        ]
        distance, name = min(near, default=(math.inf, ""))
        if silence and distance >= self.distance:
            return Verdict.unknown(silence)
        if not near:
            return Verdict(holds=False, why="no other vehicle is in the air")
        return Verdict.below(distance, self.distance, name)

    @override
    def region(self) -> Region:
        whom = self.vehicle or "the other vehicles"
        when = f" within {self.ahead:g} s" if self.ahead else ""
        return Region.of(
            Quantity(f"separation from {whom}{when}", unit="m"), Interval.below(self.distance)
        )

    def _silence(self, other: OtherVehicle, now: float) -> str:
        """Say that a vehicle has been silent for too long, "" if it has not."""
        if other.report is None:
            return f"{other.name} has not been heard yet"
        age = now - other.report.at
        return f"{other.name} has been silent for {age:.1f} s" if age > self.max_age else ""

    def _least_distance(self, report: TrafficReport, seen: Estimate) -> float:
        """Return the least distance (m) from now until `ahead` s later."""
        there = report.position + report.velocity * (seen.now - report.at)
        return closest_approach(there - seen.position, report.velocity - seen.velocity, self.ahead)


def closest_approach(offset: Vec3, velocity: Vec3, ahead: float) -> float:
    """Return the least distance (m) of two vehicles that keep their velocities.

    d = ‖r + v t‖ at t = -r·v / v·v, kept within 0 to `ahead`.

    Args:
        offset: (3,), m, of one from the other.
        velocity: (3,), m/s, of one relative to the other.
        ahead: s, how long.
    """
    square = float(velocity @ velocity)
    at = 0.0 if square == 0.0 else min(max(-float(offset @ velocity) / square, 0.0), ahead)
    return norm(offset + velocity * at)
