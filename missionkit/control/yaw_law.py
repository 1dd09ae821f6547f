"""Where to look: the hybrid yaw law of P1 section 3.3."""

from __future__ import annotations

import math
from enum import StrEnum
from typing import NamedTuple, Self

from pydantic import BaseModel, ConfigDict, Field, model_validator

from missionkit.geometry import wrap
from missionkit.units import DegreesPerSecond, Fraction, Metres, MetresPerSecond, Number


class Regime(StrEnum):
    """Which of the three rules is in force."""

    COURSE = "course"  # far: along the velocity
    BEARING = "bearing"  # between: at the target
    TARGET = "target"  # near: as the target demands


class YawMemory(NamedTuple):
    """Memory of the yaw law."""

    regime: Regime | None = None  # None: not chosen yet
    held: float | None = None  # rad, last desired yaw


class YawLaw(BaseModel):
    """ψ_desired = atan2(v_e, v_n) if d > far; atan2(Δe, Δn) if near < d <= far; else ψ_target.

    ω_z = K_ψ wrap(ψ_desired - ψ), at most `max_rate_deg`. d is the horizontal distance, since
    the bearing of something straight below is undefined.

    Correction P1.5: outward changes of regime need `band` more distance than inward
    ones; the yaw is held where the course is undefined, below `min_speed`, and where no target
    yaw is given.
    """

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", allow_inf_nan=False)

    far: Metres = Field(default=60.0, gt=0)
    near: Metres = Field(default=1.5, gt=0)
    band: Fraction = 0.25
    min_speed: MetresPerSecond = Field(default=0.7, gt=0)
    gain: Number = Field(default=1.5, gt=0)  # 1/s
    max_rate_deg: DegreesPerSecond = Field(default=60.0, gt=0)

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if self.near * (1.0 + self.band) >= self.far:
            raise ValueError(
                f"near ({self.near} m) and its band must lie inside far ({self.far} m)"
            )
        return self

    def desired(
        self,
        memory: YawMemory,
        offset: tuple[float, float],
        velocity: tuple[float, float],
        yaw: float,
        target: float | None = None,
    ) -> tuple[float, YawMemory]:
        """Return the desired yaw (rad) and the next memory.

        Args:
            memory: what this returned a step ago.
            offset: north and east from the vehicle to the target (m).
            velocity: north and east of the vehicle (m/s).
            yaw: actual heading (rad).
            target: heading wanted at the target (rad); None keeps what the vehicle has.
        """
        regime = self._regime(memory.regime, math.hypot(*offset))
        held = yaw if memory.held is None else memory.held
        if regime is Regime.BEARING:
            held = math.atan2(offset[1], offset[0])
        elif regime is Regime.TARGET:
            held = held if target is None else target
        elif math.hypot(*velocity) > self.min_speed:
            held = math.atan2(velocity[1], velocity[0])
        return held, YawMemory(regime, held)

    def rate(self, desired: float, yaw: float) -> float:
        """Return the yaw rate (rad/s) that turns `yaw` towards `desired` (rad)."""
        top = math.radians(self.max_rate_deg)
        return min(top, max(-top, self.gain * wrap(desired - yaw)))

    def _regime(self, last: Regime | None, distance: float) -> Regime:
        stretch = 1.0 + self.band
        near = self.near * (stretch if last is Regime.TARGET else 1.0)
        far = self.far * (stretch if last in {Regime.BEARING, Regime.TARGET} else 1.0)
        if distance <= near:
            return Regime.TARGET
        return Regime.BEARING if distance <= far else Regime.COURSE
