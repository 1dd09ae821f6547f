"""From a file to a validated model, or to every problem found in it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType

from pydantic import ValidationError

from missionkit.chart import map_loading
from missionkit.chart.model import named_guards, structure_rules, tracked_targets, variable_uses
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.model_base import Scope
from missionkit.chart.model.validation_problems import problems_in
from missionkit.chart.model_file import refusal, require_mapping
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.text.document_kind import document_kind
from missionkit.chart.text.file_references import NO_SUCH_FILE, unfit
from missionkit.chart.text.includes import inlined
from missionkit.chart.text.parameter_expansion import Expanded, expand
from missionkit.chart.text.yaml_reader import Document, read, read_file
from missionkit.errors import FileError, Problem, nearest

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
    require_mapping(document, "mission")
    expanded = inlined(expand(document, overrides), document.file)
    try:
        scope = Scope.of(expanded.data, catalogue, Path(document.file).parent)
        mission = Mission.model_validate(expanded.data, context=scope)
    except ValidationError as error:
        found = problems_in(error, Mission, expanded.data, document.start, expanded.origins)
        raise refusal(found, expanded) from error
    wrong = (
        *(*expanded.problems, *named_guards.problems_of(mission.guards)),
        *(*structure_rules.problems_of(mission), *variable_uses.problems_of(mission)),
        *tracked_targets.problems_of(mission),
    )
    if wrong:
        raise refusal(wrong, expanded)
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
        raise refusal(unfit, expanded)
    return complete


def _files_near(root: Path, world: str) -> list[str]:
    return [str(path.relative_to(root)) for path in (root / world).parent.glob("*.yaml")]
