"""Who commands: missionkit, or somebody else. The pilot wins, and stays until asked.

Pure: heartbeats and our own orders go in, the next state comes out.
"""

from __future__ import annotations

from enum import StrEnum
from typing import NamedTuple

AFTER = {
    "take_off": frozenset(("hold",)),
    "land": frozenset(("hold",)),
    "return": frozenset(("land", "hold")),
}
"""Modes in which the autopilot ends up by itself when what we asked for is done."""

OURS = frozenset(("hold", "offboard", "take_off", "land", "guided"))
"""Modes that a missionkit may have left behind; in any other one a pilot flies."""

_NONE: frozenset[str] = frozenset()


class Holder(StrEnum):
    """Who commands."""

    OURS = "ours"
    PILOT = "pilot"  # or the autopilot itself: we did not ask for the mode it is in


class Authority(NamedTuple):
    """Who commands, and which modes are of our making."""

    holder: Holder = Holder.OURS
    aim: str = ""  # mode we asked for last; "": none yet
    also: frozenset[str] = _NONE  # modes that follow by themselves
    mode: str = ""  # last one reported

    @property
    def ours(self) -> bool:
        """Whether we may command."""
        return self.holder is Holder.OURS


def ordered(now: Authority, mode: str) -> Authority:
    """Return the authority after we asked for `mode`."""
    return now._replace(aim=mode, also=AFTER.get(mode, _NONE) | AFTER.get(now.mode, _NONE))


def reported(now: Authority, mode: str, *, armed: bool) -> Authority:
    """Return the authority after a heartbeat.

    What counts is a change to a mode that is not of our making: an order that is refused or lost
    leaves the mode as it was, and takes nothing over. Disarmed nobody flies: any mode is fine.
    """
    if not armed:
        return Authority(now.holder, mode=mode)
    if not now.aim:  # armed by somebody else, or found flying
        holder = now.holder if mode in OURS else Holder.PILOT
        return Authority(holder, mode, AFTER.get(mode, _NONE), mode)
    if mode == now.aim:
        return now._replace(mode=mode, also=AFTER.get(mode, _NONE))
    if mode == now.mode or mode in now.also:
        return now._replace(mode=mode)
    return now._replace(holder=Holder.PILOT, mode=mode)


def lost(now: Authority) -> Authority:
    """Return the authority after the autopilot has started anew: nothing is resumed by itself."""
    return now._replace(holder=Holder.PILOT)


def resumed(now: Authority) -> Authority:
    """Return the authority after somebody asked us to go on, from whatever mode it is in."""
    return Authority(Holder.OURS, now.mode, AFTER.get(now.mode, _NONE), now.mode)
