"""Interface of the link for the adapter: messages, parameters, and the items of a plan."""

from __future__ import annotations

from typing import Any, NamedTuple, Protocol


class MessageLink(Protocol):
    """A link to one autopilot."""

    def send(self, name: str, **fields: Any) -> None:
        """Send a message to the autopilot; None stands for NaN.

        Raises:
            RuntimeError: it could not be sent.
        """

    def parameter(self, name: str) -> float | None:
        """Return a parameter's value, None if the autopilot does not have it or does not answer.

        Blocks the calling thread.
        """

    def set_parameter(self, name: str, value: float) -> bool:
        """Set a parameter and say whether that was confirmed. Blocks the calling thread."""


class PlanItem(NamedTuple):
    """An item of a fence or of rally points, as MISSION_ITEM_INT has it.

    What its parameters mean depends on `command`.
    """

    seq: int
    command: int  # MAV_CMD
    x: int  # latitude, 1e-7 deg
    y: int  # longitude, 1e-7 deg
    z: float  # m
    mission_type: int  # 1 fence, 2 rally
    frame: int = 0  # MAV_FRAME_GLOBAL
    current: int = 0
    autocontinue: int = 1
    param1: float = 0.0
    param2: float = 0.0
    param3: float = 0.0
    param4: float = 0.0
