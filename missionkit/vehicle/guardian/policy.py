"""When the guardian steps in: a pure machine of states and events, without sockets or clock.

    WATCHING  nothing of ours moves the vehicle: no setpoints, or another mode than theirs
    STEERED   setpoints come, and the vehicle is in the mode that follows them
    BRAKING   none for 0.5 s: zero velocity is sent; a setpoint of the mission ends it
    HOLDING   none for 1 s, or the process is gone: the vehicle is to hold, and setpoints and orders
              of the mission are refused from here on
    HELD      it holds, or is flown by another; a person must give control back

A mission that falls silent on purpose (an order of its own such as LAND, a pilot, a vehicle that is
not heard) says so first, and is WATCHING. Zero velocity is ignored in a pilot's mode, so it is sent
at once; another mode is requested only after a later heartbeat still showed ours.
"""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple

NEVER_YET = float("-inf")
BRAKE_AFTER = 0.5  # s (of the vehicle) after the last setpoint
HOLD_AFTER = 1.0  # s after the last setpoint; PX4's own failsafe comes then by default
GIVE_UP = 5.0  # s of holding without its being seen: the autopilot's own failsafe is left to act
SETTLED = 1.0  # s of zero velocity after which a vehicle that stands is held
STANDS = 0.3  # m/s


class GuardianPhase(StrEnum):
    """Phase of the guardian."""

    WATCHING = "watching"
    STEERED = "steered"
    BRAKING = "braking"
    HOLDING = "holding"
    HELD = "held"


class Patience(NamedTuple):
    """How long silence may last (s, of the vehicle)."""

    brake: float = BRAKE_AFTER
    hold: float = HOLD_AFTER


USUAL = Patience()


class GuardianState(NamedTuple):
    """State of the guardian; times are the vehicle's (s)."""

    phase: GuardianPhase = GuardianPhase.WATCHING
    last_setpoint_at: float = (
        NEVER_YET  # when the mission's last setpoint passed, NEVER_YET after it fell silent
    )
    since: float = NEVER_YET  # when holding began
    ours: bool = False  # the newest heartbeat: armed, in the mode that follows setpoints
    confirmed: bool = False  # a heartbeat since then showed that mode
    left: bool = False  # the mission's process is gone

    @property
    def refuses(self) -> bool:
        """Whether setpoints and orders of the mission are kept from the vehicle."""
        return self.phase in {GuardianPhase.HOLDING, GuardianPhase.HELD}

    @property
    def brakes(self) -> bool:
        """Whether zero velocity is to be sent."""
        return self.phase in {GuardianPhase.BRAKING, GuardianPhase.HOLDING}

    @property
    def asks(self) -> bool:
        """Whether to request the mode for holding, where there is one."""
        return self.phase is GuardianPhase.HOLDING and self.confirmed

    @property
    def over(self) -> bool:
        """Whether there is nothing left to guard."""
        return self.left and self.phase in {GuardianPhase.WATCHING, GuardianPhase.HELD}


def setpoint(guard: GuardianState, now: float) -> GuardianState:
    """Return the state after a setpoint of the mission."""
    if guard.refuses:
        return guard
    return guard._replace(
        phase=GuardianPhase.STEERED if guard.ours else GuardianPhase.WATCHING, last_setpoint_at=now
    )


def silent(guard: GuardianState) -> GuardianState:
    """Return the state after an order of the mission, or its word that it falls silent."""
    if guard.refuses:
        return guard
    return guard._replace(phase=GuardianPhase.WATCHING, last_setpoint_at=NEVER_YET)


def heard(guard: GuardianState, *, ours: bool) -> GuardianState:
    """Return the state after a heartbeat; `ours`: armed, in the mode that follows setpoints."""
    guard = guard._replace(ours=ours)
    match guard.phase:
        case GuardianPhase.WATCHING if ours and guard.last_setpoint_at > NEVER_YET:
            return guard._replace(phase=GuardianPhase.STEERED)
        case GuardianPhase.STEERED | GuardianPhase.BRAKING if not ours:
            return guard._replace(phase=GuardianPhase.WATCHING)
        case GuardianPhase.HOLDING:
            return (
                guard._replace(confirmed=True) if ours else guard._replace(phase=GuardianPhase.HELD)
            )
        case _:
            return guard


def moves(guard: GuardianState, now: float, speed: float) -> GuardianState:
    """Return the state after a speed over ground (m/s), for a vehicle without a mode to hold in.

    Args:
        guard: state before.
        now: s, the vehicle's time.
        speed: m/s, not negative.
    """
    settled = guard.phase is GuardianPhase.HOLDING and now - guard.since >= SETTLED
    return guard._replace(phase=GuardianPhase.HELD) if settled and speed < STANDS else guard


def gone(guard: GuardianState, now: float) -> GuardianState:
    """Return the state after the end of the mission's process, however it came."""
    guard = guard._replace(left=True)
    if guard.refuses or guard.last_setpoint_at == NEVER_YET:
        return guard
    return _holding(guard, now)


def given(guard: GuardianState) -> GuardianState:
    """Return the state after a person gave control back to the mission."""
    return GuardianState(ours=guard.ours, left=guard.left)


def waited(guard: GuardianState, now: float, patience: Patience = USUAL) -> GuardianState:
    """Return the state at a time (s).

    Args:
        guard: state before.
        now: s, the vehicle's time.
        patience: s of silence before braking and holding.
    """
    silence = now - guard.last_setpoint_at
    match guard.phase:
        case GuardianPhase.STEERED | GuardianPhase.BRAKING if silence > patience.hold:
            return _holding(guard, now)
        case GuardianPhase.STEERED if silence > patience.brake:
            return guard._replace(phase=GuardianPhase.BRAKING)
        case GuardianPhase.HOLDING if now - guard.since > GIVE_UP:
            return guard._replace(phase=GuardianPhase.HELD)
        case _:
            return guard


def _holding(guard: GuardianState, now: float) -> GuardianState:
    return guard._replace(phase=GuardianPhase.HOLDING, since=now, confirmed=False)
