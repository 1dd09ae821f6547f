"""From what a behaviour wants to the setpoint that is flown: the mission's `control:` section."""

from __future__ import annotations

import math
from typing import ClassVar, NamedTuple

import numpy as np
from pydantic import Field

from missionkit.control import disturbance_observer, half_space, pid
from missionkit.control.disturbance_observer import DisturbanceObserver, Observed
from missionkit.control.pid import Gains, PidMemory, Tracking
from missionkit.control.velocity_limits import (
    ZERO,
    Limits,
    Triple,
    finite,
)
from missionkit.control.velocity_smoothing import alpha_at, smoothed
from missionkit.control.yaw_law import YawLaw, YawMemory
from missionkit.geometry import Vec3
from missionkit.messages import Estimate, Guidance, HalfSpace, Mode, Setpoint
from missionkit.plugin import Plugin
from missionkit.units import Fraction

LONGEST_STEP = 0.2  # s; after a longer gap the acceleration limit must not allow a leap
PUSHED_SPEED = 0.3  # m/s of avoidance above which the integrator waits
CUT = 0.05  # m/s, the same of what a bound takes off


class ControlMemory(NamedTuple):
    """Memory of the controller between steps."""

    pid: PidMemory = PidMemory()
    yaw: YawMemory = YawMemory()
    velocity: Triple = ZERO  # m/s, NED, as commanded last
    pushed: bool = False  # avoidance was at work
    observed: Observed = Observed()

    def having_sent(self, setpoint: Setpoint) -> ControlMemory:
        """Return the memory after what was sent, which others may have limited since."""
        north, east, down = setpoint.velocity.tolist()
        return self._replace(observed=self.observed._replace(sent=(north, east, down)))


