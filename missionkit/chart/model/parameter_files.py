"""Parameters of plug-ins that a mission keeps in files of their own."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from missionkit.chart.model.model_base import Scope
from missionkit.chart.model.validation_problems import plain, problems_in
from missionkit.chart.text.file_references import unfit
from missionkit.chart.text.located_data import LocatedTable, place_of, shown
from missionkit.chart.text.mistake import sentence, sentences
from missionkit.chart.text.yaml_reader import read_file
from missionkit.errors import FileError, Problem
from missionkit.plugin import InFile, Plugin


def with_files(plugin: type[Plugin], data: Mapping[str, Any], scope: Scope) -> dict[str, Any]:
    """Return parameters with the content of each file that they name in place of its name.

    Args:
        plugin: what the parameters are of; its fields say which of them are files.
        data: the parameters as the mission gives them.
        scope: where files are looked for, and which were read.

    Raises:
        ValidationError: a file cannot be read, in sentences.
        FileError: what is in a file is wrong; names its places in the file.
    """
    given = dict(data)
    for name, field in plugin.model_fields.items():
        marks = [mark for mark in field.metadata if isinstance(mark, InFile)]
        if marks and name in given:
            given[name] = _content(given[name], name, marks[0].model, scope)
    return given


def _content(written: object, key: str, model: type[BaseModel], scope: Scope) -> object:
    if not isinstance(written, str):
        raise sentences(sentence(f"{key}: expected the name of a file, got {shown(written)}", key))
    root = scope.folder
    beside = place_of(written).file
    path = (Path(beside).parent if beside else root) / written
    wrong = unfit(root, path)
    if not wrong and path.suffix not in {".yaml", ".yml"}:
        wrong = "expected a name that ends in .yaml"
    if wrong:
        raise sentences(sentence(f"{key} {shown(written)}: {wrong}", key))
    document = read_file(path)
    if document.problems or not isinstance(document.data, LocatedTable):
        what = f"expected a mapping, got {shown(document.data)}"
        raise FileError(document.problems or [Problem(document.start, what)])
    try:
        plain(model, document.data)
    except ValidationError as error:
        found = problems_in(error, model, document.data, document.start, {})
        raise FileError(found) from error
    if path not in scope.files:
        scope.files.append(path)
    return document.data
