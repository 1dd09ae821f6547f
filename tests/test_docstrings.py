"""Public functions explain their parameters, and commands their options."""

import ast
import inspect
from collections.abc import Iterator
from pathlib import Path

import click
import typer

import missionkit
from missionkit.cli.app import app

PACKAGE = Path(missionkit.__file__).parent
Function = ast.FunctionDef | ast.AsyncFunctionDef


def public(tree: ast.Module | ast.ClassDef) -> Iterator[Function]:
    for node in tree.body:
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield from public(node)
        elif isinstance(node, Function) and not node.name.startswith("_"):
            yield node


def parameters(function: Function) -> list[ast.arg]:
    every = function.args
    listed = [*every.posonlyargs, *every.args, *every.kwonlyargs]
    return [it for it in listed if it.arg not in {"self", "cls"}]


def inherits_its_docstring(function: Function) -> bool:
    return any("override" in ast.unparse(it) for it in function.decorator_list)


def commands(command: object, name: str = "missionkit") -> Iterator[tuple[str, click.Command]]:
    yield name, command
    for child, it in getattr(command, "commands", {}).items():
        yield from commands(it, f"{name} {child}")


def code_of(command: click.Command) -> tuple[str, str]:
    code = inspect.unwrap(command.callback).__code__
    return code.co_filename, code.co_name


def test_every_public_function_of_three_parameters_or_more_explains_them():
    options = {code_of(it) for _, it in commands(typer.main.get_command(app)) if it.callback}
    bare = [
        f"{path.relative_to(PACKAGE)}:{function.lineno} {function.name}"
        for path in PACKAGE.rglob("*.py")
        for function in public(ast.parse(path.read_text(encoding="utf-8")))
        if len(parameters(function)) >= 3
        and not inherits_its_docstring(function)
        and (str(path), function.name) not in options  # they have help texts: see below
        and "Args:" not in (ast.get_docstring(function) or "").splitlines()
    ]
    assert bare == []


def test_every_option_of_every_command_has_a_help_text():
    silent = [
        f"{name} {it.name}"
        for name, command in commands(typer.main.get_command(app))
        for it in command.params
        if not getattr(it, "help", None)
    ]
    assert silent == []
