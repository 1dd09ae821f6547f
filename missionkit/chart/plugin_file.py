"""Plug-ins in a Python file of the user's own, given with `--plugin path.py`."""

from __future__ import annotations

import importlib.util
import inspect
import sys
import traceback
from pathlib import Path
from types import ModuleType

from pydantic import BaseModel

from missionkit.chart.plugin_check import grouped
from missionkit.chart.text.regular_file import irregular
from missionkit.errors import FileError, Place, Problem, UsageError
from missionkit.plugin import Plugin
from missionkit.plugin_containment import PluginError, reporting_faults


def plugins_of(path: Path) -> list[tuple[str, type[Plugin]]]:
    """Return the plug-ins that a Python file defines, each with its group, in order.

    They are its models of parameters that have a `kind` of their own.

    Raises:
        FileError: it cannot be imported, defines no plug-in, or one that fits no group.
    """
    module = _imported(path)
    models = [
        item
        for item in vars(module).values()
        if isinstance(item, type)
        and issubclass(item, BaseModel)
        and item.__module__ == module.__name__
        and isinstance(vars(item).get("kind"), str)
    ]
    found, problems = [], []
    for model in models:
        try:
            found.append(grouped(model))
        except UsageError as error:
            line = inspect.getsourcelines(model)[1]
            problems.append(Problem(Place(str(path), line, 1), str(error)))
    if not models:
        names = "Guard, WindowGuard, Behavior or Detector, or from pydantic.BaseModel"
        message = f"no plug-in here: define a class with a `kind`, derived from {names}"
        problems.append(Problem(Place(str(path), 1, 1), message))
    if problems:
        raise FileError(problems)
    return found


def _imported(path: Path) -> ModuleType:
    name = f"missionkit_plugin_{path.stem}"
    spec = importlib.util.spec_from_file_location(name, path)
    if spec is None or spec.loader is None or not path.is_file():
        other = f"it is {kind}, not a file" if (kind := irregular(path)) else "not a Python file"
        reason = other if path.exists() else "no such file"
        raise FileError([Problem(Place(str(path), 1, 1), f"cannot be read: {reason}")])
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # pydantic resolves annotations through it
    writes, sys.dont_write_bytecode = (
        sys.dont_write_bytecode,
        True,
    )  # nothing beside the user's file
    try:
        with reporting_faults():
            spec.loader.exec_module(module)
    except PluginError as error:
        del sys.modules[name]
        raise FileError([_import_problem(path, error)]) from error.__cause__
    finally:
        sys.dont_write_bytecode = writes
    return module


def _import_problem(path: Path, fault: PluginError) -> Problem:
    message, error = f"cannot be imported: {fault}", fault.__cause__
    imported = str(path.absolute())  # as the import system calls it
    if isinstance(error, SyntaxError) and error.filename == imported:
        place = Place(str(path), error.lineno or 1, error.offset or 1)
        return Problem(place, f"cannot be imported: {error.msg}")
    trace = traceback.extract_tb(None if error is None else error.__traceback__)
    frames = [f for f in trace if f.filename == imported]
    last = frames[-1] if frames else None
    line, column = (last.lineno or 1, (last.colno or 0) + 1) if last else (1, 1)
    return Problem(Place(str(path), line, column), message)
