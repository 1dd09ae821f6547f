"""The life of a run: ready, flying, aborting, ended."""

from __future__ import annotations

from typing import Any

from transitions import Machine

_RUN_TRANSITIONS = [  # trigger, from, to
    ["start", "ready", "flying"],
    ["abort", "flying", "aborting"],
    ["finish", "flying", "ended"],
    ["finish", "aborting", "ended"],
]


class Lifecycle:
    """An ordinary machine; `state` is its name. A trigger out of order is ignored."""

    state: str
    start: Any
    abort: Any
    finish: Any

    def __init__(self) -> None:
        Machine(
            self,
            states=["ready", "flying", "aborting", "ended"],
            transitions=_RUN_TRANSITIONS,
            initial="ready",
            ignore_invalid_triggers=True,
            auto_transitions=False,
        )
