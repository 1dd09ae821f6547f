"""The transition that the page asks about, by its id."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def transition_of(mission: Mapping[str, Any], wanted: str) -> Mapping[str, Any] | None:
    """Return a transition as `/api/mission` has it; None: there is none of that id.

    Args:
        mission: as `/api/mission` answers.
        wanted: id.
    """
    return next((it for it in mission["transitions"] if it["id"] == wanted), None)


def state_at(timeline: Mapping[str, Any], at: float | None) -> str:
    """Return the state that commanded.

    Args:
        timeline: as `/api/timeline` answers.
        at: s; None: last.
    """
    lanes = timeline["lanes"]
    found = [it["state"] for it in lanes if at is None or it["from"] <= at]
    return str(found[-1]) if found else str(lanes[0]["state"]) if lanes else ""
