"""A log as the ticks of a flight: where it was, in which mode, what guards would have said."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

from missionkit.chart.model.mission import Mission
from missionkit.geodesy import Origin
from missionkit.geometry import IDENTITY, Quat, vec
from missionkit.interchange.bounded_input import ForeignFileError
from missionkit.interchange.flight_logs.log_samples import (
    Charged,
    Fix,
    FlightLog,
    Said,
    Switched,
    Turned,
)
from missionkit.messages import (
    Battery,
    Command,
    Estimate,
    Fired,
    Health,
    Record,
    Target,
    VehicleStatus,
    Verdict,
)
from missionkit.messages.command import Mode

RATE = 10.0  # Hz, at most
VAGUE = 1.0  # m, standard deviation of a position of which the log does not say it
AIRBORNE = 0.5  # m above home, armed: in the air, where the log does not say it
UNKNOWN_MODE = "unknown"
Verdicts = tuple[tuple[str, Verdict], ...]


@dataclass
class _Standing:
    """What is known by now."""

    attitude: Quat = field(default_factory=IDENTITY.copy)
    battery: Battery | None = None
    mode: str = UNKNOWN_MODE
    armed: bool = False
    landed: bool | None = None
    said: list[str] = field(default_factory=list)

    def note(self, sample: Turned | Charged | Switched | Said, now: float) -> None:
        """Take in a sample that is not a fix; time counts from the first fix."""
        match sample:
            case Turned():
                self.attitude = sample.attitude
            case Charged(charge=float() as charge):
                self.battery = Battery(now, charge, sample.voltage)
            case Switched():
                self.mode = self.mode if sample.mode is None else sample.mode
                self.armed = self.armed if sample.armed is None else sample.armed
                self.landed = self.landed if sample.landed is None else sample.landed
            case Said():
                self.said.append(f"autopilot: {sample.text}")
            case _:
                pass


def origin_of(log: FlightLog, mission: Mission | None) -> Origin:
    """Return where [0, 0, 0] is: at the mission's origin if it has one, at the log's own height.

    Without one it is where the vehicle was first armed, or first at all.

    Raises:
        ForeignFileError: the log has no position.
    """
    armed, first = False, None
    for sample in log.samples:
        if isinstance(sample, Switched) and sample.armed is not None:
            armed = sample.armed
        if isinstance(sample, Fix):
            first = first or sample
            if armed:
                first = sample
                break
    if first is None:
        raise ForeignFileError("the log has no position that a vehicle estimated")
    given = None if mission is None else mission.geodetic_origin
    lat, lon = (first.lat, first.lon) if given is None else (given.latitude, given.longitude)
    return Origin(lat, lon, first.alt)


def records(
    log: FlightLog,
    origin: Origin,
    mission: Mission | None,
    answers: Callable[[Estimate], Verdicts],
) -> Iterator[Record]:
    """Yield the ticks of a log, at most ten a second, from its first fix on.

    Args:
        log: as read.
        origin: of the metres.
        mission: whose targets are where it says.
        answers: what guards say of an estimate.
    """
    standing, began, last, mode = _Standing(), None, -math.inf, ""
    targets = {} if mission is None else _targets(mission)
    home = None
    for sample in log.samples:
        if not isinstance(sample, Fix):
            standing.note(sample, 0.0 if began is None else sample.at - began)
            continue
        began = sample.at if began is None else began
        now = sample.at - began
        if now < last + 1.0 / RATE - 1e-6:
            continue
        last = now
        seen = _estimate(sample, now, standing, origin)
        home = seen.position if home is None and standing.armed else home
        seen = seen._replace(home=home, targets=targets)
        state = f"mode {standing.mode}"
        moved = (Fired(mode, state, "the autopilot", (), ()),) if mode and mode != state else ()
        mode = state
        said, standing.said = tuple(standing.said), []
        yield Record(
            now, state, (state,), Mode.NONE, answers(seen), moved, Command(), "", said, seen
        )


def _estimate(sample: Fix, now: float, standing: _Standing, origin: Origin) -> Estimate:
    position = origin.local(sample.lat, sample.lon, sample.alt)
    high = standing.armed and -float(position[2]) > AIRBORNE
    in_air = high if standing.landed is None else not standing.landed
    sd = VAGUE if sample.sd is None or sample.sd < 0.0 else sample.sd
    return Estimate(
        now,
        position,
        vec(*sample.velocity),
        standing.attitude,
        vec(0.0, 0.0, 0.0),
        Health(
            aligned=True,
            diverged=False,
            gnss_at=now,
            vision_at=None,
            position_sd=sd,
            rejected=0,
        ),
        standing.battery,
        VehicleStatus(now, standing.armed, in_air, ready=True, mode=standing.mode),
    )


def _targets(mission: Mission) -> dict[str, Target]:
    return {
        name: Target(name, vec(*it.position), it.position_sd, None, None, None)
        for name, it in mission.targets.items()
    }
