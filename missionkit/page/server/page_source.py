"""What a page is of: a flight, a recording or a chart that is played with."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple, Protocol

from missionkit.page.server.sessions import Session


class PageError(Exception):
    """A request that is refused; its text says why, and what would be right."""

    def __init__(self, sentence: str, status: int = 400) -> None:
        super().__init__(sentence)
        self.status = status


class Feed(Protocol):
    """What one browser is shown; it reads the latest whenever it is ready for it."""

    async def changed(self) -> None:
        """Return once there is something new."""

    def read(self) -> tuple[int, dict[str, str]]:
        """Return the number of the latest, and its values as JSON text by key."""

    def heard(self, message: Mapping[str, Any]) -> None:
        """Take a message of the browser."""

    def close(self) -> None:
        """The browser has gone."""


class StaticFacts(NamedTuple):
    """What does not change while a page is served."""

    mission: Mapping[str, object]
    chart: str  # SVG


class PageSource(Protocol):
    """Answers a page's requests."""

    def facts(self) -> StaticFacts:
        """Return mission and chart."""

    def timeline(self) -> Mapping[str, object]:
        """Return what has happened so far."""

    def series(self, guard: str, since: float) -> Mapping[str, object]:
        """Return the values of a guard from a time (s) on."""

    def track(self) -> Mapping[str, object]:
        """Return where the vehicle has been."""

    def image(self, number: int) -> bytes | None:
        """Return a camera image (JPEG) by its number."""

    async def why(self, transition: str, at: float | None) -> Mapping[str, object]:
        """Return why a transition was taken or not.

        Args:
            transition: its id.
            at: s; None: now.

        Raises:
            PageError: that cannot be said.
        """

    def feed(self, session: Session) -> Feed:
        """Return what one browser is shown."""

    async def posted(
        self, what: str, body: Mapping[str, Any], session: Session
    ) -> Mapping[str, object]:
        """Carry out a request to change something.

        Args:
            what: `action`, `pilot`, `play` or `what-if`.
            body: of the request.
            session: whose request it is.

        Raises:
            PageError: it is refused.
        """
