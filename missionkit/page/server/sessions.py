"""Who may look and who may act: tokens, and the sessions that they open."""

from __future__ import annotations

import hmac
import secrets
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

MOST_SESSIONS = 1000  # of which the oldest gives way


class Role(StrEnum):
    """What a session may do."""

    PILOT = "pilot"
    VIEWER = "viewer"


class Tokens(NamedTuple):
    """The words that open a session."""

    pilot: str
    view: str

    @classmethod
    def fresh(cls) -> Tokens:
        """Return tokens that cannot be guessed."""
        return cls(secrets.token_urlsafe(24), secrets.token_urlsafe(24))


@dataclass(frozen=True, slots=True)
class Session:
    """One browser."""

    key: str
    csrf: str
    role: Role
    name: str  # "pilot 1"
    address: str  # where it comes from


class Sessions:
    """Sessions by their key.

    Args:
        tokens: that open them; None: whoever reaches the page may do everything.
    """

    def __init__(self, tokens: Tokens | None) -> None:
        self._tokens = tokens
        self._open: dict[str, Session] = {}
        self._counts = dict.fromkeys(Role, 0)

    def enter(self, token: object, address: str) -> Session | None:
        """Open a session; None: the token opens none.

        Args:
            token: as the browser gives it.
            address: of the browser.
        """
        role = self._role(token)
        if role is None:
            return None
        self._counts[role] += 1
        session = Session(
            secrets.token_urlsafe(24),
            secrets.token_urlsafe(24),
            role,
            f"{role} {self._counts[role]}",
            address,
        )
        if len(self._open) >= MOST_SESSIONS:
            del self._open[next(iter(self._open))]
        self._open[session.key] = session
        return session

    def of(self, cookies: Mapping[str, str], name: str) -> Session | None:
        """Return the session that a browser's cookies name."""
        return self._open.get(cookies.get(name, ""))

    def _role(self, token: object) -> Role | None:
        if self._tokens is None:
            return Role.PILOT
        if not isinstance(token, str):
            return None
        given, found = token.encode(), None
        for role, known in ((Role.VIEWER, self._tokens.view), (Role.PILOT, self._tokens.pilot)):
            if hmac.compare_digest(given, known.encode()):
                found = role
        return found
