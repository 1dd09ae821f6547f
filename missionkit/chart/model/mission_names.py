"""The names that one mission file defines, for editors to complete."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path

from missionkit.chart.model.model_base import HOME, Scope
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.text.includes import inlined
from missionkit.chart.text.parameter_expansion import expand
from missionkit.chart.text.yaml_reader import read_file
from missionkit.errors import FileError, Problem


def names_in(path: Path, catalogue: Catalogue) -> Mapping[str, Collection[str]]:
    """Return the states, targets and guards that a mission file names, those of its parts too.

    Args:
        path: of a file that may still have mistakes.
        catalogue: what it may draw on.

    Raises:
        FileError: it cannot be read, or is not a mapping.
    """
    document = read_file(path)
    if not isinstance(document.data, dict):
        raise FileError([Problem(document.start, "expected a mapping (key: value)")])
    scope = Scope.of(inlined(expand(document, {}), document.file).data, catalogue)
    return {"state": scope.states, "target": scope.targets | {HOME}, "guard": scope.guards}
