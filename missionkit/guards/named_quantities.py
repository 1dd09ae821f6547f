"""Quantities of the estimate that a guard's parameters name: "confidence of trunk"."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import cache
from typing import NamedTuple

from missionkit.geometry import norm
from missionkit.guards.battery import CHARGE
from missionkit.guards.converged import SPEED_QUANTITY
from missionkit.guards.detection_confidence import confidence_of
from missionkit.guards.distances import GOAL_DISTANCE, distance_to
from missionkit.guards.disturbance import TILT_QUANTITY, tilt_deg
from missionkit.guards.estimate_quality import POSITION_SD
from missionkit.guards.target_visibility import time_since_seen
from missionkit.messages import Estimate
from missionkit.messages.region import Quantity

HOME = "home"
BATTERY_AGE = 5.0  # s; an older reading is not known to be right
RANGE_MAX_AGE = 1.0  # s

HEIGHT_ABOVE_TAKE_OFF = Quantity("height above take-off", least=-math.inf, unit="m")
HEIGHT_SD = Quantity("height sd", unit="m")
GROUND_RANGE = Quantity("range to the ground", unit="m")
MAHALANOBIS = Quantity("mahalanobis distance")
CONSISTENCY = Quantity("consistency", most=1.0)

Value = float | str
"""A number, or why it is not known."""


class NamedQuantity(NamedTuple):
    """A quantity of the estimate."""

    quantity: Quantity
    read: Callable[[Estimate], Value] | None  # None: the confidence, a share of the last frames
    target: str | None = None  # that it is about


@cache
def named_quantity(name: str) -> NamedQuantity | None:
    """Return the quantity with a name, None if there is none."""
    if name in PLAIN_QUANTITIES:
        return PLAIN_QUANTITIES[name]
    for prefix, suffix, build in OF_TARGETS:
        target = name.removeprefix(prefix).removesuffix(suffix)
        if name == f"{prefix}{target}{suffix}" and target:
            return build(target)
    return None


def quantity_names() -> list[str]:
    """Return every name, with TARGET where the name of a target stands."""
    return [*PLAIN_QUANTITIES, *(f"{prefix}TARGET{suffix}" for prefix, suffix, _ in OF_TARGETS)]


def _confidence(target: str) -> NamedQuantity:
    return NamedQuantity(confidence_of(target), None, target)


def _distance(target: str) -> NamedQuantity:
    def read(seen: Estimate) -> Value:
        if not seen.health.aligned:
            return "the position is not known yet"
        found = seen.targets.get(target)
        place = seen.home if target == HOME and found is None else found and found.position
        if place is None:
            return f"the position of {target} is unknown"
        return norm(place - seen.position)

    return NamedQuantity(distance_to(target), read, None if target == HOME else target)


def _since_seen(target: str) -> NamedQuantity:
    def read(seen: Estimate) -> Value:
        found = seen.targets.get(target)
        if found is None or found.seen_at is None:
            return f"{target} was never seen"
        return seen.now - found.seen_at

    return NamedQuantity(time_since_seen(target), read, target)


def _sd_of(target: str) -> NamedQuantity:
    def read(seen: Estimate) -> Value:
        found = seen.targets.get(target)
        return f"the position of {target} is unknown" if found is None else found.position_sd

    return NamedQuantity(Quantity(f"position sd of {target}", unit="m"), read, target)


def _goal_distance(seen: Estimate) -> Value:
    if seen.goal is None:
        return "the behaviour has no goal yet"
    return norm(seen.goal.position - seen.position)


def _aligned(read: Callable[[Estimate], float]) -> Callable[[Estimate], Value]:
    def ask(seen: Estimate) -> Value:
        return read(seen) if seen.health.aligned else "the position is not known yet"

    return ask


def _height_sd(seen: Estimate) -> Value:
    sd = seen.health.height_sd
    return "the navigator does not say how well the height is known" if sd is None else sd


def _mahalanobis(seen: Estimate) -> Value:
    d = seen.health.mahalanobis
    return "the navigator took in no measurement lately" if d is None else d


def _consistency(seen: Estimate) -> Value:
    d = _mahalanobis(seen)
    return d if isinstance(d, str) else 1.0 / (1.0 + d)


def _charge(seen: Estimate) -> Value:
    if seen.battery is None or seen.now - seen.battery.at > BATTERY_AGE:
        return "there is no fresh battery reading"
    return seen.battery.charge


def _ground_range(seen: Estimate) -> Value:
    if seen.range is None or seen.now - seen.range.at > RANGE_MAX_AGE:
        return "there is no fresh range to the ground"
    return seen.range.distance


PLAIN_QUANTITIES: Mapping[str, NamedQuantity] = {
    it.quantity.name: it
    for it in (
        NamedQuantity(GOAL_DISTANCE, _goal_distance),
        NamedQuantity(POSITION_SD, _aligned(lambda seen: seen.health.position_sd)),
        NamedQuantity(HEIGHT_SD, _height_sd),
        NamedQuantity(MAHALANOBIS, _mahalanobis),
        NamedQuantity(CONSISTENCY, _consistency),
        NamedQuantity(HEIGHT_ABOVE_TAKE_OFF, _aligned(lambda seen: -float(seen.position[2]))),
        NamedQuantity(GROUND_RANGE, _ground_range),
        NamedQuantity(SPEED_QUANTITY, _aligned(lambda seen: norm(seen.velocity))),
        NamedQuantity(TILT_QUANTITY, tilt_deg),
        NamedQuantity(CHARGE, _charge),
    )
}
OF_TARGETS: tuple[tuple[str, str, Callable[[str], NamedQuantity]], ...] = (
    ("confidence of ", "", _confidence),
    ("distance to ", "", _distance),
    ("position sd of ", "", _sd_of),
    ("time since ", " was seen", _since_seen),
)
