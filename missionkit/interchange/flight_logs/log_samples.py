"""What all logs have in common: samples over time."""

from __future__ import annotations

from typing import NamedTuple, TypeAlias

from missionkit.geometry import Quat

MOST_BYTES = 1 << 30


class Fix(NamedTuple):
    """Where the vehicle is, as its autopilot estimates it."""

    at: float  # s, of the log's own clock
    lat: float  # deg
    lon: float  # deg
    alt: float  # m above mean sea level
    velocity: tuple[float, float, float]  # m/s, NED
    sd: float | None = None  # m, horizontal, 1 sigma


class Turned(NamedTuple):
    """How the vehicle is turned."""

    at: float  # s
    attitude: Quat  # body FRD to NED


class Charged(NamedTuple):
    """The battery; charge is from 0 to 1."""

    at: float  # s
    charge: float | None
    voltage: float  # V


class Switched(NamedTuple):
    """Mode and arming, where they are known."""

    at: float  # s
    mode: str | None = None
    armed: bool | None = None
    landed: bool | None = None


class Said(NamedTuple):
    """A message of the autopilot."""

    at: float  # s
    text: str


Sample: TypeAlias = Fix | Turned | Charged | Switched | Said


class FlightLog(NamedTuple):
    """A log that was read."""

    samples: tuple[Sample, ...]  # in the order of time
    began: float | None  # s since 1970 at `at` = 0, if the log says so
    counts: dict[str, int]  # messages of the file, by type
    used: frozenset[str]  # types that were read
    damaged: int = 0  # bytes or messages that could not be read


def in_order(samples: list[Sample]) -> tuple[Sample, ...]:
    """Return samples in the order of time; where the vehicle is comes last of what is equal."""
    return tuple(sorted(samples, key=lambda it: (it.at, isinstance(it, Fix))))
