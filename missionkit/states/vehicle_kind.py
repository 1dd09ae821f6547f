"""Contract of a kind of vehicle: what flies it, its safe end, its kinds of state."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from missionkit.states.contract import StateKind

SetpointName = Literal["velocity", "wrench"]


@dataclass(frozen=True, slots=True)
class VehicleKind:
    """A kind of vehicle, as mission, checks, engine and grade need it.

    Every kind has a safe end, which its states of kind `land` lead to. It is reached when the
    vehicle reports itself neither armed nor in the air, whatever that takes: landed, or docked.
    """

    name: str
    summary: str
    setpoint: SetpointName  # what its controllers give
    sections: Mapping[str, str]  # section of the mission file -> plug-in if it names none
    kinds: Mapping[str, StateKind]
    estimate_limit: float  # m, of the estimate from the truth, above which nothing is a success
    ending_limit: float  # m, of its end from where it meant to end
    over_mavlink: bool  # whether an autopilot can fly it
    over_ground: bool  # whether it takes off from the ground and may touch it
