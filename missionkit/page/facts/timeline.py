"""The timeline of a flight: states, transitions, problems, and how requirements stood."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any


class Timeline:
    """Grows with the flight."""

    def __init__(self) -> None:
        self._lanes: list[dict[str, Any]] = []
        self._fired: list[Mapping[str, Any]] = []
        self._problems: list[dict[str, Any]] = []
        self._requirements: dict[str, list[dict[str, Any]]] = {}
        self._end = 0.0

    def stands(self, at: float, state: str) -> None:
        """Note the state that commands at a time (s)."""
        self._end = max(self._end, at)
        if self._lanes and self._lanes[-1]["state"] == state:
            return
        if self._lanes:
            self._lanes[-1]["to"] = at
        self._lanes.append({"state": state, "from": at, "to": None})

    def happened(
        self, fired: Iterable[Mapping[str, Any]], problems: Iterable[dict[str, Any]]
    ) -> None:
        """Note transitions and problems."""
        self._fired.extend(fired)
        self._problems.extend(problems)

    def required(self, at: float, rows: Iterable[Mapping[str, Any]]) -> None:
        """Note how requirements stand at a time (s)."""
        for row in rows:
            known = self._requirements.setdefault(row["name"], [])
            if not known or known[-1]["verdict"] != row["verdict"]:
                known.append({"at": at, "verdict": row["verdict"]})

    def as_value(self) -> dict[str, Any]:
        """Return what `/api/timeline` answers."""
        return {
            "lanes": [dict(it) for it in self._lanes],
            "fired": list(self._fired),
            "problems": [dict(it) for it in self._problems],
            "requirements": {name: list(it) for name, it in self._requirements.items()},
            "end": self._end,
        }
