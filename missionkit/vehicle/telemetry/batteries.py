"""Which of several battery packs the mission looks at.

What keeps the vehicle in the air counts: packs for propulsion or for everything. Where no pack says
so, the one with the lowest id of those that do not say what they are for counts; ArduPilot says of
no pack what it is for. Packs for avionics or payload never count. Of several that count the
emptiest is reported, as old as the oldest of their readings.

Source: MAVLink common.xml, BATTERY_STATUS (147) and MAV_BATTERY_FUNCTION.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import NamedTuple

from missionkit.messages import Battery
from missionkit.vehicle.autopilot_dialect import AUTOPILOT_COMPONENT
from missionkit.vehicle.link.message_cache import Fields

FUNCTION_UNKNOWN, FUNCTION_ALL, FUNCTION_PROPULSION = 0, 1, 2  # MAV_BATTERY_FUNCTION
FUNCTIONS = ("of unknown use", "for everything", "for propulsion", "for avionics", "for payload")
CELL_UNKNOWN = 65535  # mV
READINGS_NEEDED, READINGS_OF_ANOTHER = 3, 10
"""Readings of a new pack until it counts beside one that has had so many."""

Ident = tuple[int, int]
"""Component and id."""


class Pack(NamedTuple):
    """Last report of one battery."""

    ident: Ident
    function: int  # MAV_BATTERY_FUNCTION
    charge: float | None  # 0 to 1, None: not estimated
    voltage: float  # V
    at: float  # s
    heard: int = 1  # times

    @property
    def says(self) -> str:
        """The pack in words."""
        use = FUNCTIONS[self.function] if self.function < len(FUNCTIONS) else FUNCTIONS[0]
        charge = "charge not known" if self.charge is None else f"{self.charge:.0%}"
        component, number = self.ident
        whose = "" if component == AUTOPILOT_COMPONENT else f" of component {component}"
        return f"battery {number}{whose} {use}, {charge}"


Packs = Mapping[Ident, Pack]
NO_PACKS: Packs = {}


def pack_of(fields: Fields, at: float) -> Pack:
    """Return what one BATTERY_STATUS says."""
    remaining = int(fields["battery_remaining"])
    more = [value for value in fields.get("voltages_ext", ()) if value]  # 0: not there
    cells = [value for value in (*fields["voltages"], *more) if value != CELL_UNKNOWN]
    return Pack(
        (int(fields.get("component", AUTOPILOT_COMPONENT)), int(fields["id"])),
        int(fields["battery_function"]),
        None if remaining < 0 else 0.01 * remaining,
        1e-3 * sum(cells),
        at,
    )


def heard(known: Packs, fields: Fields, at: float) -> Packs:
    """Return the packs after one more BATTERY_STATUS.

    Args:
        known: packs by their ids.
        fields: of the message, as MAVLink has them.
        at: s.
    """
    pack = pack_of(fields, at)
    before = known.get(pack.ident)
    times = 1 if before is None else before.heard + 1
    return {**known, pack.ident: pack._replace(heard=times)}


def counted(known: Packs) -> tuple[Pack, ...]:
    """Return the packs that keep the vehicle in the air."""
    most = max((pack.heard for pack in known.values()), default=0)
    least = READINGS_NEEDED if most >= READINGS_OF_ANOTHER else 1
    often = [pack for pack in known.values() if pack.heard >= least]
    flying = [pack for pack in often if pack.function in {FUNCTION_ALL, FUNCTION_PROPULSION}]
    if flying:
        return tuple(flying)
    unsaid = [pack for pack in often if pack.function not in range(FUNCTION_ALL, len(FUNCTIONS))]
    return (min(unsaid, key=lambda pack: pack.ident),) if unsaid else ()


def battery(known: Packs) -> Battery | None:
    """Return what the mission sees, None while no pack that counts estimates its charge."""
    packs = counted(known)
    charges = [pack.charge for pack in packs if pack.charge is not None]
    if not charges:
        return None
    least = min((p for p in packs if p.charge is not None), key=lambda p: p.charge or 0.0)
    return Battery(min(pack.at for pack in packs), min(charges), least.voltage)


def all_of(messages: Iterable[tuple[Fields, float]]) -> Packs:
    """Return the packs after many messages (fields, time)."""
    known = NO_PACKS
    for fields, at in messages:
        known = heard(known, fields, at)
    return known
