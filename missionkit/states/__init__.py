"""The kinds of vehicle and of state a mission is made of, each with its contract."""

from collections.abc import Mapping
from types import MappingProxyType

from missionkit.states.contract import StateKind
from missionkit.states.free_flyer import FREE_FLYER
from missionkit.states.multicopter import MULTICOPTER
from missionkit.states.vehicle_kind import VehicleKind

VEHICLES: Mapping[str, VehicleKind] = MappingProxyType(
    {kind.name: kind for kind in (MULTICOPTER, FREE_FLYER)}
)
STATE_KINDS: Mapping[str, StateKind] = MULTICOPTER.kinds
