"""Rephrases libyaml's errors for authors of missions."""

from __future__ import annotations

import yaml

from missionkit.errors import Place, Problem

_NEVER_CLOSED = {
    "while parsing a flow mapping": "'{' is never closed, or a ',' is missing before PLACE",
    "while parsing a flow sequence": "'[' is never closed, or a ',' is missing before PLACE",
    "while scanning a quoted scalar": "the quote that opens here is never closed",
}
_SENTENCES = {
    "mapping values are not allowed in this context": (
        "a ':' that does not fit here: check the indentation, or quote the text"
    ),
    "could not find expected ':'": "a ':' is missing after the key, or the line belongs to no key",
    "did not find expected key": "the indentation does not match any line above",
    "did not find expected '-' indicator": "the indentation does not match the list above",
    "did not find expected <document start>": "text after the end of the document",
}


def syntax_problem(error: yaml.YAMLError, text: str, file: str) -> Problem:
    """Turn a parser's error into a problem at the place where the mistake was made.

    Args:
        error: of the parser.
        text: of the whole file, to look at the character at the mark.
        file: name to be shown.
    """
    if not isinstance(error, yaml.MarkedYAMLError):
        return Problem(Place(file, 1, 1), "not valid YAML")
    mark = error.problem_mark or error.context_mark
    if mark is None:
        return Problem(Place(file, 1, 1), f"not valid YAML: {error.problem or error.context}")
    if _character(text, mark.line, mark.column) == "\t":
        return Problem(_place(mark, file), "a tab: indent with spaces")
    opened = _NEVER_CLOSED.get(error.context or "")
    if opened and error.context_mark is not None:
        found = f"line {mark.line + 1}, column {mark.column + 1}"
        return Problem(_place(error.context_mark, file), opened.replace("PLACE", found))
    complaint = error.problem or "not valid YAML"
    return Problem(_place(mark, file), _SENTENCES.get(complaint, f"not valid YAML: {complaint}"))


def _place(mark: yaml.Mark, file: str) -> Place:
    return Place(file, mark.line + 1, mark.column + 1)


def _character(text: str, line: int, column: int) -> str:
    lines = text.split("\n")
    return lines[line][column : column + 1] if line < len(lines) else ""
