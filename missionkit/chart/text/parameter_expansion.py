"""Parameters of a mission: `params:` in the file, `$name` where they are used, `--set name=value`.

`$name` stands for a whole value, never for a part of a text; `$$name` is the text "$name".
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from missionkit.chart.text.located_data import LocatedList, LocatedTable, Text
from missionkit.chart.text.mistake import MAX_HINTS
from missionkit.chart.text.yaml_reader import Document, read
from missionkit.errors import FileError, Place, Problem, nearest

SECTION, LOOP = "params", "for_each"
PARAMETER_PATTERN = r"^\$[A-Za-z_][A-Za-z0-9_-]*$"
_REFERENCE = re.compile(PARAMETER_PATTERN)


@dataclass(frozen=True, slots=True)
class Expanded:
    """A document without `$name`: its data, where each parameter was used, and what is wrong."""

    data: Any
    origins: Mapping[Place, str]  # place of use -> parameter
    problems: tuple[Problem, ...]
    files: tuple[Path, ...] = ()  # that were read besides the document's own


def expand(document: Document, overrides: Mapping[str, str]) -> Expanded:
    """Put the value of each parameter where `$name` stands.

    Args:
        document: the mission as read.
        overrides: values by name, in YAML, which replace those of the file.
    """
    data = document.data
    if not isinstance(data, LocatedTable):
        return Expanded(data, {}, document.problems)
    expansion = _Expansion(_written(document), list(document.problems))
    at = data.key_places.get(SECTION, document.start)
    return expansion.expanded(data, expansion.override(overrides, at))


def filled(document: Document, given: LocatedTable) -> Expanded:
    """Put the value of each parameter where `$name` stands, as `expand` does.

    Args:
        document: an included file as read, a mapping.
        given: values by name, which replace those of the file.
    """
    expansion = _Expansion(_written(document), list(document.problems))
    return expansion.expanded(document.data, expansion.given(given))


def _written(document: Document) -> LocatedTable:
    written = document.data.get(SECTION)
    return written if isinstance(written, LocatedTable) else LocatedTable(document.start)


@dataclass(slots=True)
class _Expansion:
    parameters: LocatedTable
    problems: list[Problem]
    values: LocatedTable = field(init=False)
    origins: dict[Place, str] = field(default_factory=dict)
    looped: frozenset[str] = frozenset()  # names of the loops around, replaced later

    def expanded(self, data: LocatedTable, values: LocatedTable) -> Expanded:
        """Return a document with the values in it."""
        table = LocatedTable(data.place)
        for key, value in data.items():
            at = data.value_places[key]
            new = values if value is self.parameters else self.replaced(value, at)
            table.put(key, new, data.key_places[key], at)
        self.report_unused()
        return Expanded(table, self.origins, tuple(self.problems))

    def given(self, given: LocatedTable) -> LocatedTable:
        """Return the parameters with the values of `with:`."""
        self.values = LocatedTable(self.parameters.place)
        for name, value in self.parameters.items():
            source = given if name in given else self.parameters
            places = source.key_places[name], source.value_places[name]
            self.values.put(name, given.get(name, value), *places)
        for name in given.keys() - self.parameters.keys():
            self._report(given.key_places[name], f"with: no such parameter {name!r}", name)
        return self.values

    def override(self, overrides: Mapping[str, str], at: Place) -> LocatedTable:
        """Return the parameters with the values of the command line."""
        self.values = LocatedTable(self.parameters.place)
        for name, value in self.parameters.items():
            places = self.parameters.key_places[name], self.parameters.value_places[name]
            if isinstance(value, str) and _REFERENCE.match(value):
                self._report(places[1], f"parameter {name!r} cannot be another parameter, {value}")
            self.values.put(name, value, *places)
        for name, text in overrides.items():
            if name in self.parameters:
                self.values[name] = self._given(name, text, at)
            else:
                self._report(at, f"--set {name}: no such parameter", name)
        return self.values

    def replaced(self, value: Any, place: Place) -> Any:
        """Return a value with each `$name` in it replaced."""
        if isinstance(value, LocatedTable):
            return self._replaced_table(value)
        if isinstance(value, LocatedList):
            row = LocatedList(value.place)
            for item, at in zip(value, value.value_places, strict=True):
                row.put(self.replaced(item, at), at)
            return row
        if isinstance(value, Text) and value.startswith("$"):
            return self._parameter(value, place)
        return value

    def _replaced_table(self, value: LocatedTable) -> LocatedTable:
        looped = value.get(LOOP)
        outer = self.looped
        inner = outer | looped.keys() if isinstance(looped, LocatedTable) else outer
        table = LocatedTable(value.place)
        for key, item in value.items():
            at = value.value_places[key]
            self.looped = outer if key == LOOP else inner
            table.put(key, self.replaced(item, at), value.key_places[key], at)
        self.looped = outer
        return table

    def report_unused(self) -> None:
        """Add a problem for each parameter that stands nowhere."""
        for name in self.values.keys() - set(self.origins.values()):
            message = f"parameter {name!r} is never used; write ${name} where it belongs"
            self._report(self.values.key_places[name], message)

    def _parameter(self, value: Text, place: Place) -> Any:
        if value.startswith("$$"):
            return Text(value[1:], value.place)
        if not _REFERENCE.match(value):
            return value
        name = value[1:]
        if name in self.looped:
            return value
        if name not in self.values:
            self._report(place, f"unknown parameter {value}", name)
            return None
        self.origins[place] = name
        found = self.values[name]
        return Text(found, place) if isinstance(found, Text) else found

    def _given(self, name: str, text: str, at: Place) -> Any:
        try:
            document = read(text, "--set")
        except FileError as error:
            problems = error.problems if text.strip() else (Problem(at, "no value"),)
        else:
            problems = document.problems
            if not problems:
                return document.data
        for problem in problems:
            self._report(at, f"--set {name}={text}: {problem.message}")
        return self.parameters[name]

    def _report(self, place: Place, message: str, unknown: str | None = None) -> None:
        if unknown is not None and len(self.problems) < MAX_HINTS:
            message += f"; {nearest(unknown, self.values)}"
        self.problems.append(Problem(place, message))
