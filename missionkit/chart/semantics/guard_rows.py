"""Asking a row of guards in one plain loop.

A row's entries are `AskedGuard` as plain tuples, which are taken apart three times as fast.
"""

from __future__ import annotations

from collections.abc import Iterable

from missionkit.chart.semantics.compiled_chart import GuardContext, GuardRow
from missionkit.chart.semantics.guard_compiler import FALSE_VERDICT
from missionkit.chart.semantics.verdict_validation import is_sound
from missionkit.messages import Estimate, Verdict

Answers = dict[str, Verdict]
UNNAMED = "?"  # a guard that is not one of the package alone
_new = tuple.__new__  # quicker than the class's own


def asked(
    guards: Iterable[GuardRow],
    seen: Estimate,
    answers: Answers,
    question: GuardContext | None = None,
) -> str | None:
    """Ask guards, and return which one holds first; "": none; None: one must be asked with care.

    Args:
        guards: in the order of the record.
        seen: the estimate.
        answers: are put in here; nothing odd is.
        question: for the guards that need more than the estimate.
    """
    first = ""
    try:
        for ask, takes, name, check, measure, rising, strict, threshold, why in guards:
            value = measure(seen)
            if value.__class__ is float:
                margin = value - threshold if rising else threshold - value
                holds = margin > 0.0 if strict else margin >= 0.0
                if margin - margin != 0.0:
                    return None
                answers[name] = _new(Verdict, (holds, why, value, threshold, margin))
                if holds:
                    first = first or name
            elif value is False:
                answers[name] = FALSE_VERDICT
            else:
                verdict = (
                    ask(question)
                    if check is None
                    else answers.setdefault(name, _sound(check(seen)))
                )
                if verdict[0] or (takes and verdict[0] is None):
                    first = first or name or UNNAMED
    except Exception:  # noqa: BLE001 - asked again, contained
        return None
    return first


def none_holds(guards: Iterable[GuardRow], seen: Estimate) -> bool:
    """Say whether guards of the package all answer, and none holds."""
    try:
        for _, _, _, check, measure, rising, strict, threshold, _ in guards:
            value = measure(seen)
            if value.__class__ is float:
                margin = value - threshold if rising else threshold - value
                if (margin > 0.0 if strict else margin >= 0.0) or margin - margin != 0.0:
                    return False
            elif value is not False and _sound(check(seen))[0]:
                return False
    except Exception:  # noqa: BLE001 - asked again, contained
        return False
    return True


def _sound(verdict: Verdict) -> Verdict:
    """Return a verdict of the package's own guards.

    Raises:
        ValueError: it is odd.
    """
    if not is_sound(verdict):
        raise ValueError
    return verdict
