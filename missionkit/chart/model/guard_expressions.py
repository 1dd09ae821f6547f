"""Guard expressions as data: what a transition, failsafe or invariant waits for."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, Generic, TypeVar, cast

from pydantic import BaseModel

from missionkit.errors import Place
from missionkit.plugin import Plugin
from missionkit.plugin_protocols import CompositeGuardProtocol

P_co = TypeVar("P_co", covariant=True)  # a model of parameters, with the methods of its group

NO_VARIABLES: Final[Mapping[str, str]] = MappingProxyType({})


@dataclass(frozen=True, slots=True)
class Use(Generic[P_co]):
    """A plug-in with its parameters."""

    kind: str
    plugin: P_co
    place: Place
    variables: tuple[tuple[str, str], ...] = ()  # parameters that variables give: name, variable


@dataclass(frozen=True, slots=True)
class Named:
    """A guard from the mission's `guards:` section."""

    name: str
    place: Place


@dataclass(frozen=True, slots=True)
class All:
    """Holds when every part holds."""

    parts: tuple[Expression, ...]
    place: Place


@dataclass(frozen=True, slots=True)
class Any:
    """Holds when at least one part holds."""

    parts: tuple[Expression, ...]
    place: Place


@dataclass(frozen=True, slots=True)
class Not:
    """Holds when the part does not; unknown when the part is."""

    part: Expression
    place: Place


@dataclass(frozen=True, slots=True)
class Hysteresis:
    """A latch on the part's value.

    With `enter` > `exit` it begins to hold at value >= `enter` and ends at value < `exit`; with
    `enter` < `exit` it begins at value <= `enter` and ends at value > `exit`.
    """

    part: Expression  # one guard with a value
    enter: float
    exit: float
    place: Place


@dataclass(frozen=True, slots=True)
class VariableGuard:
    """Compares a variable of the mission."""

    name: str
    op: str  # one of COMPARISONS
    value: bool | int | float | str
    place: Place


@dataclass(frozen=True, slots=True)
class In:
    """Holds while a state is active, in another region or around this one."""

    state: str
    place: Place


@dataclass(frozen=True, slots=True)
class Finished:
    """Holds while a state is in a final state inside it, in every region. Written `done`."""

    state: str
    groups: tuple[tuple[str, ...], ...]  # final states: one of each group must be active
    place: Place


@dataclass(frozen=True, slots=True)
class Enter:
    """Happens when a state is entered; in requirements only."""

    state: str
    place: Place


COMPARISONS = ("equals", "below", "above", "at_least", "at_most")
Expression = Use[Plugin] | Named | All | Any | Not | Hysteresis | VariableGuard | In | Finished


def text(expression: Expression) -> str:
    """Return a guard as a person would say it: "marker-sure and not within trunk"."""
    match expression:
        case Named(name=name):
            return name
        case Use():
            return use_text(expression)
        case All(parts=parts) | Any(parts=parts):
            word = " and " if isinstance(expression, All) else " or "
            return word.join(map(_grouped, parts))
        case Not(part=part):
            return f"not {_grouped(part)}"
        case Hysteresis(part=part, enter=enter, exit=leave):
            return f"{_grouped(part)} from {enter:g} until {leave:g}"
        case _:
            return _chart_text(expression)


def _chart_text(expression: VariableGuard | In | Finished) -> str:
    match expression:
        case VariableGuard(name=name, op=op, value=value):
            return f"{name} {op.replace('_', ' ')} {_value(value)}"
        case In(state=state):
            return f"in {state}"
        case Finished(state=state):
            return f"done ({state})"


def use_text(use: Use[object]) -> str:
    """Return a plug-in with the parameters the mission gave it: "within 9 of trunk"."""
    words = use.kind.replace("_", " ")
    model = cast(BaseModel, use.plugin)
    if isinstance(model, Plugin) and (own := model.text()):
        return f"{words} ({own})"
    given = _given(model, dict(use.variables))
    return f"{words} ({given})" if given else words


def _given(model: BaseModel, variables: Mapping[str, str] = NO_VARIABLES) -> str:
    return ", ".join(
        f"{name} of the variable {variables[name]}"
        if name in variables
        else f"{name} {_value(getattr(model, name))}"
        for name in type(model).model_fields
        if name in model.model_fields_set
    )


def _value(value: object) -> str:
    if isinstance(value, float):
        return f"{value:g}"
    if isinstance(value, (tuple, list)):
        return f"[{', '.join(map(_value, value))}]"
    if isinstance(value, BaseModel):
        return f"({_given(value)})"
    return str(value)


def _grouped(expression: Expression) -> str:
    written = text(expression)
    return f"({written})" if isinstance(expression, (All, Any)) else written


def names_in(expression: Expression) -> Iterator[Named]:
    """Yield every reference to a named guard."""
    yield from (part for part in parts_of(expression) if isinstance(part, Named))


def opened(
    expressions: Iterable[Expression], named: Mapping[str, Expression]
) -> Iterator[Expression]:
    """Yield every guard inside some, or read by them; named ones are looked into once."""
    waiting, seen = list(expressions), set[str]()
    while waiting:
        for part in parts_of(waiting.pop()):
            yield part
            if isinstance(part, Named) and part.name not in seen:
                seen.add(part.name)
                waiting.append(named[part.name])


def parts_of(expression: Expression) -> Iterator[Expression]:
    """Yield a guard and every guard inside it, or read by it; named ones are not looked into."""
    waiting = [expression]
    while waiting:
        part = waiting.pop()
        yield part
        match part:
            case All(parts=parts) | Any(parts=parts):
                waiting += reversed(parts)
            case Not(part=inner) | Hysteresis(part=inner):
                waiting.append(inner)
            case Use(plugin=CompositeGuardProtocol() as plugin, place=place):
                names = [it.name for it in plugin.named_inputs() if it.what == "guard"]
                waiting += [Named(name, place) for name in reversed(names)]
            case _:
                pass


def variables_in(expression: Expression) -> Iterator[tuple[str, Place]]:
    """Yield every variable that a guard of a plug-in reads, and where that stands."""
    for part in parts_of(expression):
        if isinstance(part, Use) and isinstance(part.plugin, CompositeGuardProtocol):
            for it in part.plugin.named_inputs():
                if it.what == "variable":
                    yield it.name, part.place
