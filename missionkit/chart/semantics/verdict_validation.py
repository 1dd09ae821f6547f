"""Whether what a guard answered can be used: types and numbers."""

from __future__ import annotations

import math
from numbers import Real

from missionkit.chart.semantics.compiled_chart import GuardContext
from missionkit.messages import Verdict

TRUTHS = frozenset((bool, type(None)))
_NUMBER_TYPES = frozenset((float, type(None)))


def is_sound(verdict: Verdict) -> bool:
    """Say whether a verdict of the package's own guards is fit for the record at once.

    A margin is the distance from the threshold, so it is neither NaN nor infinite if the value
    is not.
    """
    holds, _, value, _, margin = verdict
    if type(holds) not in TRUTHS:
        return False
    if margin is None:
        return value is None
    return type(margin) is float and margin - margin == 0.0


def trusted(name: str, boxed: tuple[object] | None, question: GuardContext) -> Verdict:
    """Return the verdict if it can be used; note what is wrong with it if not.

    Args:
        name: of the guard, for the note.
        boxed: what it returned, or `None` if it raised.
        question: of which the containment takes the note.

    Returns:
        Unknown instead of anything but a `Verdict` of a bool or `None` and finite numbers.
    """
    if boxed is None:
        return Verdict.unknown("the guard failed")
    (answer,) = boxed
    if not isinstance(answer, Verdict):
        question.contain.note(f"{name} returned {type(answer).__name__}, expected a Verdict")
        return Verdict.unknown("the guard's answer is not valid")
    verdict = answer if _native(answer) else _plain(answer)
    if verdict is None:
        question.contain.note(f"{name} returned a Verdict of {answer.holds!r}, {answer.value!r}")
        return Verdict.unknown("the guard's answer is not valid")
    if _finite(verdict):
        return verdict
    question.contain.note(f"{name} returned a number that is not finite")
    return Verdict.unknown("the guard's number is not finite")


def _native(answer: Verdict) -> bool:
    """Say whether a verdict is made of Python's own types already, as nearly all are."""
    holds, why, *numbers = map(type, answer)
    return holds is bool and why is str and _NUMBER_TYPES.issuperset(numbers)


def _plain(answer: Verdict) -> Verdict | None:
    """Return a verdict in Python's own truth values and numbers, `None` if that cannot be done.

    A comparison of numpy numbers gives a truth value that is neither `True` nor `False`.
    """
    holds: object = answer.holds
    numbers = answer[2:]
    if not all(number is None or isinstance(number, Real) for number in numbers):
        return None
    if holds is not None and type(holds).__name__ != "bool":
        return None
    holds = None if holds is None else bool(holds)
    value, threshold, margin = (None if n is None else float(n) for n in numbers)
    return Verdict(holds, str(answer.why), value, threshold, margin)


def _finite(verdict: Verdict) -> bool:
    return (
        math.isfinite(verdict.value or 0.0)
        and not math.isnan(verdict.threshold or 0.0)
        and not math.isnan(verdict.margin or 0.0)
    )