class Control(Plugin):
    """Velocity and yaw rate from guidance.

    u = PID_m(p_desired - p) + α_ff v_ref, at most the guidance's speed; plus the potential
    field's push; within the limits; then v(t) = α u + (1 - α) v(t-1), slewed at most at the
    acceleration limit. Without guidance, or with one that is not finite, the velocity goes to
    zero as fast as the limits allow and the yaw stays.

    With an `observer` the velocity sent is corrected for what disturbs the vehicle: wind, and what
    the autopilot's own integral holds after braking; the modes' integrals can then be 0.

    The modes differ in their gains. What the integrators hold is a velocity and carries over,
    so a change of mode makes no bump; it is forgotten when there is no guidance.

    Sources: P1 sections 3.2, 3.3, 4.2 and 6.2.
    """

    kind: ClassVar[str] = "velocity_pid"
    setpoint: ClassVar[str] = "velocity"

    gps: Gains = Gains()
    visual: Gains = Gains(kp=(3.0, 2.0), ki=(1.0, 1.0), kd=(0.8, 0.25))
    trajectory: Gains = Gains(kp=(1.0, 1.0), kd=(0.2, 0.1))
    alpha_ff: Fraction = 1.0
    alpha: Fraction = 0.8  # at 20 Hz
    yaw: YawLaw = YawLaw()
    limits: Limits = Limits()
    observer: DisturbanceObserver | None = Field(
        default=None, description="of what keeps the vehicle from flying what it is sent"
    )

    def begin(self) -> ControlMemory:
        """Return the memory at the start: at rest."""
        return ControlMemory()

    def step(
        self,
        memory: ControlMemory,
        mode: Mode,
        guidance: Guidance | None,
        seen: Estimate,
        dt: float,
        *,
        push: Vec3 | None = None,
        bound: HalfSpace | None = None,
    ) -> tuple[Setpoint, ControlMemory]:
        """Return the setpoint and the next memory.

        Args:
            memory: what this returned a step ago.
            mode: chooses the gains; NONE gives zero at once.
            guidance: what the behaviour wants; None to stand still.
            seen: the estimate at this tick.
            dt: time since the last step (s).
            push: (3,), m/s, NED, avoidance, used where the guidance allows it.
            bound: where the vehicle must stay, if anywhere.
        """
        wanted, memory = self.aim(memory, mode, guidance, seen, dt)
        return self.fly(memory, wanted, guidance, seen, dt, push=push, bound=bound)

    def aim(
        self,
        memory: ControlMemory,
        mode: Mode,
        guidance: Guidance | None,
        seen: Estimate,
        dt: float,
    ) -> tuple[Triple | None, ControlMemory]:
        """Return the velocity (m/s, NED) that leads to the goal if nothing is in the way.

        This is the first half of `step`: it is what obstacle avoidance wants to know. None in
        mode NONE, when the autopilot flies by itself.

        Args:
            memory: of the previous tick.
            mode: gains to use.
            guidance: goal and speed of the behaviour, if it has any.
            seen: the estimate of this tick.
            dt: s since the previous tick.
        """
        if mode is Mode.NONE:
            return None, self.begin()
        track = _tracking(guidance, seen, self.alpha_ff, blocked=memory.pushed)
        if track is None:
            return ZERO, memory._replace(pid=PidMemory())
        gains = self.gains_of(mode)
        wanted, charge = pid.step(gains, self.limits, memory.pid, track, _sane(dt))
        return wanted, memory._replace(pid=charge)

    def fly(
        self,
        memory: ControlMemory,
        wanted: Triple | None,
        guidance: Guidance | None,
        seen: Estimate,
        dt: float,
        *,
        push: Vec3 | None = None,
        bound: HalfSpace | None = None,
    ) -> tuple[Setpoint, ControlMemory]:
        """Turn what `aim` wanted into a setpoint: the second half of `step`.

        The `bound` has the last word, which no comfort limit slows.

        Args:
            memory: as `aim` returned it.
            wanted: (3,), m/s, NED, from `aim`.
            guidance: the same as for `aim`.
            seen: the estimate of this tick.
            dt: s since the previous tick.
            push: (3,), m/s, NED, of obstacle avoidance.
            bound: half space that must not be left.
        """
        if wanted is None:
            return Setpoint(np.zeros(3), 0.0), self.begin()
        shove = _shove(guidance, push)
        pushed = abs(shove[0]) + abs(shove[1]) + abs(shove[2]) > PUSHED_SPEED
        total = (wanted[0] + shove[0], wanted[1] + shove[1], wanted[2] + shove[2])
        dt = _sane(dt)
        last = memory.velocity
        smooth = smoothed(last, self.limits.bounded(total), alpha_at(self.alpha, dt))
        velocity = self.limits.slewed(last, smooth, dt)
        sent, observed = self._corrected(velocity, memory.observed, seen, dt)
        if bound is not None:
            free, sent = sent, half_space.kept(sent, seen, bound, self.limits)
            velocity = sent
            pushed = pushed or math.dist(free, sent) > CUT
        rate, look = self._turn(memory.yaw, guidance, seen)
        setpoint = finite(Setpoint(np.array(sent), rate))
        if setpoint is None:
            return Setpoint(np.zeros(3), 0.0), self.begin()
        flown = ControlMemory(memory.pid, look, velocity, pushed, observed)
        return setpoint, flown.having_sent(setpoint)

    def _corrected(
        self, velocity: Triple, observed: Observed, seen: Estimate, dt: float
    ) -> tuple[Triple, Observed]:
        """Return the velocity (3,), m/s, NED, less what disturbs it, and the observer's memory."""
        if self.observer is None:
            return velocity, observed
        north, east, down = seen.velocity.tolist()
        observed = disturbance_observer.observed(self.observer, observed, (north, east, down), dt)
        more = disturbance_observer.correction(self.observer, observed)
        sent = (velocity[0] + more[0], velocity[1] + more[1], velocity[2] + more[2])
        return self.limits.bounded(sent), observed

    def gains_of(self, mode: Mode) -> Gains:
        """Return the gains that a mode flies with."""
        if mode is Mode.VISUAL:
            return self.visual
        return self.trajectory if mode is Mode.TRAJECTORY else self.gps

    def _turn(
        self, memory: YawMemory, guidance: Guidance | None, seen: Estimate
    ) -> tuple[float, YawMemory]:
        yaw = seen.yaw
        if not math.isfinite(yaw):
            return 0.0, memory
        if guidance is None:
            held = yaw if memory.held is None else memory.held
            return self.yaw.rate(held, yaw), YawMemory(None, held)
        if guidance.yaw is not None:
            if not math.isfinite(guidance.yaw):
                return 0.0, memory
            return self.yaw.rate(guidance.yaw, yaw), YawMemory(None, guidance.yaw)
        to, at = guidance.position.tolist(), seen.position.tolist()
        offset = (to[0] - at[0], to[1] - at[1])
        north, east, _ = seen.velocity.tolist()
        if not math.isfinite(offset[0] + offset[1] + north + east):
            return 0.0, memory
        end = guidance.final_yaw
        end = end if end is not None and math.isfinite(end) else None
        desired, memory = self.yaw.desired(memory, offset, (north, east), yaw, target=end)
        return self.yaw.rate(desired, yaw), memory


def _tracking(
    guidance: Guidance | None, seen: Estimate, alpha_ff: float, *, blocked: bool
) -> Tracking | None:
    """Return errors and feed-forward, or None when there is no guidance or it is not finite."""
    if guidance is None:
        return None
    tx, ty, tz = guidance.position.tolist()
    px, py, pz = seen.position.tolist()
    vx, vy, vz = seen.velocity.tolist()
    rx, ry, rz = ZERO if guidance.velocity is None else guidance.velocity.tolist()
    error = (tx - px, ty - py, tz - pz)
    rate = (rx - vx, ry - vy, rz - vz)
    if not math.isfinite(sum(error) + sum(rate) + rx + ry + rz + guidance.speed):
        return None
    forward = (alpha_ff * rx, alpha_ff * ry, alpha_ff * rz)
    return Tracking(error, rate, max(0.0, guidance.speed), forward, blocked)


def _shove(guidance: Guidance | None, push: Vec3 | None) -> Triple:
    if push is None or guidance is None or not guidance.avoid:
        return ZERO
    x, y, z = push.tolist()
    return (x, y, z) if math.isfinite(x + y + z) else ZERO


def _sane(dt: float) -> float:
    return min(LONGEST_STEP, dt) if dt > 0.0 else 0.0
