"""What the parts of the adapter need of the link: to put one message on it, and parameters."""

from __future__ import annotations

from typing import Any, Protocol


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
