"""Who acts: one pilot at a time, replaced by consent or after silence."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from missionkit.page.server.page_source import PageError
from missionkit.page.server.sessions import Role, Session

LONGEST_SILENCE = 10.0  # s after which another may take over without being granted it

Announce = Callable[[str, Session], None]


@dataclass
class PilotSeat:
    """The one pilot of a page.

    Args:
        clock: s.
        announce: is told what changed, and by whom: "took the controls", ...
    """

    clock: Callable[[], float]
    announce: Announce
    pilot: Session | None = None
    asking: Session | None = None
    _alive_at: float = 0.0

    def arrived(self, session: Session) -> None:
        """Give the first with the pilot's token the controls."""
        if session.role is Role.PILOT and self.pilot is None:
            self._seat(session, "took the controls")

    def alive(self, session: Session) -> bool:
        """Note a sign of life; return whether it is the pilot's."""
        if session is not self.pilot:
            return False
        self._alive_at = self.clock()
        return True

    @property
    def silent_for(self) -> float | None:
        """Time (s) since the pilot's last sign of life; None: there is no pilot."""
        return None if self.pilot is None else max(0.0, self.clock() - self._alive_at)

    def change(self, wanted: object, session: Session) -> None:
        """Ask for the controls, grant or refuse them, or release them.

        Args:
            wanted: ask, grant, refuse or release.
            session: whose wish it is.

        Raises:
            PageError: that cannot be done now.
        """
        deeds = {
            "ask": self._ask,
            "grant": self._grant,
            "refuse": self._refuse,
            "release": self._release,
        }
        if not isinstance(wanted, str) or wanted not in deeds:
            raise PageError(f"do: {wanted!r} is unknown; known: {', '.join(deeds)}")
        if wanted != "ask" and session is not self.pilot:
            raise PageError("only the pilot can do that", 403)
        deeds[wanted](session)

    def _ask(self, session: Session) -> None:
        silence = self.silent_for
        if session is self.pilot:
            return
        if silence is None or silence > LONGEST_SILENCE:
            before = "" if self.pilot is None else f" from {self.pilot.name}, silent"
            self._seat(session, f"took the controls{before}")
        else:
            self.asking = session
            self.announce("asked for the controls", session)

    def _grant(self, _: Session) -> None:
        if self.asking is None:
            raise PageError("nobody has asked for the controls", 409)
        before = self.pilot
        given = "" if before is None else f", granted by {before.name}"
        self._seat(self.asking, f"took the controls{given}")

    def _refuse(self, session: Session) -> None:
        self.asking = None
        self.announce("kept the controls", session)

    def _release(self, session: Session) -> None:
        self.pilot = None
        self.announce("released the controls", session)
        if self.asking is not None:
            self._seat(self.asking, "took the controls")

    def _seat(self, session: Session, what: str) -> None:
        self.pilot, self.asking, self._alive_at = session, None, self.clock()
        self.announce(what, session)

    def as_value(self, session: Session) -> Mapping[str, object]:
        """Return what one browser is shown of it."""
        silence = self.silent_for
        return {
            "you": session is self.pilot,
            "name": None if self.pilot is None else self.pilot.name,
            "asked_by": None if self.asking is None else self.asking.name,
            "silent_for": None if silence is None else round(silence, 1),
        }
