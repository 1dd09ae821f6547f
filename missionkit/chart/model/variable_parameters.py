"""Parameters of behaviours that a variable gives: `height: {variable: h}`.

What a behaviour gets is the value at the tick at which its state is entered. So that none of them
can be wrong, every bound of the variable's declared range is tried when the mission is loaded.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import islice, product
from typing import Any

from pydantic import ValidationError

from missionkit.chart.model.model_base import Scope
from missionkit.chart.model.variables import Value, Variable
from missionkit.chart.text.mistake import sentence, sentences
from missionkit.plugin import Plugin

KEY = "variable"
MOST_TRIED = 256  # combinations of bounds


def given_by(data: Mapping[str, Any], scope: Scope) -> dict[str, str]:
    """Return which parameters variables give: parameter -> name of the variable.

    Args:
        data: parameters as the mission gives them.
        scope: with the mission's variables.

    Raises:
        ValidationError: there is no such variable, in sentences.
    """
    found: dict[str, str] = {}
    for name, value in data.items():
        if not isinstance(value, Mapping) or set(value) != {KEY}:
            continue
        variable = value[KEY]
        if not isinstance(variable, str) or variable not in scope.variables:
            unknown = f"unknown variable {variable!r}"
            raise sentences(sentence(unknown, name, word=str(variable), known=scope.variables))
        found[name] = str(variable)
    return found


def first_values(given: Mapping[str, str], scope: Scope) -> dict[str, Value]:
    """Return the parameters that variables give as they are before any variable changes.

    Raises:
        ValidationError: the range of a variable is not declared, in sentences.
    """
    return {name: bounds_of(variable, name, scope)[0] for name, variable in given.items()}


def bounds_of(name: str, parameter: str, scope: Scope) -> tuple[Value, ...]:
    """Return the values of a variable to try, its first value in front.

    Args:
        name: of the variable.
        parameter: that it gives, for messages.
        scope: with what the mission declares of it.

    Raises:
        ValidationError: its range is not declared, in sentences.
    """
    try:
        variable = Variable.model_validate(_table(scope.declared.get(name)))
    except ValidationError as error:
        wrong = f"the variable {name!r} is not declared as it should be"
        raise sentences(sentence(wrong, parameter)) from error
    first = variable.initial
    if isinstance(first, bool):
        return first, not first
    if isinstance(first, str):
        if not variable.one_of:
            raise _unbounded(name, parameter, "'one_of'")
        return first, *variable.one_of
    if variable.min is None or variable.max is None:
        raise _unbounded(name, parameter, "'min' and 'max'")
    if isinstance(first, int):
        return first, math.ceil(variable.min), math.floor(variable.max)
    return first, float(variable.min), float(variable.max)


def with_values(plugin: Plugin, values: Mapping[str, Value]) -> Plugin:
    """Return a plug-in with other values of some parameters, checked as any.

    Raises:
        ValidationError: it cannot have them.
    """
    given = {name: getattr(plugin, name) for name in plugin.model_fields_set}
    return type(plugin).model_validate({**given, **values})


def try_bounds(plugin: Plugin, given: Mapping[str, str], scope: Scope) -> None:
    """Make a plug-in with every combination of the bounds of its variables.

    Args:
        plugin: with their first values.
        given: parameter -> variable.
        scope: with what the mission declares of them.

    Raises:
        ValidationError: it cannot have one of them, in sentences.
    """
    ranges = [bounds_of(variable, name, scope) for name, variable in given.items()]
    for combined in islice(product(*ranges), MOST_TRIED):
        values = dict(zip(given, combined, strict=True))
        try:
            with_values(plugin, values)
        except ValidationError as error:
            item = error.errors(include_url=False)[0]
            at = str(item["loc"][0]) if item["loc"] else next(iter(given))
            name = at if at in given else next(iter(given))
            says = f"{at}: {item['msg'][:1].lower()}{item['msg'][1:]}"
            told = ", ".join(f"{given[key]} = {value!r}" for key, value in values.items())
            wrong = f"with {told}, which its range allows: {says}"
            raise sentences(sentence(wrong, name)) from error


def _unbounded(name: str, parameter: str, what: str) -> ValidationError:
    wrong = f"the variable {name!r} gives a parameter and needs {what}, so that it can be checked"
    return sentences(sentence(wrong, parameter))


def _table(declared: object) -> object:
    return declared if isinstance(declared, Mapping) else {"initial": declared}
