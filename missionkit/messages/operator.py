"""What is known of the person at the page, and what they did."""

from __future__ import annotations

from typing import NamedTuple


class OperatorAction(NamedTuple):
    """Something that a person at the page did."""

    action: str  # hold, continue, return, land, event, give_back, takeover
    event: str  # with `event`; "" otherwise
    who: str  # "pilot 1"
    address: str  # where they are

    def said(self) -> str:
        """Return it as a sentence for the log."""
        what = f"{self.action} {self.event}".rstrip()
        return f"{self.who} at {self.address or 'an unknown address'}: {what}"


class OperatorReport(NamedTuple):
    """The pilot at the page, as of one tick."""

    silent_for: float | None = None  # s of the wall without a sign of life; None: no pilot has come
    actions: tuple[OperatorAction, ...] = ()  # since the last tick
