"""The landing path that takes the least energy: sideways as fast as allowed, down late.

In the vertical plane through the vehicle and the pad. Level: acceleration to a speed v, at which it
flies, and braking to rest over the pad. Vertical: from rest to a rate d, steady, and slower again
to the speed of touch-down, so timed that it ends over the pad and not before the vehicle is there.

    min over v, d of  E = ∫ P(velocity, acceleration) dt

with P of `rotor_power`. Some 140 W are spent whatever is done, so time is what counts; when the
descent happens hardly matters as long as it costs no time (a rotor gets most out of a descent in
fast forward flight, some percent). Among the paths within `SLACK` of the least energy the latest
descent is taken, as in P3: high up there is more to see and less to hit. A `gate` keeps the path
above a height until it is near: what a camera needs that has not seen the pad yet.

Source: P3 section VI-B, correction P3.6. That two trapezoids are enough is checked against a direct
transcription with free accelerations (`tests/planning/test_energy_optimal.py`).
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.geometry import Mat, Vec3
from missionkit.jit import compiled
from missionkit.planning.landing_profiles import (
    LandingLimits,
    descent_begins,
    level_at,
    level_times,
    vertical_at,
    vertical_marks,
)
from missionkit.planning.rotor_power import RotorModel, flight_powers

SLACK = 0.015  # of the least energy, given away for a late descent
SAMPLES = 48  # of a path's power
ROUNDS, SPEEDS, RATES = 3, 9, 7  # of the search, each round within the last one's neighbours
LATE = 12  # rates tried from the fastest on
LEAST = 0.05  # m/s, slowest speed tried


class Airframe(NamedTuple):
    """Mass, drag and rotors of a multicopter."""

    mass: float  # kg
    drag: float  # N/(m/s)²
    rotor: RotorModel


class Gate(NamedTuple):
    """The path stays above `height` (m) while the pad is farther than `distance` (m, level)."""

    distance: float = 0.0
    height: float = 0.0


NO_GATE = Gate()


class LandingPath(NamedTuple):
    """A path to the pad, from now to touch-down."""

    times: Vec3  # (n,), s, from 0
    left: Vec3  # (n,), m, level distance left
    height: Vec3  # (n,), m, above the pad
    speed: Vec3  # (n,), m/s, level
    descent: Vec3  # (n,), m/s
    energy: float  # J

    @property
    def top_speed(self) -> float:
        """The largest level speed (m/s)."""
        return float(self.speed.max())


@compiled
def flown(
    distance: float,
    height: float,
    closing: float,
    chosen: tuple[float, float],
    limits: LandingLimits,
    gate: Vec3,
    count: int,
) -> Mat:
    """Return (count, 7) of a path: time, way, fallen, speeds and accelerations, level and down.

    Args:
        distance: to the pad at the start, level, m.
        height: above the pad at the start, m.
        closing: speed towards the pad at the start, m/s.
        chosen: top speed and rate of descent, m/s.
        limits: of speeds and accelerations.
        gate: (2,), distance and height, m.
        count: of rows, evenly spaced in time.

    Returns:
        SI; level away from the start, down positive.
    """
    marks = np.empty((2, 4))
    marks[0] = level_times(distance, closing, chosen[0], limits)
    marks[1] = vertical_marks(height, chosen[1], limits)
    begin = descent_begins(distance, height, closing, marks, limits, gate)
    end = max(marks[0, 2], begin + marks[1, 2])
    out, step = np.zeros((count, 7)), end / count
    for n in range(count):
        t = end * n / (count - 1)
        out[n, 0] = t
        out[n, 1], out[n, 3] = level_at(t, closing, marks[0])
        out[n, 2], out[n, 4] = vertical_at(t - begin, marks[1], limits)
        _, ahead = level_at(t + 0.5 * step, closing, marks[0])
        _, behind = level_at(max(0.0, t - 0.5 * step), closing, marks[0])
        out[n, 5] = (ahead - behind) / step
        _, ahead = vertical_at(t + 0.5 * step - begin, marks[1], limits)
        _, behind = vertical_at(t - 0.5 * step - begin, marks[1], limits)
        out[n, 6] = (ahead - behind) / step
    return out


@compiled
def energy_of(rows: Mat, mass: float, drag: float, rotor: RotorModel) -> float:
    """Return the energy (J) of a path (n, 7) by the trapezoidal rule.

    Args:
        rows: (n, 7) of `flown`, evenly spaced in time.
        mass: kg.
        drag: of the airframe, N/(m/s)².
        rotor: constants of each of the four rotors.
    """
    n = len(rows)
    velocity, acceleration = np.zeros((n, 3)), np.zeros((n, 3))
    velocity[:, 0], velocity[:, 2] = rows[:, 3], rows[:, 4]
    acceleration[:, 0], acceleration[:, 2] = rows[:, 5], rows[:, 6]
    watts = flight_powers(velocity, acceleration, mass, drag, rotor)
    step = rows[1, 0] - rows[0, 0]
    return float(step * (watts.sum() - 0.5 * (watts[0] + watts[-1])))


@compiled
def search(
    distance: float,
    height: float,
    closing: float,
    limits: LandingLimits,
    gate: Vec3,
    mass: float,
    drag: float,
    rotor: RotorModel,
) -> tuple[float, float]:
    """Return the top speed and the rate of descent (m/s) of the cheapest path, or a late one.

    Args:
        distance: to the pad at the start, level, m.
        height: above the pad at the start, m.
        closing: speed towards the pad at the start, m/s.
        limits: of speeds and accelerations.
        gate: (2,), distance and height, m.
        mass: kg.
        drag: of the airframe, N/(m/s)².
        rotor: constants of each of the four rotors.
    """
    low, high = LEAST, limits.speed
    slow, fast = max(LEAST, limits.touch_down), limits.descent
    best, speed, rate = math.inf, high, fast
    for _ in range(ROUNDS):
        du, dr = (high - low) / (SPEEDS - 1), (fast - slow) / (RATES - 1)
        for i in range(SPEEDS):
            for j in range(RATES):
                u, r = high - i * du, fast - j * dr
                rows = flown(distance, height, closing, (u, r), limits, gate, SAMPLES)
                cost = energy_of(rows, mass, drag, rotor)
                if cost < best:
                    best, speed, rate = cost, u, r
        low, high = max(LEAST, speed - du), min(limits.speed, speed + du)
        slow, fast = max(slow, rate - dr), min(limits.descent, rate + dr)
    for j in range(LATE):
        r = limits.descent + (rate - limits.descent) * j / LATE
        rows = flown(distance, height, closing, (speed, r), limits, gate, SAMPLES)
        if energy_of(rows, mass, drag, rotor) <= (1.0 + SLACK) * best:
            return speed, r
    return speed, rate


def plan(
    distance: float,
    height: float,
    airframe: Airframe,
    limits: LandingLimits,
    gate: Gate = NO_GATE,
    closing: float = 0.0,
) -> LandingPath:
    """Return the cheapest path to a pad; deterministic, some milliseconds.

    Args:
        distance: to the pad, level (m), not negative.
        height: above the pad (m), not negative.
        airframe: what flies.
        limits: of speeds and accelerations.
        gate: kept on the way in; no gate by default.
        closing: level speed towards the pad at the start (m/s); flying away counts as none.
    """
    distance, height, closing = max(1e-3, distance), max(1e-3, height), max(0.0, closing)
    kept = np.array(gate)
    chosen = search(distance, height, closing, limits, kept, *airframe)
    rows = flown(distance, height, closing, chosen, limits, kept, SAMPLES)
    return LandingPath(
        times=rows[:, 0],
        left=np.maximum(0.0, distance - rows[:, 1]),
        height=np.maximum(0.0, height - rows[:, 2]),
        speed=rows[:, 3],
        descent=rows[:, 4],
        energy=float(energy_of(rows, *airframe)),
    )
