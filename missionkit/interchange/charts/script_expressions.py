"""Expressions of ECMAScript that a mission can say too: comparisons, In(), literals, sums."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping
from typing import Any

Value = bool | int | float | str
Guard = dict[str, Any]
TRUTH = "truth"  # a variable that is true: what `true` means as a guard

_TOKENS = re.compile(r"'[^']*'|\"[^\"]*\"|[!=]==|&&|\|\||!(?!=)|\b(?:true|false)\b")
_PYTHON = {"===": "==", "!==": "!=", "&&": " and ", "||": " or ", "!": "~"}
_PYTHON |= {"true": "True", "false": "False"}
_COMPARED = {
    ast.Eq: "equals",
    ast.Lt: "below",
    ast.Gt: "above",
    ast.LtE: "at_most",
    ast.GtE: "at_least",
}
_TURNED = {"below": "above", "above": "below", "at_most": "at_least", "at_least": "at_most"}


class BeyondError(Exception):
    """An expression says what a mission cannot."""


def guard(text: str, states: Mapping[str, str], variables: Mapping[str, Value]) -> Guard:
    """Return the guard that a condition stands for.

    Args:
        text: of the condition.
        states: names of states by their ids.
        variables: of the chart, with first values.

    Raises:
        BeyondError: there is none.
    """
    return _Reader(text, states, variables).guard(_parsed(text))


def literal(text: str) -> Value:
    """Return the number, text or truth value that is written out.

    Raises:
        BeyondError: it is anything else.
    """
    try:
        value = ast.literal_eval(_parsed(text))
    except ValueError as error:
        raise BeyondError(text) from error
    if not isinstance(value, bool | int | float | str):
        raise BeyondError(text)
    return value


def assignment(text: str, name: str, variables: Mapping[str, Value]) -> Any:
    """Return what a mission writes for `name = text`.

    Args:
        text: of the expression.
        name: of the variable.
        variables: of the chart, with first values.

    Raises:
        BeyondError: it cannot.
    """
    match _parsed(text):
        case ast.Name(id=other) if other in variables:
            return {"copy": other}
        case ast.BinOp(left=ast.Name(id=same), op=op, right=ast.Constant(value=int(by))) if (
            same == name and isinstance(op, ast.Add | ast.Sub)
        ):
            return {"add": by if isinstance(op, ast.Add) else -by}
        case _:
            return literal(text)


def _parsed(text: str) -> ast.expr:
    """Read ECMAScript as Python; `~` binds as strongly there as `!` does here."""
    python = _TOKENS.sub(lambda found: _PYTHON.get(found[0], found[0]), text)
    try:
        return ast.parse(python.strip(), mode="eval").body
    except SyntaxError as error:
        raise BeyondError(text) from error


class _Reader:
    def __init__(
        self, text: str, states: Mapping[str, str], variables: Mapping[str, Value]
    ) -> None:
        self.text = text
        self.states = states
        self.variables = variables

    def guard(self, node: ast.expr) -> Guard:
        match node:
            case ast.BoolOp(op=op, values=parts):
                return {"all" if isinstance(op, ast.And) else "any": list(map(self.guard, parts))}
            case ast.UnaryOp(op=ast.Invert(), operand=part):
                return {"not": self.guard(part)}
            case ast.Constant(value=bool(value)):
                return {"variable": TRUTH, "equals": value}
            case ast.Call(func=ast.Name(id="In"), args=[ast.Constant(value=str(state))]):
                if state in self.states:
                    return {"in": self.states[state]}
            case ast.Name(id=name) if isinstance(self.variables.get(name), bool):
                return {"variable": name, "equals": True}
            case ast.Compare(left=left, ops=[op], comparators=[right]):
                return self.compared(left, op, right)
            case _:
                pass
        raise BeyondError(self.text)

    def compared(self, left: ast.expr, op: ast.cmpop, right: ast.expr) -> Guard:
        if isinstance(op, ast.NotEq):
            return {"not": self.compared(left, ast.Eq(), right)}
        word = _COMPARED.get(type(op))
        if isinstance(left, ast.Constant):
            left, right, word = right, left, _TURNED.get(str(word), word)
        match left, right:
            case ast.Name(id=name), ast.Constant(value=value) if word and name in self.variables:
                if alike(value, self.variables[name]):
                    return {"variable": name, word: value}
        raise BeyondError(self.text)


def alike(one: object, other: object) -> bool:
    """Say whether two values are of a type that a mission compares."""
    numbers = isinstance(one, int | float) and isinstance(other, int | float)
    return type(one) is type(other) or (
        numbers and not isinstance(one, bool) and not isinstance(other, bool)
    )
