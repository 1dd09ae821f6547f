"""Errors that users see, and the exit codes."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import IntEnum, StrEnum

from typing_extensions import override

NAMES_SHOWN = 40  # names listed in a message
NAMES_COMPARED = 400  # names compared: a millisecond each hundred


class ExitCode(IntEnum):
    """Exit codes of the commands."""

    SUCCESS = 0
    ENDED_SAFELY = 1
    BAD_FILE = 2
    VEHICLE_LOST = 3
    CRASH = 4


@dataclass(frozen=True, slots=True)
class Place:
    """A position in a text file; line and column count from 1."""

    file: str
    line: int
    column: int
    inside: str = field(default="", compare=False)  # the state that includes the file, if one does

    @override
    def __str__(self) -> str:
        return f"{printable(self.file)}:{self.line}:{self.column}"


NO_PLACE = Place("", 0, 0)
"""Of what missionkit adds to a mission itself."""


class Level(StrEnum):
    """Severity of a problem: an error is refused, a warning is only reported."""

    ERROR = "error"
    WARNING = "warning"


@dataclass(frozen=True, slots=True)
class Problem:
    """One problem: its place, what is wrong, and a remedy."""

    place: Place
    message: str
    level: Level = Level.ERROR
    code: str = ""  # kind of problem, such as `shadowed-transition`
    remedy: str = ""

    @override
    def __str__(self) -> str:
        return f"{self.place}: {self.message}"


class MissionkitError(Exception):
    """Base class of errors that the user sees as a sentence instead of a traceback."""

    exit_code = ExitCode.CRASH


class FileError(MissionkitError):
    """A mission, world or plug-in file that cannot be used; lists every problem found."""

    exit_code = ExitCode.BAD_FILE

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(map(str, self.problems)))


class UsageError(MissionkitError):
    """The command line names something that does not exist or does not fit."""

    exit_code = ExitCode.BAD_FILE


class VehicleError(MissionkitError):
    """The vehicle could not be reached, refused, or was lost."""

    exit_code = ExitCode.VEHICLE_LOST


class NotFitError(MissionkitError):
    """The pre-flight report says BAD: the vehicle was not armed."""

    exit_code = ExitCode.ENDED_SAFELY


def nearest(word: str, known: Iterable[str]) -> str:
    """Say the alternatives to a misspelt word, the nearest first; capitals do not matter.

    >>> nearest("Visul", ["gps", "visual"])
    "did you mean 'visual'? Known: gps, visual"
    """
    names = sorted(known)
    if not names:
        return "none are known here"
    first = word[:1].lower()
    alike = names if len(names) <= NAMES_SHOWN else [it for it in names if it[:1].lower() == first]
    spelt = {name.lower(): name for name in alike[:NAMES_COMPARED]}
    close = difflib.get_close_matches(word.lower(), spelt, n=1, cutoff=0.6)
    hint = f"did you mean '{spelt[close[0]]}'? " if close else ""
    more = f", ... ({len(names)} in all)" if len(names) > NAMES_SHOWN else ""
    return f"{hint}{'K' if hint else 'k'}nown: {', '.join(names[:NAMES_SHOWN])}{more}"


def printable(line: str) -> str:
    """Return a line that moves no cursor, paints nothing and reads in one direction.

    >>> printable(f"gone {chr(27)}[2J")
    'gone �[2J'
    """
    return "".join(c if c.isprintable() or c == "\t" else "\N{REPLACEMENT CHARACTER}" for c in line)
