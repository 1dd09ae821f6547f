"""Flights of the envelope study: speeds, wind from all sides, gusts at work, random faults."""

from __future__ import annotations

import math

import numpy as np

from missionkit.sim.fault_injection import FAULT_KINDS
from studies.envelope_flight import Trouble

WINDY, TURBULENT = 7.0, 2.0  # m/s, mean and standard deviation of the gusts
STRONGEST = 8.0  # m/s, mean wind and a fault's gust together
SLOWEST, FASTEST = 3.0, 8.0  # m/s, cruise
MOMENTS = (("gps", 15.0), ("visual", 6.0), ("task", 4.0), ("return", 10.0))
LONGEST = 12.0  # s
UNUSED = frozenset(("camera_flipped", "range_lost"))  # these flights use no such sensor or picture


def groups(seeds: int, random: int, first: int) -> dict[str, list[Trouble]]:
    """Return the flights of each group by its name.

    Args:
        seeds: flights of each group but the last.
        random: flights of the last one.
        first: the first seed.
    """
    numbers = range(first, first + seeds)
    found = {f"cruise {v} m/s": [Trouble(n, float(v)) for n in numbers] for v in (5, 6, 7, 8)}
    found[f"wind {WINDY:g} m/s, gusts {TURBULENT:g} m/s"] = [
        Trouble(n, 5.0, _blowing(WINDY, 2.4 * n), TURBULENT) for n in numbers
    ]
    for state in ("visual", "task"):
        fault = (f"wind_gust=8@{state}:1+3",)
        found[f"a gust of 8 m/s in {state}"] = [Trouble(n, 5.0, faults=fault) for n in numbers]
    found["random search"] = [chosen(n) for n in range(first, first + random)]
    return {name: group for name, group in found.items() if group}


def chosen(seed: int) -> Trouble:
    """Return a speed, a wind and one or two faults by chance."""
    rng = np.random.default_rng(seed)
    wind = STRONGEST * rng.random()
    faults = tuple(_fault(rng, STRONGEST - wind) for _ in range(rng.integers(1, 3)))
    cruise = round(SLOWEST + (FASTEST - SLOWEST) * rng.random(), 1)
    direction = math.tau * rng.random()
    return Trouble(
        seed, cruise, _blowing(wind, direction), round(TURBULENT * rng.random(), 1), faults
    )


def _fault(rng: np.random.Generator, gust: float) -> str:
    kind = str(rng.choice(sorted(FAULT_KINDS.keys() - UNUSED)))
    state, within = MOMENTS[rng.integers(len(MOMENTS))]
    value = FAULT_KINDS[kind].value
    said = "" if value is None else f"={_value(kind, value, rng, gust):.2f}"
    when = f"@{state}:{within * rng.random():.1f}"
    stays = rng.random() < 0.3
    return f"{kind}{said}{when}" + ("" if stays else f"+{1.0 + LONGEST * rng.random():.1f}")


def _value(kind: str, usual: float, rng: np.random.Generator, gust: float) -> float:
    if kind == "wind_gust":
        return gust * float(rng.random())
    return min(FAULT_KINDS[kind].most, usual * (0.5 + float(rng.random())))


def _blowing(speed: float, direction: float) -> tuple[float, float]:
    return round(speed * math.cos(direction), 2), round(speed * math.sin(direction), 2)
