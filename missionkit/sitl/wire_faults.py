"""Faults of the link and the autopilot, in addition to the simulator's own.

NAME[=VALUE][@WHEN][+DURATION]      as in a rehearsal; WHEN in simulated seconds
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from missionkit.errors import UsageError, nearest
from missionkit.sim.fault_injection import (
    FAULT_KINDS,
    Fault,
    InjectedFaults,
    Kind,
    fault_in,
    name_in,
    parse_fault,
)
from missionkit.sitl.flight_modes import ModeTable
from missionkit.sitl.link_weather import REORDERING_DELAY

WIRE: dict[str, Kind] = {
    "acks_delayed": Kind(1.0, "s", "acknowledgements arrive later by VALUE", least=0.0),
    "acks_lost": Kind(None, "", "commands are carried out, but never acknowledged"),
    "arming_denied": Kind(None, "", "the arming checks fail"),
    "command_denied": Kind(400.0, "MAV_CMD", "this command is refused", least=0.0),
    "link_cut": Kind(None, "", "nothing arrives, either way"),
    "link_flapping": Kind(2.0, "s", "the link is cut in every other half of VALUE", least=0.02),
    "link_lost": Kind(None, "", "nothing arrives from the vehicle; commands still do"),
    "packets_delayed": Kind(0.2, "s", "packets arrive later by VALUE, both ways", least=0.0),
    "packets_lost": Kind(0.2, "1", "this share of the packets is lost", least=0.0, most=1.0),
    "packets_reordered": Kind(
        0.2, "1", "this share of the packets arrives out of order", least=0.0, most=1.0
    ),
    "pilot_mode": Kind(None, "mode", "the pilot changes the flight mode to VALUE, once"),
    "rc_lost": Kind(None, "", "the remote control, present before, falls silent"),
    "reboot": Kind(1.5, "s", "the autopilot restarts and is silent for VALUE", least=0.0),
    "stream_lost": Kind(
        32.0, "message", "this message is no longer sent (32: LOCAL_POSITION_NED)", least=1.0
    ),
    "streams_frozen": Kind(None, "", "messages repeat their old values, with their old times"),
    "streams_stopped": Kind(None, "", "nothing arrives but heartbeats and answers"),
}
BODY_FAULTS = (
    "baro_stuck",
    "battery_sag",
    "control_slow",
    "gnss_drift",
    "gnss_jump",
    "gnss_lost",
    "gnss_toggling",
    "imu_biased",
    "range_lost",
    "velocity_bias",
    "wind_gust",
)
ONCE = ("pilot_mode", "reboot")


def read_fault(text: str, dialect: ModeTable) -> Fault:
    """Read one fault.

    Raises:
        UsageError: unknown name, of another form, or of something that is not on the wire.
    """
    name = name_in(text)
    if name in BODY_FAULTS:
        return parse_fault(text)
    if name not in WIRE:
        if name in FAULT_KINDS:
            raise UsageError(f"fault {name!r} is not a fault of the autopilot: {_known(name)}")
        raise UsageError(f"unknown fault {name!r}: {_known(name)}")
    return fault_in(text, lambda name, value: value_of(name, value, dialect))


def _known(name: str) -> str:
    return nearest(name, [*WIRE, *BODY_FAULTS])


def value_of(name: str, text: str | None, dialect: ModeTable) -> float | None:
    """Return the value of a fault of this module.

    Args:
        name: of the fault, in `WIRE`.
        text: after the `=`; `None`: the fault's default.
        dialect: names the modes that a pilot can choose.

    Returns:
        In the unit of the fault; for `pilot_mode` the mode's number.

    Raises:
        UsageError: it does not fit.
    """
    kind = WIRE[name]
    if name == "pilot_mode":
        default = "POSCTL" if dialect.name == "px4" else "LOITER"
        return float(dialect.named(text or default).number)
    if text is None:
        return kind.value
    if not kind.unit:
        raise UsageError(f"fault {name} takes no value, got {text!r}")
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not kind.least <= value <= min(kind.most, 1e6):
        raise UsageError(f"fault {name} needs a number ({kind.unit}) in its range, got {text!r}")
    return value


class WireFaults:
    """The faults of a flight, which may come and go at any time; does `Weather` to packets."""

    def __init__(self, faults: Sequence[Fault], rng: np.random.Generator) -> None:
        self.entered: dict[str, float] = {}
        self._faults = list(faults)
        self._rng = rng
        self._struck: list[Fault] = []

    @property
    def faults(self) -> tuple[Fault, ...]:
        """All faults, also those to come."""
        return tuple(self._faults)

    def add(self, fault: Fault) -> None:
        """Add a fault."""
        self._faults.append(fault)

    def clear(self, name: str | None = None) -> None:
        """Take away the faults of that name, or all."""
        self._faults = [f for f in self._faults if name is not None and f.name != name]

    def active(self, name: str, now: float) -> tuple[float, float] | None:
        """Return (value, age in s) of the newest active fault of that name, or `None`."""
        return self._injected.since(name, now)

    def without_fixes(self, now: float) -> float | None:
        """Return for how long (s) there have been no satellites, `None` when there are."""
        return self._injected.without_fixes(now)

    @property
    def _injected(self) -> InjectedFaults:
        return InjectedFaults(tuple(reversed(self._faults)), self.entered)

    def strikes(self, name: str, now: float) -> float | None:
        """Return the value of a fault that happens once, when it does."""
        for fault in self._faults:
            if fault.name != name or any(fault is other for other in self._struck):
                continue
            if fault.since(now, self.entered) is not None:
                self._struck.append(fault)
                return fault.value or 0.0
        return None

    def delay(self, direction: str, now: float) -> float | None:
        """Return how late (s) a packet sent at `now` (s) arrives; `None`: it is lost."""
        if self._cut(direction, now):
            return None
        lost = self.active("packets_lost", now)
        if lost and self._rng.random() < lost[0]:
            return None
        late = self.active("packets_delayed", now)
        mixed = self.active("packets_reordered", now)
        overtaken = mixed is not None and self._rng.random() < mixed[0]
        return (late[0] if late else 0.0) + (
            REORDERING_DELAY * self._rng.random() if overtaken else 0.0
        )

    def _cut(self, direction: str, now: float) -> bool:
        if self.active("link_cut", now) or (direction == "down" and self.active("link_lost", now)):
            return True
        flapping = self.active("link_flapping", now)
        return flapping is not None and flapping[1] % flapping[0] < flapping[0] / 2.0
