"""The simulated inner autopilot: modes, velocity, attitude and rate loops, mixer.

Imported late: it compiles kernels. It never sees the true state alone: its own position and
velocity carry errors that grow while there is no GNSS.
"""

from __future__ import annotations

import math

from missionkit.geometry import GRAVITY, Vec3, yaw_of
from missionkit.jit import compiled
from missionkit.sim import kernel_layout as at
from missionkit.sim.kernel_layout import Body, LoopGains

HOLD_GAIN = 0.9  # 1/s
HOLD_SPEED = 1.5  # m/s
LEAK = 0.1  # 1/s, pulls its position error to zero while there is GNSS
heading = compiled(yaw_of)


@compiled
def blur(memory: Vec3, noise: Vec3, gains: LoopGains) -> None:
    """Advance the errors of the autopilot's own velocity and position by one step.

    Velocity error: Gauss-Markov with GNSS, random walk without, about the bias of a fault. Position
    error: its integral, leaking to zero with GNSS, but not where optical flow takes its place. The
    vertical leans on the barometer: never lost, and half as large.

    Args:
        memory: of the autopilot, changed in place.
        noise: (3,) standard normal.
        gains: of the autopilot.
    """
    for n in range(3):
        fixed = memory[at.GNSS_OK] > 0.0 or n == 2
        keep = gains.error_keep if fixed else 1.0
        kick = gains.error_kick if fixed else gains.drift_kick
        leak = LEAK if memory[at.GNSS_OK] > at.FLOW_AIDED or n == 2 else 0.0
        if n == 2:
            kick *= 0.5
        bias = memory[at.VELOCITY_BIAS + n]
        v = keep * (memory[at.VELOCITY_ERROR + n] - bias) + kick * noise[n] + bias
        memory[at.VELOCITY_ERROR + n] = v
        memory[at.POSITION_ERROR + n] += (v - leak * memory[at.POSITION_ERROR + n]) * at.DT


@compiled
def switch(x: Vec3, memory: Vec3, now: float, gains: LoopGains) -> None:
    """Take over the setpoint that has arrived; fall back to hold when none came for too long.

    Args:
        x: (17,) true state.
        memory: of the autopilot, changed in place.
        now: s.
        gains: of the autopilot.
    """
    if memory[at.DUE_AT] <= now:
        for n in range(4):
            memory[at.COMMANDED + n] = memory[at.DUE + n]
        memory[at.COMMANDED_AT] = memory[at.DUE_AT]
        memory[at.DUE_AT] = math.inf
        if memory[at.ARMED] > 0.0 and memory[at.MODE] != at.OFFBOARD:
            memory[at.MODE] = at.OFFBOARD
            memory[at.HEADING] = heading(x[6:10])
    if memory[at.MODE] == at.OFFBOARD and now - memory[at.COMMANDED_AT] > gains.patience:
        memory[at.MODE] = at.HOLD
        memory[at.ANCHORED] = 0.0
    landed = memory[at.MODE] == at.LAND and memory[at.ON_GROUND] > 0.0
    if not landed:
        memory[at.LANDED_AT] = math.inf
    elif memory[at.LANDED_AT] == math.inf:
        memory[at.LANDED_AT] = now
    elif now - memory[at.LANDED_AT] >= 1.0:
        memory[at.ARMED] = 0.0
        memory[at.MODE] = at.HOLD


@compiled
def stay(x: Vec3, memory: Vec3, want: Vec3) -> None:
    """Write into `want` the velocity that brakes, then holds the point where it stopped.

    Args:
        x: (17,) true state.
        memory: of the autopilot.
        want: (4,), m/s and rad/s, written.
    """
    vn, ve = x[3] + memory[at.VELOCITY_ERROR], x[4] + memory[at.VELOCITY_ERROR + 1]
    want[0], want[1], want[2] = 0.0, 0.0, 0.0
    if memory[at.ANCHORED] == 0.0:
        if math.sqrt(vn * vn + ve * ve) > 0.4:
            return
        for n in range(3):
            memory[at.ANCHOR + n] = x[n] + memory[at.POSITION_ERROR + n]
        memory[at.ANCHORED] = 1.0
    for n in range(3):
        gap = memory[at.ANCHOR + n] - x[n] - memory[at.POSITION_ERROR + n]
        want[n] = max(-HOLD_SPEED, min(HOLD_SPEED, HOLD_GAIN * gap))


@compiled
def decide(x: Vec3, memory: Vec3, gains: LoopGains, want: Vec3) -> None:
    """Write the velocity and yaw rate (4,) wanted in the present mode into `want`.

    Args:
        x: (17,) true state.
        memory: of the autopilot, changed in place.
        gains: of the autopilot.
        want: (4,), m/s and rad/s, written.
    """
    mode = memory[at.MODE]
    want[3] = 0.0
    if mode == at.OFFBOARD:
        for n in range(4):
            want[n] = memory[at.COMMANDED + n]
        return
    stay(x, memory, want)
    height = -(x[2] + memory[at.POSITION_ERROR + 2])
    if mode == at.TAKE_OFF:
        gap = memory[at.HEIGHT] - height
        want[2] = -max(-gains.rise, min(gains.rise, 1.5 * gap))
        if abs(gap) < 0.1:
            memory[at.MODE] = at.HOLD
            memory[at.ANCHOR + 2] = -memory[at.HEIGHT]
    elif mode == at.LAND:
        want[2] = gains.descent if height > 1.5 else gains.flare


