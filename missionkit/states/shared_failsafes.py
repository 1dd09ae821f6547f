"""Failsafes that several kinds of state share (P1, section 7.2)."""

from __future__ import annotations

from missionkit.states.contract import KindFailsafe

LOCK_LIMIT = 2.0  # s, τ_timeout
SEARCH_LIMIT = 30.0  # s, τ_search
HOVER = "hover"

LOCK_LOST = KindFailsafe(
    "lock-lost", "target_lost", {"longer_than": LOCK_LIMIT}, to_kind="search", of_target=True
)
SEARCH_TIMEOUT = KindFailsafe("search-timeout", "elapsed", {"longer_than": SEARCH_LIMIT}, "gps")
UNREACHABLE = KindFailsafe("unreachable", "goal_unreachable", {}, HOVER)
HOME_UNREACHABLE = KindFailsafe("unreachable", "goal_unreachable", {}, "land")
