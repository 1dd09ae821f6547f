"""The chart that every engine runs: a ring of states, each left by any of several guards.

Of a state's guards all but the last lead to the next state of the ring and never hold here. The
last one leads to the state's partner: in even states it holds when the battery is low, in odd
ones when the link is silent, so that two views in turn make a chart go to and fro, one
transition a tick.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from missionkit.messages import Battery, Estimate, Health, VehicleStatus

Predicate = Callable[[], bool]
Guards = Mapping[str, Predicate]


class Ask(NamedTuple):
    """One guard: a number compared with a limit."""

    use: str
    key: str
    limit: float

    @property
    def name(self) -> str:
        return f"{self.use}_{self.limit:g}".replace(".", "_").replace("-", "_")


class Way(NamedTuple):
    """One transition."""

    to: str
    ask: Ask


class Ring(NamedTuple):
    """The chart."""

    initial: str
    states: Mapping[str, tuple[Way, ...]]


class Sky:
    """Inputs of the guards of one chart."""

    def __init__(self, seen: Estimate) -> None:
        self.seen = seen


class Machine(NamedTuple):
    """A chart under way in one engine."""

    tick: Callable[[], object]
    state: Callable[[], str]


def ring(states: int, guards: int) -> Ring:
    """Return the ring; it starts in the middle, where a search from either end shows."""
    ways = {f"s{at}": _ways(at, states, guards) for at in range(states)}
    return Ring(f"s{states // 4 * 2}", ways)


def _ways(at: int, states: int, guards: int) -> tuple[Way, ...]:
    following = f"s{(at + 1) % states}"
    partner = f"s{at - 1 if at % 2 or at + 1 == states else at + 1}"
    last = Ask("link_lost", "longer_than", 1.0) if at % 2 else Ask("battery_below", "floor", 0.5)
    return (
        *(Way(following, _never(k)) for k in range(guards - 1)),
        Way(partner if guards > 1 else following, last),
    )


def _never(number: int) -> Ask:
    match number % 3:
        case 0:
            return Ask("elapsed", "longer_than", 60.0 + number)
        case 1:
            return Ask("link_lost", "longer_than", 30.0 + number)
        case _:
            return Ask("battery_below", "floor", 0.2 - number / 1000)


def asks(chart: Ring) -> dict[str, Ask]:
    """Return every guard of a chart by its name."""
    return {way.ask.name: way.ask for ways in chart.states.values() for way in ways}


def source(ask: Ask) -> str:
    """Return a guard as the Python that one would write by hand."""
    match ask.use:
        case "battery_below":
            return f"sky.seen.battery.charge < {ask.limit!r}"
        case "link_lost":
            return f"sky.seen.now - sky.seen.status.at > {ask.limit!r}"
        case _:
            return f"sky.seen.now - sky.seen.entered_at >= {ask.limit!r}"


def predicate(ask: Ask, sky: Sky) -> Predicate:
    """Return a guard as a function."""
    made: Predicate = eval(f"lambda: {source(ask)}", {"sky": sky})  # noqa: S307 - our own text
    return made


class Views(NamedTuple):
    """Estimates: one at which no guard holds, and two that lead out of a state."""

    calm: Estimate
    low: Estimate  # leads out of even states
    silent: Estimate  # leads out of odd states


def views(*, in_air: bool = False, events: tuple[str, ...] = ()) -> Views:
    """Return the estimates that charts are stepped with; on the ground no failsafe acts."""
    return Views(
        _seen(0.9, 0.0, events, in_air=in_air),
        _seen(0.4, 0.0, events, in_air=in_air),
        _seen(0.9, 2.0, events, in_air=in_air),
    )


def _seen(charge: float, silence: float, events: tuple[str, ...], *, in_air: bool) -> Estimate:
    now = 5.0
    return Estimate(
        now=now,
        position=np.zeros(3),
        velocity=np.zeros(3),
        attitude=np.array([1.0, 0.0, 0.0, 0.0]),
        rates=np.zeros(3),
        health=Health(
            aligned=True, diverged=False, gnss_at=now, vision_at=None, position_sd=0.3, rejected=0
        ),
        battery=Battery(now, charge, 16.0),
        status=VehicleStatus(now - silence, armed=in_air, in_air=in_air, ready=True, mode="hold"),
        home=np.zeros(3),
        events=events,
    )


class Engine(NamedTuple):
    """One engine: `text` writes a chart as it wants it, `load` starts what was written."""

    name: str
    how: str
    text: Callable[[Ring], object]
    load: Callable[..., Machine]  # (text, sky, guards)
    package: str = ""  # whose version to tell
    views: Views = views()
    counted: bool = True  # its guards are functions that can be seen to be asked