@compiled
def accelerate(x: Vec3, memory: Vec3, now: float, gains: LoopGains, want: Vec3, push: Vec3) -> None:
    """Write the acceleration (3,), m/s², NED, that brings the velocity to `want` into `push`.

    a = k (v_want - v) + i, with i the clamped integral of k_i (v_want - v). A loop that is too slow
    wants the same until its next turn.

    Args:
        x: (13,) state.
        memory: by `kernel_layout`, changed in place.
        now: s.
        gains: and limits of the loop.
        want: (3,), m/s, NED.
        push: (3,), overwritten.
    """
    dt = max(at.DT, memory[at.LOOP_PERIOD])
    if dt > at.DT and now < memory[at.LOOP_DUE] - 1e-9:
        for n in range(3):
            push[n] = memory[at.PUSH + n]
        return
    memory[at.LOOP_DUE] = now + dt
    for n in range(3):
        error = want[n] - x[3 + n] - memory[at.VELOCITY_ERROR + n]
        gain = gains.climb if n == 2 else gains.velocity
        push[n] = gain * error + memory[at.INTEGRAL + n]
        if abs(gain * error) < gains.integral_zone:  # else it would wind up
            total = memory[at.INTEGRAL + n] + gains.integral * error * dt
            limit = gains.integral_limit
            memory[at.INTEGRAL + n] = max(-limit, min(limit, total))
    size = math.sqrt(push[0] * push[0] + push[1] * push[1])
    if size > gains.acceleration:
        push[0] *= gains.acceleration / size
        push[1] *= gains.acceleration / size
    push[2] = max(-4.0, min(3.0, push[2]))
    for n in range(3):
        memory[at.PUSH + n] = push[n]


@compiled
def mix(x: Vec3, push: Vec3, spin: float, body: Body, gains: LoopGains, u: Vec3) -> None:
    """Write the rotor thrusts (4,), N, that turn the thrust axis to `push` into `u`.

    With t = a - g e3 the wanted body axis is z = -t/|t|; the tilt error is the rotation axis
    e = z_body × z, in body axes; ω_want = k e; τ = J k_ω (ω_want - ω).
    Source: Mellinger and Kumar, 2011, reduced to the tilt (yaw is a rate).

    Args:
        x: (17,) true state.
        push: (3,), m/s², NED, wanted without gravity.
        spin: rad/s, wanted yaw rate.
        body: mass, inertia and rotors.
        gains: of the autopilot.
        u: (4,), N, written.
    """
    w, i, j, k = x[6], x[7], x[8], x[9]
    tn, te, td = -push[0], -push[1], GRAVITY - push[2]
    size = math.sqrt(tn * tn + te * te + td * td)
    # the wanted axis in body axes, R^T z:
    right = 2.0 * (i * j - w * k) * tn + (1 - 2 * (i * i + k * k)) * te + 2 * (j * k + w * i) * td
    ahead = (1 - 2 * (j * j + k * k)) * tn + 2.0 * (i * j + w * k) * te + 2 * (i * k - w * j) * td
    along = 2 * (i * k + w * j) * tn + 2 * (j * k - w * i) * te + (1 - 2 * (i * i + j * j)) * td
    limit = gains.rate_limit
    p = max(-limit, min(limit, -gains.attitude * right / size))
    q = max(-limit, min(limit, gains.attitude * ahead / size))
    r = max(-gains.yaw_rate, min(gains.yaw_rate, spin))
    roll = body.jx * gains.rate * (p - x[10]) / (4.0 * body.lever)
    pitch = body.jy * gains.rate * (q - x[11]) / (4.0 * body.lever)
    twist = 0.5 * body.jz * gains.rate * (r - x[12]) / (4.0 * body.yaw_arm)
    lift = max(0.0, body.mass * along / 4.0)
    u[0] = lift - roll + pitch + twist
    u[1] = lift + roll - pitch + twist
    u[2] = lift + roll + pitch - twist
    u[3] = lift - roll - pitch - twist
    for n in range(4):
        u[n] = max(0.02 * body.full, min(body.full, u[n]))


@compiled
def command(
    x: Vec3, memory: Vec3, now: float, body: Body, gains: LoopGains, work: Vec3, u: Vec3
) -> None:
    """Write the rotor thrusts (4,), N, wanted at time `now` (s) into `u`.

    Args:
        x: (17,) true state.
        memory: (SIZE,) of the autopilot, changed in place.
        now: s.
        body: constants.
        gains: constants.
        work: (2, 4) scratch space.
        u: (4,) result.
    """
    switch(x, memory, now, gains)
    want, push = work[0], work[1]
    decide(x, memory, gains, want)
    alive = memory[at.ARMED] > 0.0 and memory[at.CRASHED] == 0.0 and memory[at.POWERED] > 0.0
    climbing = (memory[at.MODE] == at.OFFBOARD or memory[at.MODE] == at.TAKE_OFF) and want[2] < -0.1
    if not alive or (memory[at.ON_GROUND] > 0.0 and not climbing):
        for n in range(4):
            u[n] = 0.05 * body.full if alive else 0.0
        for n in range(3):
            memory[at.INTEGRAL + n] = 0.0
        memory[at.HEADING] = heading(x[6:10])
        return
    accelerate(x, memory, now, gains, want, push)
    turn = (memory[at.HEADING] + want[3] * at.DT - heading(x[6:10]) + math.pi) % (
        2 * math.pi
    ) - math.pi
    turn = max(-0.3, min(0.3, turn))
    memory[at.HEADING] = heading(x[6:10]) + turn
    mix(x, push, want[3] + 2.0 * turn, body, gains, u)
