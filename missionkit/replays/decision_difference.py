"""In what two decisions differ, to the last bit, and the name of the first such field."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from missionkit.messages import Verdict
from missionkit.recorder.flight_journal import Decision

Named = tuple[tuple[str, Verdict], ...]


def first_difference(flown: Decision, now: Decision) -> str:
    """Return the first field that differs, with both values; "" if none does.

    Args:
        flown: as recorded.
        now: as replayed.
    """
    return next(_differences(flown, now), "")


def same(one: Any, other: Any) -> bool:
    """Say whether two plain values are the same to the last bit, types included.

    >>> same(0.0, -0.0), same(math.nan, math.nan)
    (False, True)
    """
    if one is other:
        return True
    if type(one) is not type(other):
        return False
    if isinstance(one, float):
        equal = one == other and math.copysign(1.0, one) == math.copysign(1.0, other)
        return equal or (math.isnan(one) and math.isnan(other))
    if isinstance(one, np.ndarray):
        return one.dtype == other.dtype and one.shape == other.shape and _bytes(one, other)
    if isinstance(one, tuple):
        return len(one) == len(other) and all(map(same, one, other))
    return bool(one == other)


def _bytes(one: np.ndarray[Any, Any], other: np.ndarray[Any, Any]) -> bool:
    return one.tobytes() == other.tobytes()


def _differences(flown: Decision, now: Decision) -> Iterator[str]:
    for name in ("active", "state"):
        was, is_now = getattr(flown, name), getattr(now, name)
        if was != is_now:
            yield f"{name}: {_text(was)} flown, {_text(is_now)} replayed"
    yield from _verdicts("guard", flown.verdicts, now.verdicts)
    if not same(flown.fired, now.fired):
        yield f"transitions: {_fired(flown)} flown, {_fired(now)} replayed"
    for name in flown.command._fields:
        was, is_now = getattr(flown.command, name), getattr(now.command, name)
        if not same(was, is_now):
            yield f"command, {name}: {_text(was)} flown, {_text(is_now)} replayed"
    for name in ("step_note", "done"):
        was, is_now = getattr(flown, name), getattr(now, name)
        if was != is_now:
            yield f"{name}: {_text(was)} flown, {_text(is_now)} replayed"


def _verdicts(word: str, flown: Named, now: Named) -> Iterator[str]:
    before, after = dict(flown), dict(now)
    for name in dict.fromkeys((*before, *after)):
        was, is_now = before.get(name), after.get(name)
        if was is None or is_now is None:
            yield f"{word} {name}: evaluated {'now' if was is None else 'in flight'} only"
        elif not same(was, is_now):
            field = next(
                it for it in was._fields if not same(getattr(was, it), getattr(is_now, it))
            )
            values = f"{_text(getattr(was, field))} flown, {_text(getattr(is_now, field))} replayed"
            yield f"{word} {name}, {field}: {values}"


def _fired(decision: Decision) -> str:
    return ", ".join(f"{it.source} -> {it.to} ({it.reason})" for it in decision.fired) or "none"


def _text(value: Any) -> str:
    if isinstance(value, str):
        return value or "nothing"
    if isinstance(value, tuple) and all(isinstance(part, str) for part in value):
        return ", ".join(value) or "none"
    return repr(value)
