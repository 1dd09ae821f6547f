"""The matrix: every fault, its declared outcomes, and the function that injects it."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from missionkit.sim.world import Wind, World
from studies import fault_processes as process
from studies.fault_flights import (
    Flight,
    Outcome,
    Seen,
    during,
    flown,
    with_guard,
)

DONE, HOME, ELSEWHERE, LEFT = Outcome.DONE, Outcome.HOME, Outcome.ELSEWHERE, Outcome.LEFT
REPORTED = Outcome.REPORTED
SAFE = (DONE, HOME, ELSEWHERE)
NORTH_FENCE = 60.0  # m, of the row "fence"
OVERRUN = 6.0  # m it may need to turn round there: braking from 5 m/s


class Row(NamedTuple):
    """One fault of the matrix."""

    name: str
    what: str  # what goes wrong, and when
    declared: tuple[str, ...]  # acceptable outcomes, the preferred one first
    once: Callable[[int], Seen]  # injects it with a seed


def _flight(name: str, what: str, declared: tuple[Outcome, ...], flight: Flight) -> Row:
    return Row(name, what, declared, partial(flown, flight))


def _blown(mean: float, gust: float) -> Callable[[World, np.random.Generator], World]:
    def world(calm: World, chance: np.random.Generator) -> World:
        angle = chance.uniform(-np.pi, np.pi)
        level = (float(mean * np.cos(angle)), float(mean * np.sin(angle)), 0.0)
        return calm.model_copy(update={"wind": Wind(mean=level, gust=gust)})

    return world


def _with_decoy(world: World, chance: np.random.Generator) -> World:
    """Hang the marker's twin on a tree of its own, 3 to 6 m to the side of the true one."""
    true = world.markers[0]
    side = float(chance.choice([-1.0, 1.0]) * chance.uniform(3.0, 6.0))
    north, east, down = true.position
    twin = true.model_copy(update={"position": (north, east + side, down)})
    trunk = world.obstacles[-1].model_copy(update={"at": (north + 0.4, east + side)})
    more = {"markers": (*world.markers, twin), "obstacles": (*world.obstacles, trunk)}
    return world.model_copy(update=more)


def _fenced(keys: dict[str, Any]) -> None:
    inside = keys["failsafes"][-1]["when"]["not"]
    inside["north"] = [-20, NORTH_FENCE]


FLIGHTS = (
    _flight(
        "GNSS off",
        "`gnss_lost` for good, on the way out",
        (ELSEWHERE,),
        Flight(during("gps", "gnss_lost", 2, 14)),
    ),
    _flight(
        "GNSS jump",
        "`gnss_jump=20` for good, on the way out: a lost position",
        (ELSEWHERE,),
        Flight(during("gps", "gnss_jump=20", 2, 14)),
    ),
    _flight(
        "GNSS drift",
        "`gnss_drift=0.5` for good, on the way out; nothing on board can notice it",
        (ELSEWHERE, LEFT, DONE, HOME),
        Flight(during("gps", "gnss_drift=0.5", 2, 14)),
    ),
    _flight(
        "GNSS toggling",
        "`gnss_toggling=4`: none for 2 s of every 4 s",
        (DONE, ELSEWHERE),
        Flight(during("gps", "gnss_toggling=4", 0, 10)),
    ),
    _flight(
        "barometer stuck",
        "`baro_stuck` for good, on the way out",
        SAFE,
        Flight(during("gps", "baro_stuck", 0, 14)),
    ),
    _flight(
        "range finder lost",
        "`known_map.yaml`, without satellites: `range_lost` for good",
        (ELSEWHERE, DONE),
        Flight(
            during("path", "range_lost", 1, 20),
            mission="known_map",
            lands_at=(8.0, 6.0),
        ),
    ),
    _flight(
        "camera frozen",
        "`camera_frozen` for good, servoing",
        (HOME, DONE),
        Flight(during("visual", "camera_frozen", 0, 4)),
    ),
    _flight(
        "camera late",
        "`camera_delayed=0.5` for good, servoing",
        (DONE, HOME),
        Flight(during("visual", "camera_delayed=0.5", 0, 4)),
    ),
    _flight(
        "camera lost high",
        "`camera_off` for good at 6 m, on the way out",
        (HOME,),
        Flight(during("gps", "camera_off", 0, 14)),
    ),
    _flight(
        "camera lost low",
        "`camera_off` for good, injecting, 1 m from the trunk",
        (DONE, HOME),
        Flight(during("task", "camera_off", 0, 3)),
    ),
    _flight(
        "decoy",
        "a twin of the marker on a tree 3 to 6 m beside; one within 5.6 m of a target that is "
        "surveyed to 1 m (5 sigma, the vehicle's own included) can pass for it if seen first; "
        "reported when both are in view",
        (DONE, HOME, REPORTED),
        Flight(world=_with_decoy),
    ),
    _flight(
        "image flipped",
        "`camera_flipped`: upside down from the start",
        (HOME,),
        Flight(lambda _: ("camera_flipped",)),
    ),
    _flight(
        "filter diverged",
        "`imu_biased=3`: 3 m/s² for good, on the way out",
        (ELSEWHERE, HOME),
        Flight(during("gps", "imu_biased=3", 2, 14)),
    ),
    _flight(
        "battery sag",
        "`battery_sag=0.4`, on the way out; enough is left",
        (DONE,),
        Flight(during("gps", "battery_sag=0.4", 0, 14)),
    ),
    _flight(
        "battery drop",
        "`battery_sag=0.78`, on the way out; less than the 20 % of the failsafe are left",
        (HOME, ELSEWHERE),
        Flight(during("gps", "battery_sag=0.78", 0, 14)),
    ),
    _flight(
        "link lost",
        "`link_lost` for good, on the way out",
        (ELSEWHERE,),
        Flight(during("gps", "link_lost", 0, 14)),
    ),
    _flight(
        "plug-in raises",
        "a guard raises from 30 m on, at every tick",
        (HOME,),
        Flight(change=with_guard("gps", "return", {"use": "broken", "north": 30.0})),
    ),
    _flight(
        "constant wind",
        "6 m/s from anywhere, gusts of 1 m/s",
        (DONE, HOME),
        Flight(world=_blown(6.0, 1.0)),
    ),
    _flight(
        "gust",
        "`wind_gust=8` for 3 s, servoing",
        SAFE,
        Flight(during("visual", "wind_gust=8+3", 0, 6)),
    ),
    _flight(
        "fence",
        f"the fence ends at {NORTH_FENCE:g} m, the target is behind it; {OVERRUN:g} m to turn",
        (HOME,),
        Flight(change=_fenced, fence=(-20.0, NORTH_FENCE + OVERRUN, -40.0, 60.0, 30.0)),
    ),
)
PROCESSES = tuple(Row(*each) for each in process.ROWS)
ROWS = (*FLIGHTS, *PROCESSES)


def once(name: str, seed: int) -> Seen:
    """Inject a fault; an error of the study itself is an outcome that was not declared."""
    row = next(row for row in ROWS if row.name == name)
    try:
        return row.once(seed)
    except Exception as error:  # noqa: BLE001  the other seeds are flown all the same
        return Seen(seed, "could not be injected", f"{type(error).__name__}: {error}")
