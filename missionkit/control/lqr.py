"""Wrench control of a vehicle that flies by thrusters: an LQR and quaternion feedback."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Annotated, ClassVar, NamedTuple, Self

import numpy as np
from pydantic import Field, model_validator

from missionkit.control import lqr_gains, quaternion_feedback, reference_motion
from missionkit.control.controller import LONGEST_STEP
from missionkit.geometry import Quat, Vec3, conjugate, exp, log, multiply, normalised, rotate
from missionkit.messages import Estimate, Guidance, Mode, Wrench
from missionkit.number_text import beside
from missionkit.plugin import Plugin
from missionkit.units import Degrees, DegreesPerSecond, MetresPerSecond, Number, Seconds

Positive = Annotated[Number, Field(gt=0)]


class Reference(NamedTuple):
    """Reference of the control loop; it moves to the guidance within the limits."""

    position: Vec3  # (3,), m, world
    velocity: Vec3  # (3,), m/s, world
    attitude: Quat  # (4,), body to world
    rates: Vec3  # (3,), rad/s, world axes


class LqrMemory(NamedTuple):
    """Memory of the controller between steps; an immutable value."""

    reference: Reference | None = None  # None until there is guidance
    integral: tuple[float, float, float] = (0.0, 0.0, 0.0)  # m s, world


class Lqr(Plugin):
    """Force and torque for a free flyer: a discrete LQR, and quaternion feedback.

    A reference moves to the guidance's position at up to the guidance's speed and `max_speed`, with
    `max_accel`, and to its attitude about one axis at up to `slew_deg`. Where the guidance gives a
    velocity, the goal moves with it. The force is

        f = -K (p - p_ref, v - v_ref, ∫(p - p_ref) dt) + m a_ref

    with K from the discrete Riccati equation of a mass (`position_weight`, `velocity_weight`,
    `integral_weight`, `effort_weight`), and the torque is

        τ = -k q_e sgn(q_e0) - d (ω - ω_ref) + I α_ref + ω × I ω

    Both are scaled down as a whole to `max_force` and `max_torque` of each body axis, so that the
    direction stays. While the force is at its limit, the integral changes towards zero only.
    Without guidance velocity and rates are damped to rest; what is not finite gives no thrust.
    Gains that would not come to rest are refused when the mission is loaded.

    Source: P3 section IV-B; Ogata 1995; Wie & Barba 1985.
    """

    kind: ClassVar[str] = "lqr"

    mass: Positive = Field(default=1.33, description="kg")
    inertia: tuple[Positive, Positive, Positive] = Field(
        default=(0.0022, 0.0022, 0.0022), description="kg m², principal, body axes"
    )
    max_force: Positive = Field(default=0.1, description="N, of each body axis")
    max_torque: Positive = Field(default=0.002, description="N·m, of each body axis")
    period: Seconds = Field(default=0.05, gt=0, description="between two commands, that of a tick")

    position_weight: Positive = Field(default=1.0, description="1/m², of Q")
    velocity_weight: Number = Field(default=1.0, ge=0, description="s²/m², of Q")
    integral_weight: Number = Field(default=0.05, ge=0, description="1/(m s)², of Q; 0: none")
    effort_weight: Positive = Field(default=0.03, description="1/N², R")

    attitude_gain: Number = Field(default=0.02, description="N·m, k")
    rate_gain: Number = Field(default=0.01, description="N·m·s, d")

    max_speed: MetresPerSecond = Field(default=0.05, gt=0, description="of the reference")
    max_accel: Positive = Field(default=0.01, description="m/s², of the reference")
    slew_deg: DegreesPerSecond = Field(default=4.0, gt=0, description="of the reference's attitude")
    slew_accel_deg: Degrees = Field(default=2.0, gt=0, description="deg/s², of the same")

    @model_validator(mode="after")
    def _comes_to_rest(self) -> Self:
        for moment in self.inertia:
            wrong = quaternion_feedback.instability(
                moment, self.attitude_gain, self.rate_gain, self.period
            )
            if wrong:
                raise ValueError(wrong)
        radius = self.spectral_radius
        if not radius < 1.0:
            pole, _ = beside(radius, 1.0, 3)
            raise ValueError(
                f"the weights give a force that does not come to rest (largest pole {pole}): "
                "make effort_weight smaller or the other weights larger"
            )
        return self

    @cached_property
    def gains(self) -> Vec3:
        """K (3,) of each axis: N/m, N s/m, N/(m s)."""
        weights = np.array([self.position_weight, self.velocity_weight, self.integral_weight])
        return lqr_gains.gains(self.mass, self.period, weights, self.effort_weight)

    @property
    def spectral_radius(self) -> float:
        """Largest modulus of the poles of an axis."""
        A, B = lqr_gains.plant(self.mass, self.period)
        n = 3 if self.integral_weight > 0.0 else 2
        return lqr_gains.spectral_radius(A[:n, :n], B[:n], self.gains[:n])

    def begin(self) -> LqrMemory:
        """Return the memory at the start: no reference."""
        return LqrMemory()

    def step(
        self,
        memory: LqrMemory,
        mode: Mode,
        guidance: Guidance | None,
        seen: Estimate,
        dt: float,
    ) -> tuple[Wrench, LqrMemory]:
        """Return the wrench (N, N·m, body axes) and the next memory.

        Args:
            memory: what this returned a step ago.
            mode: NONE gives no thrust; the others are one here.
            guidance: what the behaviour wants; None to come to rest.
            seen: the estimate at this tick.
            dt: time since the last step (s).
        """
        if mode is Mode.NONE or not _finite(
            seen.position, seen.velocity, seen.attitude, seen.rates
        ):
            return _no_thrust(), self.begin()
        if guidance is None or not _usable(guidance):
            return self._damped(seen), self.begin()
        dt = min(LONGEST_STEP, dt) if dt > 0.0 else self.period
        before = memory.reference or Reference(
            seen.position, seen.velocity, seen.attitude, rotate(seen.attitude, seen.rates)
        )
        now = self._moved(before, guidance, dt)
        force, integral = self._force(memory.integral, before, now, seen, dt)
        wrench = Wrench(force, self._torque(before, now, seen, dt))
        if not _finite(*wrench):
            return _no_thrust(), self.begin()
        return wrench, LqrMemory(now, integral)

    def _moved(self, ref: Reference, guidance: Guidance, dt: float) -> Reference:
        """Return the reference a step further towards the guidance."""
        with_it = np.zeros(3) if guidance.velocity is None else guidance.velocity
        top = min(max(guidance.speed, 0.0), self.max_speed)
        own = reference_motion.stepped(
            guidance.position - ref.position, ref.velocity - with_it, top, self.max_accel, dt
        )
        velocity = own + with_it
        goal = ref.attitude if guidance.attitude is None else normalised(guidance.attitude)
        turn = log(multiply(goal, conjugate(ref.attitude)))
        rates = reference_motion.stepped(
            turn, ref.rates, math.radians(self.slew_deg), math.radians(self.slew_accel_deg), dt
        )
        return Reference(
            ref.position + dt * velocity,
            velocity,
            normalised(multiply(exp(dt * rates), ref.attitude)),
            rates,
        )

    def _force(
        self,
        integral: tuple[float, float, float],
        before: Reference,
        now: Reference,
        seen: Estimate,
        dt: float,
    ) -> tuple[Vec3, tuple[float, float, float]]:
        """Return the force (3,), N, body axes, and the next integral (m s).

        Estimate and reference are those of the start of the period that the force is held for.
        """
        kp, kv, ki = self.gains.tolist()
        error = seen.position - before.position
        drift = seen.velocity - before.velocity
        ahead = self.mass * (now.velocity - before.velocity) / dt
        wanted = ahead - kp * error - kv * drift - ki * np.array(integral)
        force, share = _limited(rotate(conjugate(seen.attitude), wanted), self.max_force)
        if ki == 0.0:
            return force, integral
        x, y, z = (
            s if share < 1.0 and s * e >= 0.0 else _bounded(s + dt * e, self.max_force / ki)
            for s, e in zip(integral, error.tolist(), strict=True)
        )
        return force, (x, y, z)

    def _torque(self, before: Reference, now: Reference, seen: Estimate, dt: float) -> Vec3:
        back, inertia = conjugate(seen.attitude), np.array(self.inertia)
        gain = (self.attitude_gain, self.rate_gain)
        feedback = quaternion_feedback.torque(
            seen.attitude, seen.rates, before.attitude, rotate(back, before.rates), *gain
        )
        ahead = inertia * rotate(back, (now.rates - before.rates) / dt)
        wanted = feedback + ahead + quaternion_feedback.gyroscopic(inertia, seen.rates)
        return _limited(wanted, self.max_torque)[0]

    def _damped(self, seen: Estimate) -> Wrench:
        """Return the wrench that takes velocity and rates away."""
        pull = rotate(conjugate(seen.attitude), -self.gains[1] * seen.velocity)
        spin = quaternion_feedback.gyroscopic(np.array(self.inertia), seen.rates)
        return Wrench(
            _limited(pull, self.max_force)[0],
            _limited(spin - self.rate_gain * seen.rates, self.max_torque)[0],
        )


def _limited(v: Vec3, limit: float) -> tuple[Vec3, float]:
    """Return (3,) scaled down until no axis exceeds `limit`, and by how much (1: not)."""
    largest = float(np.abs(v).max())
    share = limit / largest if largest > limit else 1.0
    return v * share, share


def _bounded(value: float, limit: float) -> float:
    return min(limit, max(-limit, value))


def _finite(*values: Vec3) -> bool:
    return all(math.isfinite(float(v.sum())) for v in values)


def _usable(guidance: Guidance) -> bool:
    """Say whether all that is used of the guidance is finite, and its attitude one."""
    given = [guidance.position]
    given += [v for v in (guidance.velocity, guidance.attitude) if v is not None]
    a = guidance.attitude
    turns = a is None or 0.5 < float(a @ a) < 2.0
    return math.isfinite(guidance.speed) and _finite(*given) and turns


def _no_thrust() -> Wrench:
    return Wrench(np.zeros(3), np.zeros(3))
