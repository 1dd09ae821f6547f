"""Contracts of the kinds of state: guarantees, and demands on the surrounding chart."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from missionkit.messages import Estimate, Mode, Verdict


@dataclass(frozen=True, slots=True)
class KindFailsafe:
    """A transition that a state has unless the mission file gives it one to the same kind.

    Written as data, just as a mission file would: the guard's name and parameters. With
    `of_target` the guard's `target` is the one that the state's behaviour works on.
    """

    name: str
    use: str
    parameters: Mapping[str, float]
    to_kind: str
    of_target: bool = False
    emergency: bool = False  # does not wait for the dwell time


@dataclass(frozen=True, slots=True)
class KindInvariant:
    """Condition that must hold in the state: I(s) of P1, section 7.3.

    A violation is recorded at once; when it lasts `tolerated` seconds the vehicle leaves for
    the state of `to_kind`.
    """

    says: str
    check: Callable[[Estimate, str | None], Verdict]
    tolerated: float
    to_kind: str


@dataclass(frozen=True, slots=True)
class StateKind:
    """The contract of one kind of state."""

    name: str
    summary: str
    mode: Mode
    flying: bool
    default_behavior: str | None = None
    must_reach: tuple[str, ...] = ()
    invariant: KindInvariant | None = None
    failsafes: tuple[KindFailsafe, ...] = ()
