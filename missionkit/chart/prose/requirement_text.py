"""A requirement as a sentence."""

from __future__ import annotations

from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.requirements import Moment, Requirement
from missionkit.chart.prose.phrases import guard


def requirement_text(requirement: Requirement) -> str:
    """Return what a requirement demands: "ends: within 900 s it happens that land is active."."""
    demand = f"{_demand(requirement)}{_while(requirement)}"
    return f"{requirement.name}: {_scope(requirement)}{demand}.{_broken(requirement)}"


def _scope(requirement: Requirement) -> str:
    parts = []
    if requirement.after is not None:
        parts.append(f"from when {happens(requirement.after)}")
    if requirement.before is not None and requirement.precedence is None:
        parts.append(f"until {happens(requirement.before)}")
    if requirement.within is not None and requirement.precedence is None:
        first = "for the first" if requirement.existence is None else "within"
        parts.append(f"{first} {requirement.within:g} s")
    return f"{', '.join(parts)}, " if parts else ""


def _demand(requirement: Requirement) -> str:
    limit = "" if requirement.limit is None else f" within {requirement.limit:g} s"
    match requirement:
        case Requirement(never=moment) if moment is not None:
            return f"it never happens that {happens(moment)}"
        case Requirement(always=moment) if moment is not None:
            return f"always {happens(moment)}"
        case Requirement(existence=moment) if moment is not None:
            return f"it happens that {happens(moment)}"
        case Requirement(response=response) if response is not None:
            return f"whenever {happens(response.when)},{limit} {happens(response.then)}"
        case Requirement(precedence=first, before=then) if first is not None and then is not None:
            return f"before {happens(then)},{limit} {happens(first)}"
        case _:
            return ""


def _while(requirement: Requirement) -> str:
    return "" if requirement.while_ is None else f", while {happens(requirement.while_)}"


def _broken(requirement: Requirement) -> str:
    broken = requirement.broken
    if broken is None:
        return ""
    lasting = f" for {broken.after:g} s" if broken.after else ""
    return f" Broken{lasting}, it leads to {broken.to}."


def happens(moment: Moment) -> str:
    """Return a guard or the entry of a state as a clause."""
    return f"{moment.state} is entered" if isinstance(moment, ex.Enter) else guard(moment)
