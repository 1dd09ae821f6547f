"""From a file to a validated model, or to every problem found in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import astuple, replace
from pathlib import Path
from types import MappingProxyType
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from missionkit.chart import map_loading
from missionkit.chart.model import named_guards, structure_rules, tracked_targets, variable_uses
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.model_base import Scope
from missionkit.chart.model.validation_problems import plain, problems_in
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.text.document_kind import document_kind
from missionkit.chart.text.file_references import NO_SUCH_FILE, unfit
from missionkit.chart.text.includes import inlined
from missionkit.chart.text.located_data import shown
from missionkit.chart.text.parameter_expansion import Expanded, expand
from missionkit.chart.text.yaml_reader import Document, read, read_file
from missionkit.errors import FileError, Problem, nearest

M = TypeVar("M", bound=BaseModel)
MAX_PROBLEMS = 50
NO_OVERRIDES: Mapping[str, str] = MappingProxyType({})


def load(path: Path, catalogue: Catalogue, overrides: Mapping[str, str] = NO_OVERRIDES) -> Mission:
    """Read a mission file.

    Args:
        path: the file, named in messages as given here.
        catalogue: what the mission may use.
        overrides: values of parameters by name, in YAML, as `--set` gives them.

    Raises:
        FileError: everything that is wrong with the file.
    """
    mission = checked(read_file(path), catalogue, overrides)
    if mission.world is not None:
        _require_world(path.parent, mission, mission.world)
    return mission


def _require_world(root: Path, mission: Mission, name: str) -> None:
    """Refuse a file that is not a world, without quoting it: it may be any file.

    Raises:
        FileError: it is not in the mission's folder, or is something else.
    """
    wrong = unfit(root, root / name)
    if wrong == NO_SUCH_FILE:
        wrong = f"{wrong}; {nearest(name, _files_near(root, name))}"
    if not wrong and (root / name).suffix not in {".yaml", ".yml"}:
        wrong = "expected a name that ends in .yaml"
    if not wrong:
        kind = document_kind(read_file(root / name).data)
        wrong = (
            "" if kind == "world" else f"this file is {f'a {kind}, ' if kind else ''}not a world"
        )
    if wrong:
        raise FileError([Problem(mission.place("world"), f"world {name!r}: {wrong}")])


def parse(
    text: str, file: str, catalogue: Catalogue, overrides: Mapping[str, str] = NO_OVERRIDES
) -> Mission:
    """Return the mission that `text` describes; `file` is what messages call it.

    Args:
        text: YAML.
        file: what messages call the file.
        catalogue: plug-ins that the mission may use.
        overrides: parameters, by name, as YAML text.

    Raises:
        FileError: everything that is wrong with the text.
    """
    return checked(read(text, file), catalogue, overrides)


def checked(document: Document, catalogue: Catalogue, overrides: Mapping[str, str]) -> Mission:
    """Return the mission of a document.

    Args:
        document: YAML with the place of each value.
        catalogue: plug-ins that the mission may use.
        overrides: parameters, by name, as YAML text.

    Raises:
        FileError: everything that is wrong with it.
    """
    _require_mapping(document, "mission")
    expanded = inlined(expand(document, overrides), document.file)
    try:
        scope = Scope.of(expanded.data, catalogue, Path(document.file).parent)
        mission = Mission.model_validate(expanded.data, context=scope)
    except ValidationError as error:
        found = problems_in(error, Mission, expanded.data, document.start, expanded.origins)
        raise _refusal(found, expanded) from error
    wrong = (
        *(*expanded.problems, *named_guards.problems_of(mission.guards)),
        *(*structure_rules.problems_of(mission), *variable_uses.problems_of(mission)),
        *tracked_targets.problems_of(mission),
    )
    if wrong:
        raise _refusal(wrong, expanded)
    complete = replace(expanded, files=(*expanded.files, *scope.files))
    return elaborate(mission, complete, Path(document.file).parent)


def elaborate(mission: Mission, expanded: Expanded, folder: Path) -> Mission:
    """Return a mission with the map that it names; the mission itself stays as it is.

    Args:
        mission: as its file says.
        expanded: the file's data, and the files that it includes.
        folder: of the file; nothing outside it is read.

    Raises:
        FileError: the map cannot be used, or the mission wants on it what cannot be.
    """
    known, files = map_loading.read(mission, folder)
    complete = mission.with_files((*expanded.files, *files), known)
    if unfit := list(map_loading.problems_of(complete)):
        raise _refusal(unfit, expanded)
    return complete


def load_model(path: Path, model: type[M]) -> M:
    """Read a file of plain values, such as a world.

    Raises:
        FileError: everything that is wrong with the file.
    """
    document = read_file(path)
    _require_mapping(document, "world" if "world" in model.model_fields else "")
    expanded = Expanded(document.data, {}, document.problems)
    try:
        found = plain(model, document.data)
    except ValidationError as error:
        problems = problems_in(error, model, document.data, document.start, {})
        raise _refusal(problems, expanded) from error
    if document.problems:
        raise _refusal(document.problems, expanded)
    return found


def _require_mapping(document: Document, wanted: str) -> None:
    """Refuse a document that is no mapping, or of another kind than the one that is `wanted`."""
    if not isinstance(document.data, dict):
        message = f"expected a mapping (key: value), got {shown(document.data)}"
        raise FileError([*document.problems, Problem(document.start, message)])
    kind = document_kind(document.data)
    if wanted and kind not in {wanted, ""}:
        hint = "; give the mission that names it" if wanted == "mission" else ""
        raise FileError([Problem(document.start, _not_a(wanted, kind) + hint)])


def _not_a(wanted: str, kind: str) -> str:
    return f"this file is {f'a {kind}, ' if kind else ''}not a {wanted}"


def _refusal(problems: Sequence[Problem], expanded: Expanded) -> FileError:
    """Join the problems in the order of the file; one place is not reported twice."""
    places = {problem.place for problem in expanded.problems}
    fresh = [problem for problem in problems if problem.place not in places]
    found = sorted(
        {*expanded.problems, *fresh},
        key=lambda problem: (*astuple(problem.place), problem.message),
    )
    if len(found) > MAX_PROBLEMS:
        rest = f"and {len(found) - MAX_PROBLEMS} more problems from here on"
        found = [*found[:MAX_PROBLEMS], Problem(found[MAX_PROBLEMS].place, rest)]
    return FileError(found)


def _files_near(root: Path, world: str) -> list[str]:
    return [str(path.relative_to(root)) for path in (root / world).parent.glob("*.yaml")]
