"""The three plans an autopilot stores: mission, fence and rally points."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

from missionkit.sitl.pymavlink_dialect import Message, mavlink

MISSION_ITEMS = mavlink.MAV_MISSION_TYPE_MISSION
FENCE_ITEMS = mavlink.MAV_MISSION_TYPE_FENCE
RALLY_ITEMS = mavlink.MAV_MISSION_TYPE_RALLY


class Item(NamedTuple):
    """One item, as MISSION_ITEM_INT has it."""

    frame: int
    command: int
    current: int
    autocontinue: int
    params: tuple[float, float, float, float]
    x: int  # 1e-7 deg, or 1e-4 m in local frames
    y: int
    z: float

    @classmethod
    def of(cls, message: Message) -> Item | None:
        """Return the item in a MISSION_ITEM_INT or MISSION_ITEM, `None` if it is nowhere."""
        scale = 1 if message.get_type() == "MISSION_ITEM_INT" else 1e7
        if not all(abs(value * scale) < 1 << 31 for value in (message.x, message.y)):
            return None
        return cls(
            message.frame,
            message.command,
            message.current,
            message.autocontinue,
            (message.param1, message.param2, message.param3, message.param4),
            round(message.x * scale),
            round(message.y * scale),
            message.z,
        )


@dataclass(slots=True)
class Plans:
    """Uploaded items by MAV_MISSION_TYPE, and the current mission item."""

    items: dict[int, tuple[Item, ...]] = field(
        default_factory=lambda: {MISSION_ITEMS: (), FENCE_ITEMS: (), RALLY_ITEMS: ()}
    )
    current: int = 0
    reached: int = -1

    @property
    def mission(self) -> tuple[Item, ...]:
        """Items of the mission."""
        return self.items[MISSION_ITEMS]
