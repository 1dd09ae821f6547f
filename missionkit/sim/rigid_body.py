"""The rigid body: 13 states and four rotors, Runge-Kutta, and the ground.

Imported late: it compiles kernels.
"""

from __future__ import annotations

import math

from missionkit.geometry import GRAVITY, Vec3
from missionkit.jit import compiled
from missionkit.planning.rotor_power import RotorModel, rotor_power
from missionkit.sim.kernel_layout import (
    CRASHED,
    DECK_AT,
    DECK_DOWN,
    DECK_HALF,
    DECK_SLOPE,
    DECK_TURN,
    DECK_VELOCITY,
    DT,
    ON_GROUND,
    RATE,
    Body,
)

HARD = 2.0  # m/s, a faster touch of the ground is a crash
STICKING = 0.05  # m/s and rad/s, slower motion on the ground stops
LEVELLING = 0.1 * RATE  # 1/s, at which the ground turns the body level
LEVEL = 1e-9  # rad
CLINGS = 0.002  # m, above the deck it still stands on it, while it slides down its slope
EDGE = 0.15  # m, who is deeper below the deck has hit its side


@compiled
def derivative(x: Vec3, u: Vec3, wind: Vec3, body: Body, out: Vec3) -> None:
    """Write the time derivative (17,) of the state into `out`.

    p' = v;  m v' = m g e3 - T R(q) e3 - (c1 + c2 |v_a|) v_a  with v_a = v - wind;
    q' = q ⊗ (0, ω) / 2;  J ω' = τ - ω × J ω;  f_i' = (u_i - f_i) / lag.
    Rotors: 0 front right, 1 back left, 2 front left, 3 back right; 0 and 1 push the nose right.
    Source: Beard and McLain, "Small Unmanned Aircraft", 2012, ch. 3; rotors: Mahony, 2012.

    Args:
        x: (17,) state, see `kernel_layout`.
        u: (4,) N, thrust wanted of each rotor.
        wind: (3,) m/s, NED.
        body: constants.
        out: (17,) result.
    """
    w, i, j, k = x[6], x[7], x[8], x[9]
    p, q, r = x[10], x[11], x[12]
    lift = (x[13] + x[14] + x[15] + x[16]) / body.mass
    an, ae, ad = x[3] - wind[0], x[4] - wind[1], x[5] - wind[2]
    speed = math.sqrt(an * an + ae * ae + ad * ad)
    drag = (body.drag_linear + body.drag_quadratic * speed) / body.mass
    out[0], out[1], out[2] = x[3], x[4], x[5]
    out[3] = -lift * 2.0 * (i * k + w * j) - drag * an
    out[4] = -lift * 2.0 * (j * k - w * i) - drag * ae
    out[5] = GRAVITY - lift * (1.0 - 2.0 * (i * i + j * j)) - drag * ad
    out[6] = 0.5 * (-i * p - j * q - k * r)
    out[7] = 0.5 * (w * p + j * r - k * q)
    out[8] = 0.5 * (w * q - i * r + k * p)
    out[9] = 0.5 * (w * r + i * q - j * p)
    roll = body.lever * (x[14] + x[15] - x[13] - x[16])
    pitch = body.lever * (x[13] + x[15] - x[14] - x[16])
    yaw = body.yaw_arm * (x[13] + x[14] - x[15] - x[16])
    out[10] = (roll - (body.jz - body.jy) * q * r) / body.jx
    out[11] = (pitch - (body.jx - body.jz) * p * r) / body.jy
    out[12] = (yaw - (body.jy - body.jx) * p * q) / body.jz
    for n in range(4):
        out[13 + n] = (u[n] - x[13 + n]) / body.lag


@compiled
def electrical_power(x: Vec3, wind: Vec3, rotor: RotorModel) -> float:
    """Return the power (W) that the four rotors take from the battery.

    Args:
        x: (17,) state.
        wind: (3,) m/s, NED.
        rotor: constants of one rotor.
    """
    w, i, j, k = x[6], x[7], x[8], x[9]
    an, ae, ad = x[3] - wind[0], x[4] - wind[1], x[5] - wind[2]
    down_n, down_e, down_d = 2.0 * (i * k + w * j), 2.0 * (j * k - w * i), 1 - 2 * (i * i + j * j)
    through = -(an * down_n + ae * down_e + ad * down_d)
    along = math.sqrt(max(0.0, an * an + ae * ae + ad * ad - through * through))
    total = 0.0
    for n in range(13, 17):
        total += rotor_power(x[n], along, through, rotor)
    return total


