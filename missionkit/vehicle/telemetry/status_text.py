"""Status texts of the autopilot, as events for the chart and the record."""

from __future__ import annotations

import re

SEVERITIES = ("emergency", "alert", "critical", "error", "warning", "notice", "info", "debug")
LONGEST_TEXT = 60


def event_of(severity: int, text: str) -> str:
    """Return the event of one line.

    >>> event_of(4, "Failsafe activated!")
    'status.warning.Failsafe_activated'
    """
    level = SEVERITIES[severity] if 0 <= severity < len(SEVERITIES) else "info"
    words = re.sub(r"[^A-Za-z0-9]+", "_", text).strip("_")[:LONGEST_TEXT] or "nothing"
    return f"status.{level}.{words}"
