"""Mistakes on the command line, each in one sentence of our own."""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping
from typing import Any, NoReturn, cast

import typer
from typer.core import TyperGroup
from typing_extensions import override

from missionkit.errors import ExitCode, nearest, printable

# the library's base of every mistake of the user
_MISTAKE = cast(type[Exception], typer.BadParameter.__mro__[1])
_EXPECTED = {
    "int_parsing": "a whole number",
    "int_from_float": "a whole number",
    "float_parsing": "a number",
    "finite_number": "a finite number",
    "greater_than_equal": "{ge:g} or more",
    "less_than_equal": "{le:g} or less",
    "greater_than": "more than {gt:g}",
    "less_than": "less than {lt:g}",
    "enum": "{expected}",
    "literal_error": "{expected}",
}


class WordedErrors(TyperGroup):
    """A group of commands, with errors in their use worded as elsewhere in missionkit."""

    @override
    def make_context(self, *args: Any, **kwargs: Any) -> Any:
        try:
            return super().make_context(*args, **kwargs)
        except _MISTAKE as error:
            _tell(error, "missionkit")

    @override
    def invoke(self, ctx: Any) -> Any:
        try:
            return super().invoke(ctx)
        except _MISTAKE as error:
            _tell(error, f"{ctx.command_path} {ctx.invoked_subcommand}")


def _tell(error: Exception, command: str) -> NoReturn:
    """Print the sentence and exit; without arguments at all, the library's help is shown."""
    if type(error).__name__ == "NoArgsIsHelpError":
        raise error
    print(printable(sentence(error, command)), file=sys.stderr)  # noqa: T201
    raise typer.Exit(ExitCode.BAD_FILE) from error


def sentence(error: Any, command: str) -> str:
    """Return where on the command line a mistake is, what is wrong, and what would be right.

    Args:
        error: as the command-line library raises it.
        command: what was called, where the error does not say.
    """
    context = error.ctx
    where = command if context is None else context.command_path
    return f"{where}: {_said(error, context)}; {where} --help says what it takes"


def _said(error: Any, context: Any) -> str:
    param = getattr(error, "param", None)
    name = "" if param is None else _name(param)
    if hasattr(error.__cause__, "errors"):  # pydantic's, which `--help` does without
        return f"{name}: {_unfit(error.__cause__.errors()[0])}"
    kind = type(error).__name__
    if kind == "MissingParameter":
        return f"{name} is missing"
    if kind == "BadOptionUsage" and "requires" in error.message:
        return f"{error.option_name}: its value is missing"
    if kind == "NoSuchOption":
        options = {it for one in context.command.params for it in one.opts if it[:2] == "--"}
        return f"no option {error.option_name}; {nearest(error.option_name, options | {'--help'})}"
    return _of_words(error.message, context)


def _of_words(message: str, context: Any) -> str:
    """Return a sentence for mistakes that the library gives as text alone."""
    if unknown := re.match(r"No such command '(.*?)'", message):
        return f"no command {unknown[1]!r}; {nearest(unknown[1], context.command.commands)}"
    if extra := re.search(r"unexpected extra arguments?(?:\(s\))? \((.*)\)", message):
        return f"{extra[1]!r} is one argument too many"
    return message[:1].lower() + message[1:].rstrip(".")


def _name(param: Any) -> str:
    longest: str = max(param.opts, key=len, default="")
    return longest if longest.startswith("-") else str(param.metavar or param.name)


def _unfit(wrong: Mapping[str, Any]) -> str:
    expected = _EXPECTED.get(wrong["type"], "").format_map(wrong.get("ctx", {}))
    return f"expected {expected or 'another value'}, got {wrong['input']!r}"
