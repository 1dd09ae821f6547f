"""Effects of faults on the simulated body, its inner autopilot and its satellite fixes."""

from __future__ import annotations

import math

from missionkit.geometry import Vec3, norm, vec
from missionkit.sim.fault_injection import InjectedFaults

TURN, ONSET = 60.0, 2.0  # s, of a velocity bias: once round, and until it has grown


def extra_wind(injected: InjectedFaults, mean_wind: Vec3, now: float) -> Vec3 | None:
    """Return the wind (3,), m/s, NED, that a gust adds along the mean wind; None without one.

    Args:
        injected: the faults of the run.
        mean_wind: (3,), m/s, NED; without one a gust blows to the north.
        now: s.
    """
    gust = injected.since("wind_gust", now)
    if gust is None:
        return None
    size = norm(mean_wind)
    along = mean_wind / size if size > 0.0 else vec(1.0, 0.0, 0.0)
    return gust[0] * along


def velocity_bias(injected: InjectedFaults, now: float) -> Vec3:
    """Return the bias (3,), m/s, NED, of the autopilot's own velocity at `now` (s)."""
    bias = injected.since("velocity_bias", now)
    return vec(0.0, 0.0, 0.0) if bias is None else turning(*bias)


def control_period(injected: InjectedFaults, now: float) -> float:
    """Return the period (s) of a slowed velocity loop at `now` (s); 0: that of the physics."""
    slow = injected.since("control_slow", now)
    return 0.0 if slow is None else slow[0]


def satellite_offset(injected: InjectedFaults, now: float) -> Vec3:
    """Return by how much (3,), m, NED, fixes are off at `now` (s): a jump and a drift."""
    jump = injected.since("gnss_jump", now) or (0.0, 0.0)
    drift = injected.since("gnss_drift", now) or (0.0, 0.0)
    return vec(jump[0] + drift[0] * drift[1], 0.0, 0.0)


def turning(size: float, age: float) -> Vec3:
    """Return the bias (3,), m/s, NED, of the autopilot's own velocity at its `age` (s)."""
    size *= min(1.0, age / ONSET)
    angle = 2.0 * math.pi * age / TURN
    return vec(size * math.cos(angle), size * math.sin(angle), 0.0)
