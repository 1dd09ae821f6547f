"""From a file of plain values, such as a world, to a validated model; a mission is `chart.load`'s.

What missions need is not imported here, so that a simulated autopilot starts sooner.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from missionkit.chart.model.validation_problems import plain, problems_in
from missionkit.chart.text.document_kind import document_kind
from missionkit.chart.text.located_data import shown
from missionkit.chart.text.parameter_expansion import Expanded
from missionkit.chart.text.yaml_reader import Document, read_file
from missionkit.errors import FileError, Problem

M = TypeVar("M", bound=BaseModel)
MAX_PROBLEMS = 50


def load_model(path: Path, model: type[M]) -> M:
    """Read a file of plain values, such as a world.

    Raises:
        FileError: everything that is wrong with the file.
    """
    document = read_file(path)
    require_mapping(document, "world" if "world" in model.model_fields else "")
    expanded = Expanded(document.data, {}, document.problems)
    try:
        found = plain(model, document.data)
    except ValidationError as error:
        problems = problems_in(error, model, document.data, document.start, {})
        raise refusal(problems, expanded) from error
    if document.problems:
        raise refusal(document.problems, expanded)
    return found


def require_mapping(document: Document, wanted: str) -> None:
    """Refuse a document that is no mapping, or of another kind than the one that is `wanted`.

    Raises:
        FileError: it is.
    """
    if not isinstance(document.data, dict):
        message = f"expected a mapping (key: value), got {shown(document.data)}"
        raise FileError([*document.problems, Problem(document.start, message)])
    kind = document_kind(document.data)
    if wanted and kind not in {wanted, ""}:
        hint = "; give the mission that names it" if wanted == "mission" else ""
        raise FileError([Problem(document.start, _not_a(wanted, kind) + hint)])


def _not_a(wanted: str, kind: str) -> str:
    return f"this file is {f'a {kind}, ' if kind else ''}not a {wanted}"


def refusal(problems: Sequence[Problem], expanded: Expanded) -> FileError:
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
