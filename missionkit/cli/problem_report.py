"""Problem reports: for people with the line and a caret, for programs as JSON."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from unicodedata import combining, east_asian_width

from missionkit.chart.text.regular_file import read_bytes
from missionkit.chart.text.yaml_reader import MAX_BYTES
from missionkit.errors import Level, Problem, printable

SCHEMA_COMMENT = "yaml-language-server"  # what editors look for
CHARACTERS_SHOWN = 100  # characters of a source line
SHOWN_BEFORE_COLUMN = 60  # of them before the column
_BREAKS = re.compile("\r\n|[\n\r\x85\u2028\u2029]")  # as YAML counts lines
_NO_COLOUR = 0
_LEVEL_COLOURS = {Level.ERROR: 31, Level.WARNING: 33}
_HELP = 36
Sources = Mapping[str, Sequence[str]]  # file -> its lines


def sources(problems: Sequence[Problem]) -> dict[str, Sequence[str]]:
    """Return the lines of every file that a problem names and that can be read as text."""
    return {name: _lines(Path(name)) for name in {problem.place.file for problem in problems}}


def _lines(path: Path) -> Sequence[str]:
    try:
        raw = read_bytes(path, MAX_BYTES)
    except (OSError, ValueError):
        return ()
    return _BREAKS.split(raw.decode("utf-8-sig", errors="replace"))


def text(problems: Sequence[Problem], lines: Sources, *, colours: bool = False) -> str:
    """Return every problem with its line, a caret and the remedy.

    The first line of each is `file:line:column: level[code]: message`, as compilers write it.

    Args:
        problems: in the order in which they are to be shown.
        lines: text of each file, by its name.
        colours: whether to write ANSI escape sequences.
    """
    paint = _painted if colours else _unpainted
    return "\n".join(line for problem in problems for line in _block(problem, lines, paint))


def _block(problem: Problem, lines: Sources, paint: Callable[[str, int], str]) -> Iterator[str]:
    code = f"[{problem.code}]" if problem.code else ""
    colour = _LEVEL_COLOURS[problem.level]
    level = paint(f"{problem.level}{code}:", colour)
    yield f"{problem.place}: {level} {printable(problem.message)}"
    source = lines.get(problem.place.file, ())
    line, column = problem.place.line, problem.place.column
    if 1 <= line <= len(source) and source[line - 1].strip():
        shown, before = _window(source[line - 1], max(column, 1) - 1)
        yield f"  {shown}"
        yield f"  {_blank(before)}{paint('^', colour)}"
    if problem.remedy:
        yield f"  {paint('help:', _HELP)} {printable(problem.remedy)}"


def _window(line: str, at: int) -> tuple[str, str]:
    """Return the part of a line that is shown, and what of it stands before the caret."""
    at = min(at, len(line))
    first = 0 if len(line) <= CHARACTERS_SHOWN else max(0, at - SHOWN_BEFORE_COLUMN)
    start, end = ("…" if first else ""), ("…" if len(line) > first + CHARACTERS_SHOWN else "")
    shown = printable(line[first : first + CHARACTERS_SHOWN])
    return f"{start}{shown}{end}", start + shown[: at - first]


def _blank(before: str) -> str:
    """Return as much space as a text takes on a terminal."""
    return "".join("\t" if c == "\t" else " " * _cells(c) for c in before)


def _cells(character: str) -> int:
    return 0 if combining(character) else 1 + (east_asian_width(character) in "WF")


def _painted(words: str, colour: int) -> str:
    return f"\x1b[1;{colour}m{words}\x1b[{_NO_COLOUR}m"


def _unpainted(words: str, _: int) -> str:
    return words


def summary(problems: Sequence[Problem]) -> str:
    """Return how much is wrong: "2 errors, 1 warning".

    >>> summary(())
    'no problems'
    """
    counts = {level: sum(each.level is level for each in problems) for level in Level}
    parts = [f"{n} {level}{'s' if n > 1 else ''}" for level, n in counts.items() if n]
    return ", ".join(parts) or "no problems"


def schema_hint(problems: Sequence[Problem], lines: Sources) -> str:
    """Return how an editor shows mistakes while a file is written; "" if that would not help.

    It helps where a word is unknown, in a mission file that names no schema.
    """
    named = (it.place.file for it in problems if re.match(r"(.*: )?unknown ", it.message))
    bare = [
        name for name in named if not any(SCHEMA_COMMENT in line for line in lines.get(name, ()))
    ]
    if not bare:
        return ""
    file = shlex.quote(bare[0])
    return (
        f"hint: `missionkit schema --for {file} > mission.schema.json` and the first line "
        f"`# {SCHEMA_COMMENT}: $schema=mission.schema.json` make editors complete "
        "what this file may say"
    )


def as_json(problems: Sequence[Problem]) -> str:
    """Return a list of problems as programs read it."""
    return json.dumps([_plain(problem) for problem in problems], indent=2)


def _plain(problem: Problem) -> dict[str, str | int]:
    place = problem.place
    return {
        "file": place.file,
        "line": place.line,
        "column": place.column,
        "level": str(problem.level),
        "code": problem.code,
        "message": problem.message,
        "remedy": problem.remedy,
    }