@compiled
def advance(x: Vec3, u: Vec3, wind: Vec3, body: Body, dt: float, work: Vec3) -> None:
    """Move the state one step of `dt` (s), in place: classical Runge-Kutta of order four.

    Rotor commands and wind are constant over the step; `work` is (5, 17) of scratch space.

    Args:
        x: (17,) state, changed in place.
        u: (4,), N, commanded thrust of each rotor.
        wind: (3,), m/s, NED.
        body: mass, inertia, drag and rotors.
        dt: s.
        work: (5, 17), scratch space.
    """
    derivative(x, u, wind, body, work[0])
    for stage in range(1, 4):
        part = dt if stage == 3 else 0.5 * dt
        for n in range(17):
            work[4, n] = x[n] + part * work[stage - 1, n]
        derivative(work[4], u, wind, body, work[stage])
    for n in range(17):
        slope = work[0, n] + 2.0 * work[1, n] + 2.0 * work[2, n] + work[3, n]
        x[n] += dt / 6.0 * slope
    size = math.sqrt(x[6] * x[6] + x[7] * x[7] + x[8] * x[8] + x[9] * x[9])
    for n in range(6, 10):
        x[n] /= size


@compiled
def drive_deck(memory: Vec3) -> None:
    """Move the deck by one step, and turn its course.

    Args:
        memory: by `kernel_layout`, changed in place.
    """
    turn = memory[DECK_TURN] * DT
    c, s = math.cos(turn), math.sin(turn)
    north, east = memory[DECK_VELOCITY], memory[DECK_VELOCITY + 1]
    memory[DECK_VELOCITY] = c * north - s * east
    memory[DECK_VELOCITY + 1] = s * north + c * east
    memory[DECK_AT] += 0.5 * DT * (north + memory[DECK_VELOCITY])
    memory[DECK_AT + 1] += 0.5 * DT * (east + memory[DECK_VELOCITY + 1])


@compiled
def over_deck(x: Vec3, memory: Vec3) -> bool:
    """Say whether the body is above the deck, or inside it.

    Args:
        x: (17,) state.
        memory: by `kernel_layout`.
    """
    half = memory[DECK_HALF]
    north, east = x[0] - memory[DECK_AT], x[1] - memory[DECK_AT + 1]
    return bool(half > 0.0 and abs(north) <= half and abs(east) <= half)


@compiled
def surface(x: Vec3, memory: Vec3) -> float:
    """Return how far down (m, NED) the deck is where the body is over it.

    Args:
        x: (17,) state.
        memory: by `kernel_layout`.
    """
    north, east = x[0] - memory[DECK_AT], x[1] - memory[DECK_AT + 1]
    return float(memory[DECK_DOWN] + memory[DECK_SLOPE] * north + memory[DECK_SLOPE + 1] * east)


@compiled
def touch(x: Vec3, memory: Vec3) -> None:
    """Keep the body on or above the ground or the deck; a touch faster than `HARD` is a crash.

    The feet are the origin of the body: at rest on the ground the position is (n, e, 0). Contact
    takes away the sinking speed at once, sliding and spin within some tens of milliseconds, and
    turns the body level with what it stands on as fast, by its rates: ω = -k (φ, θ), with the tilt
    from the normal in body axes. A deck that drives takes the body along.

    Args:
        x: (17,) state, changed in place.
        memory: by `kernel_layout`, changed in place.
    """
    floor, slope_n, slope_e, drive_n, drive_e = 0.0, 0.0, 0.0, 0.0, 0.0
    if over_deck(x, memory):
        floor = surface(x, memory)
        slope_n, slope_e = memory[DECK_SLOPE], memory[DECK_SLOPE + 1]
        drive_n, drive_e = memory[DECK_VELOCITY], memory[DECK_VELOCITY + 1]
        if x[2] > floor + EDGE:
            memory[CRASHED] = 1.0
        if memory[ON_GROUND] > 0.0 and floor - CLINGS < x[2] < floor and x[5] > -STICKING:
            x[2] = floor
    grounded = x[2] >= floor
    memory[ON_GROUND] = 1.0 if grounded else 0.0
    if not grounded:
        return
    if x[5] > HARD:
        memory[CRASHED] = 1.0
    x[2] = floor
    x[5] = min(0.0, x[5])
    north, east = x[3] - drive_n, x[4] - drive_e
    x[3] = drive_n + (0.85 * north if abs(north) > STICKING else 0.0)
    x[4] = drive_e + (0.85 * east if abs(east) > STICKING else 0.0)
    x[12] = 0.85 * x[12] if abs(x[12]) > STICKING else 0.0
    w, i, j, k = x[6], x[7], x[8], x[9]
    size = math.sqrt(1.0 + slope_n * slope_n + slope_e * slope_e)
    n, e, d = -slope_n / size, -slope_e / size, 1.0 / size  # the normal, downwards, R^T n:
    roll = 2.0 * (i * j - w * k) * n + (1 - 2 * (i * i + k * k)) * e + 2.0 * (j * k + w * i) * d
    pitch = (1 - 2 * (j * j + k * k)) * n + 2.0 * (i * j + w * k) * e + 2.0 * (i * k - w * j) * d
    x[10] = -LEVELLING * roll if abs(roll) > LEVEL else 0.0
    x[11] = LEVELLING * pitch if abs(pitch) > LEVEL else 0.0
