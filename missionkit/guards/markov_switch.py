"""Switching of guidance modes by the transition probabilities of P3, Algorithm 1."""

from __future__ import annotations

from typing import Any, ClassVar, Literal, NamedTuple, Self

from pydantic import Field, model_validator
from typing_extensions import override

from missionkit.geometry import Quat, Vec3, conjugate, from_matrix, multiply, norm, to_matrix
from missionkit.goal_pose import goal_rotation
from missionkit.messages import Estimate, Verdict
from missionkit.plugin import WindowGuard
from missionkit.units import Fraction, Metres

Mode = Literal["approach", "reorient", "align"]
REARMED = 1.2
"""Beyond so many `activation` distances the algorithm starts again."""
ALIGNED = 1e-9
"""Least misalignment that is divided by."""


class SwitchState(NamedTuple):
    """The mode, which is latched, and the distances at which it was entered."""

    mode: Mode = "approach"
    r2: float | None = None  # m, where the vehicle began to reorient
    r1: float | None = None  # m, where it began to align


class Factors(NamedTuple):
    """Inputs of the algorithm at one tick."""

    r: float  # m, to the target
    d: float  # 1, Mahalanobis distance of the innovations
    q: float  # 1, norm of the vector part of the attitude error
    sigma: float  # m, standard deviation of the position relative to the target


