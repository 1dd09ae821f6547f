"""Wind, as the vehicle's own tilt shows it."""

from __future__ import annotations

import math
from typing import Any, ClassVar, NamedTuple

from pydantic import Field
from typing_extensions import override

from missionkit.geometry import GRAVITY, rotate, vec
from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import Interval, Quantity, Region
from missionkit.plugin import WindowGuard
from missionkit.units import MetresPerSecond, Number, Seconds

QUANTITY = Quantity("wind speed", unit="m/s")
SETTLED = 2.0  # times the averaging time, in the air, until it is known
Pair = tuple[float, float]  # north, east


class Blown(NamedTuple):
    """Averages over time; None: on the ground."""

    at: float  # s
    since: float  # s, in the air
    velocity: Pair  # m/s, over the ground
    thrust: Pair  # m/s², level, of the rotors


class WindAbove(WindowGuard):
    """Holds while the wind, estimated from how the vehicle leans against it, is above `speed`.

    With R z the body's axis, the rotors push the vehicle level by -g (R z)_xy / (R z)_z; what that
    and the acceleration differ by is drag, which says how fast the air passes:

        d = a - a_thrust,    |d| = linear |v_a| + quadratic |v_a|²,    wind = v - v_a

    with velocity and thrust averaged over `over` and the acceleration (v - mean v) / `over`.
    `linear` and `quadratic` are the vehicle's drag over its mass; the defaults are the simulated
    vehicle's. Level wind only, mean of gusts. Unknown on the ground, for twice `over` after
    take-off, and while the estimate has diverged.
    """

    kind: ClassVar[str] = "wind_above"
    speed: MetresPerSecond = Field(gt=0)
    over: Seconds = Field(default=4.0, gt=0, description="averaging time")
    linear: Number = Field(default=0.156, ge=0, description="1/s, of the drag over the mass")
    quadratic: Number = Field(default=0.0188, gt=0, description="1/m, of the drag over the mass")

    @override
    def begin(self) -> Blown | None:
        return None

    @override
    def advance(self, memory: Any, seen: Estimate) -> Blown | None:
        flying = seen.status is not None and seen.status.in_air and seen.health.aligned
        if not flying or seen.health.diverged:
            return None
        before: Blown | None = memory
        axis = rotate(seen.attitude, vec(0.0, 0.0, 1.0))
        if axis[2] < 0.5:  # beyond 60 deg the rotors' push is not known
            return before
        north, east = float(seen.velocity[0]), float(seen.velocity[1])
        push = (-GRAVITY * float(axis[0] / axis[2]), -GRAVITY * float(axis[1] / axis[2]))
        if before is None:
            return Blown(seen.now, seen.now, (north, east), push)
        share = 1.0 - math.exp(-max(0.0, seen.now - before.at) / self.over)
        velocity = _mixed(before.velocity, (north, east), share)
        return Blown(seen.now, before.since, velocity, _mixed(before.thrust, push, share))

    @override
    def check(self, memory: Any, seen: Estimate) -> Verdict:
        blown: Blown | None = memory
        if blown is None:
            return Verdict.unknown("the vehicle is not in the air, or its attitude is not known")
        if seen.now - blown.since < SETTLED * self.over:
            return Verdict.unknown("it has not been in the air for long enough")
        return Verdict.above(self._wind(blown, seen), self.speed, "wind, m/s")

    @override
    def resumed(self, memory: Any, gap: float) -> None:
        return None

    @override
    def region(self) -> Region:
        return Region.of(QUANTITY, Interval.above(self.speed))

    def _wind(self, blown: Blown, seen: Estimate) -> float:
        now = float(seen.velocity[0]), float(seen.velocity[1])
        drag = [
            (v - mean) / self.over - push
            for v, mean, push in zip(now, blown.velocity, blown.thrust, strict=True)
        ]
        size = math.hypot(*drag)
        half = 0.5 * self.linear / self.quadratic
        passing = math.sqrt(half * half + size / self.quadratic) - half  # m/s, of the air
        if size < 1e-9:
            return math.hypot(*blown.velocity)
        air = [-passing * d / size for d in drag]  # velocity of the vehicle in the air
        return math.hypot(blown.velocity[0] - air[0], blown.velocity[1] - air[1])


def _mixed(one: Pair, other: Pair, share: float) -> Pair:
    return one[0] + share * (other[0] - one[0]), one[1] + share * (other[1] - one[1])
