"""Problems as SARIF 2.1.0, which code hosts and editors show beside the lines of a file.

Source: OASIS, Static Analysis Results Interchange Format (SARIF) Version 2.1.0, 2020.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path, PurePosixPath
from typing import Any
from urllib.parse import quote

from missionkit.errors import Problem
from missionkit.version import __version__

SARIF_SCHEMA = (
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
)
UNREADABLE = "mission-file"  # of problems without a code: what the file may say at all


def sarif(problems: Sequence[Problem]) -> str:
    """Return a log of one run: a rule for each code, a result for each problem."""
    codes = sorted({_code(problem) for problem in problems})
    driver = {
        "name": "missionkit",
        "version": __version__,
        "rules": [_rule(code) for code in codes],
    }
    run = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "results": [_result(problem, codes) for problem in problems],
    }
    return json.dumps({"$schema": SARIF_SCHEMA, "version": "2.1.0", "runs": [run]}, indent=2)


def _code(problem: Problem) -> str:
    return problem.code or UNREADABLE


def _rule(code: str) -> dict[str, Any]:
    words = code.replace("-", " ").replace("_", " ")
    return {"id": code, "shortDescription": {"text": f"{words[:1].upper()}{words[1:]}."}}


def _result(problem: Problem, codes: Sequence[str]) -> dict[str, Any]:
    code, place = _code(problem), problem.place
    message_text = (
        f"{problem.message}\n\nRemedy: {problem.remedy}" if problem.remedy else problem.message
    )
    physical: dict[str, Any] = {"artifactLocation": {"uri": _uri(place.file)}}
    if place.line >= 1:
        physical["region"] = {"startLine": place.line, "startColumn": max(place.column, 1)}
    return {
        "ruleId": code,
        "ruleIndex": codes.index(code),
        "level": str(problem.level),
        "message": {"text": message_text},
        "locations": [{"physicalLocation": physical}],
    }


def _uri(file: str) -> str:
    """Return a file as a URI, relative as it was named if it was."""
    path = Path(file)
    return path.as_uri() if path.is_absolute() else quote(str(PurePosixPath(path)))
