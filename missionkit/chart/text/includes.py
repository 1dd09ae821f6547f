"""`include:`: a file as a state, with parameters, so that a landing is written once.

    down: {include: charts/land_on_pad.yaml, with: {pad: north-pad}, transitions: [...]}

The file has the keys of a state (`initial`, `states`, …) and may have `params`, `guards`,
`variables` and `requirements`. Its names get the state's name in front. A name it does not define
means what the including file defines.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any, NamedTuple

from missionkit.chart.text.file_references import unfit
from missionkit.chart.text.include_renaming import Renaming
from missionkit.chart.text.located_data import (
    LocatedList,
    LocatedTable,
    Text,
    shown,
)
from missionkit.chart.text.parameter_expansion import Expanded, filled
from missionkit.chart.text.table_edits import merged, together, with_value, without
from missionkit.chart.text.unrolling import unrolled
from missionkit.chart.text.yaml_reader import Document, read_file
from missionkit.errors import FileError, Place, Problem

KEY, WITH = "include", "with"
SECTIONS = ("guards", "variables")
REQUIREMENTS = "requirements"
PLACEHOLDER_KIND = "logic"  # the kind of a state whose file cannot be used
MAX_INCLUDE_DEPTH = 8
MAX_FILES = 100


def inlined(expanded: Expanded, file: str) -> Expanded:
    """Return a document with the files it includes in place of the states that include them.

    Loops, `for_each`, are written out before.

    Args:
        expanded: the document, parameters replaced.
        file: where it stands; includes are beside it or in folders below.
    """
    expanded = unrolled(expanded)
    if not isinstance(expanded.data, LocatedTable) or not _includes(expanded.data.get("states")):
        return expanded
    work = _IncludeWork(Path(file).parent, list(expanded.problems), dict(expanded.origins))
    states = work.states(expanded.data.get("states"), _Around((Path(file),)))
    data = with_value(expanded.data, "states", states)
    for section in SECTIONS:
        data = with_value(data, section, merged(data.get(section), work.sections[section]))
    written = data.get(REQUIREMENTS)
    if work.requirements and (written is None or isinstance(written, LocatedList)):
        joined = together(
            LocatedList(data.place) if written is None else written, work.requirements
        )
        data = with_value(data, REQUIREMENTS, joined)
    return Expanded(data, work.origins, tuple(work.problems), tuple(work.files))


def _includes(states: object) -> bool:
    if not isinstance(states, LocatedTable):
        return False
    return any(
        isinstance(state, LocatedTable) and (KEY in state or _includes(state.get("states")))
        for state in states.values()
    )


class _Around(NamedTuple):
    """Where an include stands: the files that lead to it, and the state that includes the last."""

    files: tuple[Path, ...]
    state: str = ""

    def inside(self, name: str) -> str:
        """Return the name that one of its states has in the mission."""
        return f"{self.state}/{name}" if self.state else name


@dataclass(slots=True)
class _IncludeWork:
    root: Path  # nothing outside it is read
    problems: list[Problem]
    origins: dict[Place, str]
    files: list[Path] = field(default_factory=list)
    sections: dict[str, LocatedTable] = field(
        default_factory=lambda: {section: LocatedTable(Place("", 1, 1)) for section in SECTIONS}
    )
    requirements: LocatedList = field(default_factory=lambda: LocatedList(Place("", 1, 1)))

    def states(self, data: Any, around: _Around) -> Any:
        """Return `states:` with every include in it carried out."""
        if not isinstance(data, LocatedTable):
            return data
        table = LocatedTable(data.place)
        for name, state in data.items():
            new = self._state(name, state, around)
            table.put(name, new, data.key_places[name], data.value_places[name])
        return table

    def _state(self, name: str, state: Any, around: _Around) -> Any:
        if not isinstance(state, LocatedTable):
            return state
        if KEY not in state:
            inside = self.states(state.get("states"), around)
            return with_value(state, "states", inside) if "states" in state else state
        here = around.inside(name)
        path = self._path(state, around.files)
        document = None if path is None else self._read(path, state, here)
        if path is None or document is None:
            return with_value(
                without(state, (KEY, WITH)), "kind", state.get("kind", PLACEHOLDER_KIND)
            )
        inner = self._filled(document, state)
        before, self.requirements = self.requirements, LocatedList(document.data.place)
        states = self.states(inner.get("states"), _Around((*around.files, path), here))
        joined = self._joined(name, state, with_value(inner, "states", states))
        self.requirements = together(before, self.requirements)
        return joined

    def _path(self, state: LocatedTable, chain: tuple[Path, ...]) -> Path | None:
        written = state[KEY]
        wrong = _unfit(written)
        path = chain[-1].parent / str(written)
        if not wrong and path in chain:
            wrong = "it includes itself"
        if not wrong and (len(chain) > MAX_INCLUDE_DEPTH or len(self.files) >= MAX_FILES):
            wrong = f"more than {MAX_INCLUDE_DEPTH} files deep or {MAX_FILES} in all"
        wrong = wrong or unfit(self.root, path)
        if wrong:
            message = f"include {shown(written)}: {wrong}"
            self.problems.append(Problem(state.place_of(KEY), message))
            return None
        return path

    def _read(self, path: Path, state: LocatedTable, inside: str) -> Document | None:
        try:
            document = read_file(path, inside)
        except FileError as error:
            self.problems += error.problems
            return None
        self.files.append(path)
        if not isinstance(document.data, LocatedTable):
            message = f"include {path.name}: expected a mapping, got {shown(document.data)}"
            self.problems += [*document.problems, Problem(state.place_of(KEY), message)]
            return None
        return document

    def _filled(self, document: Document, state: LocatedTable) -> LocatedTable:
        given = state.get(WITH)
        if given is not None and not isinstance(given, LocatedTable):
            message = f"'with': expected a mapping (parameter: value), got {shown(given)}"
            self.problems.append(Problem(state.place_of(WITH), message))
        values = given if isinstance(given, LocatedTable) else LocatedTable(state.place)
        expanded = unrolled(filled(document, values))
        self.problems += expanded.problems
        self.origins |= expanded.origins
        return without(expanded.data, ("params",))

    def _joined(self, name: str, state: LocatedTable, inner: LocatedTable) -> LocatedTable:
        """Return the state with what the file says, where it does not say it itself."""
        names = [frozenset(_keys(inner.get(section))) for section in SECTIONS]
        renaming = Renaming(name, frozenset(_tree(inner.get("states"))), *names)
        for section, rename in (
            ("guards", renaming.guard_section),
            ("variables", renaming.variable_section),
        ):
            if isinstance(inner.get(section), LocatedTable):
                self.sections[section] = merged(self.sections[section], rename(inner[section]))
        own = self._own_requirements(inner)
        self.requirements = renaming.requirements(together(own, self.requirements))
        joined: LocatedTable = renaming.state(without(inner, (*SECTIONS, REQUIREMENTS)))
        for key, value in without(state, (KEY, WITH)).items():
            both = key == "transitions" and isinstance(value, LocatedList) and key in joined
            new = together(value, joined[key]) if both else value
            joined = with_value(joined, key, new, state.key_places[key], state.value_places[key])
        return joined

    def _own_requirements(self, inner: LocatedTable) -> LocatedList:
        own = inner.get(REQUIREMENTS)
        if own is not None and not isinstance(own, LocatedList):
            message = f"'requirements': expected a list, got {shown(own)}"
            self.problems.append(Problem(inner.place_of(REQUIREMENTS), message))
        return own if isinstance(own, LocatedList) else LocatedList(inner.place)


def _unfit(written: object) -> str:
    if not isinstance(written, Text):
        return "expected the name of a file"
    path = PurePosixPath(written)
    if path.is_absolute() or ".." in path.parts or "\\" in written or "\0" in written:
        return "expected a file beside the mission or in a folder below"
    return "" if path.suffix in {".yaml", ".yml"} else "expected a name that ends in .yaml"


def _keys(section: object) -> list[str]:
    return list(section) if isinstance(section, LocatedTable) else []


def _tree(states: object) -> list[str]:
    if not isinstance(states, LocatedTable):
        return []
    inner = (
        _tree(state.get("states")) for state in states.values() if isinstance(state, LocatedTable)
    )
    return [*states, *(name for names in inner for name in names)]
