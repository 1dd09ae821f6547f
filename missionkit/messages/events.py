"""Events: words joined by dots that a chart can match."""

from __future__ import annotations

import re

ABORT = "operator: land"
"""Event of a landing that the operator orders; not a name that a chart can match."""

RETURN_HOME = "operator: return"
"""Event of a return that the operator orders; not a name that a chart can match."""

CONTROL_RESUMED = "control_resumed"
"""The event when a person, by a key, has let missionkit command again."""

PAUSE = "operator.pause"
"""Event of an operator who wants the vehicle to hold its place."""

CONTINUE = "operator.continue"
"""Event of an operator who lets the behaviour continue."""

GROUND_TOUCHED = "ground_touched"
"""Comes when the vehicle touches the ground outside landing and take-off."""

GIMBAL_UNKNOWN = "gimbal_unknown"
"""Comes when frames are not used because how the gimbal is turned is not known."""

MARKER_DUPLICATED = "marker_duplicated"
"""Comes when more markers of one id are in view than the mission has."""

MARKER_UPSIDE_DOWN = "marker_upside_down"
"""Comes when an upright marker is upside down in the image."""

_EVENT = re.compile(r"[A-Za-z][A-Za-z0-9_/-]*(\.[A-Za-z0-9_/-]+)*")


def is_event(word: object) -> bool:
    """Say whether something is the name of an event: "go", "gripper.closed".

    >>> is_event("gripper.closed"), is_event("operator: land"), is_event(3)
    (True, False, False)
    """
    return isinstance(word, str) and _EVENT.fullmatch(word) is not None