class MarkovSwitch(WindowGuard):
    """Holds once Algorithm 1 of P3 has switched to a guidance mode: `reorient` or `align`.

    approach:  A11 = min(1, (r / r_t) / ((1 + d) |q_e|));  reorient at A11 ≤ `leave_approach`, or
               r ≤ r2
    reorient:  A22 = min(1, (r / r2) / (1 + d)),  A23 = 1 - A22,
               A32 = clip((σ / σ_r) (r2 - r) / (r2 - r_d), 0, 1),  A33 = 1 - A32,
               π = A23 / (A23 + A32);  align at π ≤ `leave_reorient`

    r is the distance to the target, d the Mahalanobis distance of the innovations, q_e the vector
    part of the attitude error, σ the standard deviation of the position relative to the target.
    The algorithm is active from r ≤ r_t (`activation`) down to r1, the larger of `r1` and
    `keep_out`, where it aligns in any case. A mode is kept once it is reached, and while an input
    is unknown or both A23 and A32 are 0, until the vehicle has gone beyond 1.2 r_t again.

    The verdict's value is A11, or π, its reason the factors. Source: P3 section V-B; clamped and
    latched: corrections P3.1 and P3.2.
    """

    kind: ClassVar[str] = "markov_switch"
    target: str
    to: Literal["reorient", "align"] = Field(description="mode that must be reached")
    activation: Metres = Field(gt=0, description="r_t, distance from which it is active")
    docked: Metres = Field(default=0.1, ge=0, description="r_d, distance at the end")
    r1: Metres = Field(default=0.1, ge=0, description="distance at which to align at the latest")
    r2: Metres = Field(default=0.3, gt=0, description="distance at which to reorient at the latest")
    keep_out: Metres = Field(default=0.0, ge=0, description="distance that r1 is never below")
    sensor_sd: Metres = Field(gt=0, description="of the sensor that measures from afar")
    leave_approach: Fraction = Field(default=0.4, description="A11 at which to reorient")
    leave_reorient: Fraction = Field(default=0.6, description="π at which to align")
    attitude: Literal["facing", "same"] = Field(
        default="facing", description="aligned: facing the target's marker, or turned as it is"
    )

    @model_validator(mode="after")
    def _nested(self) -> Self:
        if not max(self.r1, self.keep_out) <= self.r2 <= self.activation:
            raise ValueError("expected r1 and keep_out ≤ r2 ≤ activation")
        if self.docked >= self.r2:
            raise ValueError(f"docked ({self.docked:g}) must be below r2 ({self.r2:g})")
        return self

    @override
    def begin(self) -> SwitchState:
        return SwitchState()

    @override
    def advance(self, memory: Any, seen: Estimate) -> SwitchState:
        state: SwitchState = memory
        found = self._factors(seen)
        if isinstance(found, str):
            return state
        if found.r > REARMED * self.activation:
            return SwitchState()
        if found.r > self.activation or state.mode == "align":
            return state
        return self._switched(state, found)

    def _switched(self, state: SwitchState, found: Factors) -> SwitchState:
        """Return the mode after one step of the algorithm's loop."""
        if found.r <= self._nearest:
            return state._replace(mode="align", r1=self._nearest)
        if state.r2 is None:
            reached = self.a11(found) <= self.leave_approach or found.r <= self.r2
            return SwitchState("reorient", found.r) if reached else state
        pi = self.steady(found, state.r2)
        if pi is None or pi > self.leave_reorient:
            return state
        return state._replace(mode="align", r1=found.r)

    def a11(self, found: Factors) -> float:
        """Return the probability of going on towards the target."""
        return min(1.0, found.r / self.activation / ((1.0 + found.d) * max(found.q, ALIGNED)))

    def rates(self, found: Factors, r2: float) -> tuple[float, float]:
        """Return A23 and A32 of the chain of reorient and align; r2 (m): where it was entered."""
        a22 = min(1.0, found.r / r2 / (1.0 + found.d))
        way = (r2 - found.r) / (r2 - self.docked) if r2 > self.docked else 1.0
        return 1.0 - a22, min(max(found.sigma / self.sensor_sd * way, 0.0), 1.0)

    def steady(self, found: Factors, r2: float) -> float | None:
        """Return π of align, None where it is not unique."""
        a23, a32 = self.rates(found, r2)
        return a23 / (a23 + a32) if a23 + a32 > 0.0 else None

    @override
    def check(self, memory: Any, seen: Estimate) -> Verdict:
        state: SwitchState = memory
        found = self._factors(seen)
        if isinstance(found, str):
            return self._without(state, found)
        said = f"r {found.r:.3g} m, d {found.d:.3g}, |q_e| {found.q:.3g}, sd {found.sigma:.3g} m"
        if self.to == "reorient":
            why = f"{state.mode}: {said}"
            value = self.a11(found)
            return self._verdict(state, why, value, self.leave_approach)
        if state.r2 is None:
            return Verdict(state.mode == "align", f"{state.mode}: {said}")
        a23, a32 = self.rates(found, state.r2)
        why = f"{state.mode}: A23 {a23:.3g}, A32 {a32:.3g}, r2 {state.r2:.3g} m; {said}"
        return self._verdict(state, why, self.steady(found, state.r2), self.leave_reorient)

    def _verdict(self, state: SwitchState, why: str, value: float | None, limit: float) -> Verdict:
        """Return the latched answer; once it holds there is no margin any more."""
        if value is None:
            return Verdict(self._reached(state), why)
        if self._reached(state):
            return Verdict(True, why, value, limit)  # noqa: FBT003
        return Verdict(False, why, value, limit, limit - value)  # noqa: FBT003

    def _without(self, state: SwitchState, unknown: str) -> Verdict:
        if self._reached(state):
            return Verdict(holds=True, why=f"{state.mode}; {unknown}")
        return Verdict.unknown(unknown)

    def _reached(self, state: SwitchState) -> bool:
        return state.mode in {"align", self.to}

    @property
    def _nearest(self) -> float:
        return max(self.r1, self.keep_out)

    def _factors(self, seen: Estimate) -> Factors | str:
        """Return the inputs, or which is not known."""
        target, d = seen.targets.get(self.target), seen.health.mahalanobis
        if target is None or not seen.health.aligned:
            return f"the position of {self.target} is unknown"
        if target.attitude is None:
            return f"the orientation of {self.target} is unknown"
        if d is None:
            return "the navigator took in no measurement lately"
        r = norm(target.position - seen.position)
        return Factors(r, d, norm(self._misalignment(seen, target.attitude)), target.position_sd)

    def _misalignment(self, seen: Estimate, marker: Quat) -> Vec3:
        """Return the vector part (3,) of the error quaternion."""
        wanted = marker
        if self.attitude == "facing":
            wanted = from_matrix(goal_rotation(to_matrix(marker)))
        return multiply(conjugate(wanted), seen.attitude)[1:]
