"""How a failsafe takes the vehicle over."""

from __future__ import annotations

from missionkit.sitl.flight_modes import Flight
from missionkit.sitl.sitl_state import ALERT, SitlState


def take_over(state: SitlState, name: str, flight: Flight, *, wait: float = 0.0) -> None:
    """Let a failsafe fly; `wait` (s) of holding come first. Each takes over once."""
    if name in state.warned or state.mode.does is flight:
        return
    state.warn_once(name, f"Failsafe activated: {name}", ALERT)
    if wait > 0.0:
        state.fly(Flight.HOLD)
        state.pending = (state.now + wait, flight)
    else:
        state.fly(flight)
    state.failsafe = name
