"""YAML text -> plain data that remembers the line and column of every key and value.

The tree is built from libyaml's events, without recursion (docs/decisions/0003-yaml-reader.md).
YAML is read as version 1.2's core schema says, and strictly: duplicate keys, keys that are not
strings, own tags, numbers that are not finite and a second document are problems.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from missionkit.chart.text.foreign_files import complaint, foreign_kind
from missionkit.chart.text.located_data import (
    LocatedList,
    LocatedTable,
    Text,
    shown,
)
from missionkit.chart.text.regular_file import read_bytes
from missionkit.chart.text.yaml_errors import syntax_problem
from missionkit.chart.text.yaml_scalars import Scalar, resolve
from missionkit.errors import FileError, Place, Problem, nearest

MAX_BYTES = 4 * 1024 * 1024
MAX_DEPTH = 64
MAX_NODES = 100_000  # aliases expanded

_Loader: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_UNPRINTABLE = re.compile(
    "[^\t\n\r\x20-\x7e\x85\xa0-\ud7ff\ue000-\ufefe\uff00-\ufffd\U00010000-\U0010ffff]"
)
# Also written as an escape: what moves a cursor, ends a string or turns the direction of reading.
_HIDDEN = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff]"
)
_CORE_TAG = "tag:yaml.org,2002:"
_SCALAR_TAGS: dict[str, type | tuple[type, ...]] = {
    "null": type(None),
    "bool": bool,
    "int": int,
    "float": (int, float),
}


@dataclass(frozen=True, slots=True)
class Document:
    """Content of a file: `LocatedTable`, `LocatedList`, `Text`, numbers, ...; its problems."""

    file: str
    data: Any
    problems: tuple[Problem, ...] = ()
    inside: str = ""  # the state that includes it

    @property
    def start(self) -> Place:
        """Where the file begins."""
        return Place(self.file, 1, 1, self.inside)


def read_file(path: Path, inside: str = "") -> Document:
    """Read a file; problems call it by `path` as given.

    Args:
        path: of the file.
        inside: name of the state that includes it; places remember it.

    Raises:
        FileError: it cannot be opened, is not UTF-8, is too large, or is not YAML.
    """
    start = Place(str(path), 1, 1)
    try:
        raw = read_bytes(path, MAX_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        near = _files_like(path) if isinstance(error, FileNotFoundError) else ""
        raise FileError([Problem(start, f"cannot be read: {reason.lower()}{near}")]) from error
    if (kind := foreign_kind(raw)) is not None:
        raise FileError([Problem(start, complaint(kind, path.name))])
    try:
        text = raw.decode()
    except UnicodeDecodeError as error:
        before = raw[: error.start].decode()
        place = _place_after(before, str(path))
        raise FileError([Problem(place, "not UTF-8 text: save the file as UTF-8")]) from error
    return read(text, str(path), inside)


def read(text: str, file: str, inside: str = "") -> Document:
    """Read one YAML document.

    Args:
        text: of the file; a byte order mark is skipped.
        file: name to be shown.
        inside: name of the file that includes this one.

    Raises:
        FileError: the text is not YAML, empty, too large or too deep, so that nothing more can be
            said about it. Smaller problems are in the document.
    """
    text = text.removeprefix("\ufeff")
    if len(text) > MAX_BYTES:
        raise FileError([Problem(Place(file, 1, 1), "larger than 4 MiB")])
    if bad := _UNPRINTABLE.search(text):
        place = _place_after(text[: bad.start()], file)
        raise FileError([Problem(place, f"control character U+{ord(bad[0]):04X} in the text")])
    builder = _Builder(file, inside)
    try:
        for event in _events(text):
            builder.take(event)
    except yaml.YAMLError as error:
        raise FileError([*builder.problems, syntax_problem(error, text, file)]) from error
    if builder.root is None:
        raise FileError(builder.problems or [Problem(Place(file, 1, 1), "the file is empty")])
    return Document(file, builder.root, tuple(builder.problems), inside)


def _files_like(path: Path) -> str:
    """Return a hint at the YAML files beside one that does not exist."""
    names = [it.name for it in path.parent.glob("*.y*ml")] if path.parent.is_dir() else []
    return f"; {nearest(path.name, names)}" if names else ""


def _events(text: str) -> Iterator[Any]:
    loader = _Loader(text)
    try:
        while loader.check_event():
            yield loader.get_event()
    finally:
        loader.dispose()


def _place_after(before: str, file: str) -> Place:
    return Place(file, before.count("\n") + 1, len(before) - before.rfind("\n"))


@dataclass(slots=True)
class _Open:
    """A mapping or list that has begun and not yet ended."""

    node: LocatedTable | LocatedList
    anchor: str | None
    nodes: int = 1
    height: int = 1
    key: Text | None = None


@dataclass(slots=True)
class _Builder:
    file: str
    inside: str = ""
    root: Any = None
    problems: list[Problem] = field(default_factory=list)
    stack: list[_Open] = field(default_factory=list)
    anchors: dict[str, tuple[Any, int, int]] = field(default_factory=dict)
    documents: int = 0

    def take(self, event: Any) -> None:
        """Add one event of the parser to the tree."""
        match event:
            case yaml.ScalarEvent():
                self._scalar(event)
            case yaml.MappingStartEvent():
                self._open(event, LocatedTable(self._place(event)))
            case yaml.SequenceStartEvent():
                self._open(event, LocatedList(self._place(event)))
            case yaml.MappingEndEvent() | yaml.SequenceEndEvent():
                self._close()
            case yaml.AliasEvent():
                self._alias(event)
            case yaml.DocumentStartEvent():
                self._document(event)
            case _:
                pass  # stream and document ends carry nothing

    def _place(self, event: Any) -> Place:
        mark = event.start_mark
        return Place(self.file, mark.line + 1, mark.column + 1, self.inside)

    def _document(self, event: Any) -> None:
        self.documents += 1
        if self.documents > 1:
            self._refuse(self._place(event), "a second document: move it to a file of its own")

    def _refuse(self, place: Place, message: str) -> None:
        raise FileError([*self.problems, Problem(place, message)])

    def _scalar(self, event: Any) -> None:
        place = self._place(event)
        value = self._value(event, place)
        if isinstance(value, str) and (bad := _HIDDEN.search(value)):
            message = f"control character U+{ord(bad[0]):04X} in a text: it hides what is written"
            self.problems.append(Problem(place, message))
        if event.anchor:
            self.anchors[event.anchor] = (value, 1, 0)
        self._add(value, place, 1, 0)

    def _value(self, event: Any, place: Place) -> Scalar:
        plain = event.implicit[0]
        tag = event.tag
        if not plain and tag in {None, "!", f"{_CORE_TAG}str"}:
            return Text(event.value, place)
        try:
            value = resolve(event.value)
        except ValueError as error:
            self.problems.append(Problem(place, str(error)))
            return None
        if not plain:
            self._check_tag(tag, value, place)
        return Text(value, place) if isinstance(value, str) else value

    def _check_tag(self, tag: str, value: Scalar, place: Place) -> None:
        allowed = _SCALAR_TAGS.get(tag.removeprefix(_CORE_TAG))
        if allowed is None:
            self.problems.append(Problem(place, f"tag {tag!r}: tags are not used"))
        elif not isinstance(value, allowed):
            self.problems.append(
                Problem(place, f"{value!r} is not a valid {tag.removeprefix(_CORE_TAG)}")
            )

    def _open(self, event: Any, node: LocatedTable | LocatedList) -> None:
        if event.tag not in {None, "!", f"{_CORE_TAG}map", f"{_CORE_TAG}seq"}:
            self.problems.append(Problem(node.place, f"tag {event.tag!r}: tags are not used"))
        self.stack.append(_Open(node, event.anchor))
        self._check_depth(node.place, 0)

    def _check_depth(self, place: Place, height: int) -> None:
        if len(self.stack) + height > MAX_DEPTH:
            self._refuse(place, f"nested deeper than {MAX_DEPTH} levels")

    def _close(self) -> None:
        closed = self.stack.pop()
        if closed.anchor:
            self.anchors[closed.anchor] = (closed.node, closed.nodes, closed.height)
        self._add(closed.node, closed.node.place, closed.nodes, closed.height)

    def _alias(self, event: Any) -> None:
        place = self._place(event)
        if event.anchor not in self.anchors:
            self._refuse(place, f"alias *{event.anchor}: no anchor &{event.anchor} before it")
        value, nodes, height = self.anchors[event.anchor]
        self._check_depth(place, height)
        self._add(value, place, nodes, height)

    def _add(self, value: Any, place: Place, nodes: int, height: int) -> None:
        if not self.stack:
            self.root = value
            return
        parent = self.stack[-1]
        parent.nodes += nodes
        parent.height = max(parent.height, height + 1)
        if parent.nodes > MAX_NODES:
            self._refuse(place, f"more than {MAX_NODES} values: too large")
        if isinstance(parent.node, LocatedList):
            parent.node.put(value, place)
        elif parent.key is None:
            parent.key = self._key(value, place)
        else:
            self._entry(parent.node, parent.key, value, place)
            parent.key = None

    def _key(self, value: object, place: Place) -> Text:
        if isinstance(value, Text):
            return Text(value, place)
        self.problems.append(Problem(place, f"a key must be a word, got {shown(value)}"))
        return Text("", place)

    def _entry(self, table: LocatedTable, key: Text, value: object, place: Place) -> None:
        if key in table:
            first = table.key_places[key]
            message = f"duplicate key {str(key)!r}: first given in line {first.line}"
            self.problems.append(Problem(key.place, message))
        elif key:
            table.put(str(key), value, key.place, place)
