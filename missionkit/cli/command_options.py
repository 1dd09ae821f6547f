"""Options and error reporting shared by several commands."""

from __future__ import annotations

import sys
from collections.abc import Callable
from functools import wraps
from pathlib import Path
from typing import Annotated, ParamSpec, TypeVar

import typer

from missionkit.errors import ExitCode, MissionkitError, printable

P = ParamSpec("P")
R = TypeVar("R")

MissionFile = Annotated[Path, typer.Argument(help="mission file", metavar="MISSION.yaml")]
Settings = Annotated[
    list[str] | None, typer.Option("--set", metavar="NAME=VALUE", help="value of a parameter")
]
Plugins = Annotated[
    list[Path] | None,
    typer.Option("--plugin", metavar="FILE.py", help="file that defines guards or behaviours"),
]
Json = Annotated[bool, typer.Option("--json", help="answer as JSON")]
System = Annotated[
    int | None,
    typer.Option(
        min=1, max=255, metavar="N", help="MAVLink system id, where several vehicles share a link"
    ),
]
Bind = Annotated[
    str | None,
    typer.Option(
        metavar="HOST:PORT", help="serve there; 127.0.0.1:8123, or another free port, if absent"
    ),
]
Certificate = Annotated[
    Path | None, typer.Option(metavar="FILE", help="TLS certificate, if HOST is not this computer")
]
CertificateKey = Annotated[
    Path | None, typer.Option(metavar="FILE", help="key of the TLS certificate")
]

Tiles = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="map tiles below the page's map, .mbtiles or .pmtiles"),
]


def reporting_errors(command: Callable[P, R]) -> Callable[P, R]:
    """Turn expected errors into a sentence on stderr and their exit code."""

    @wraps(command)
    def run(*args: P.args, **kwargs: P.kwargs) -> R:
        try:
            return command(*args, **kwargs)
        except MissionkitError as error:
            for line in str(error).split("\n"):
                print(printable(line), file=sys.stderr)  # noqa: T201
            raise typer.Exit(error.exit_code) from error
        except BrokenPipeError:  # the reader has gone, as `head` does; typer ends quietly
            raise
        except OSError as error:
            sentence = f"{error.filename or error}: {_reason(error)}"
            print(printable(sentence), file=sys.stderr)  # noqa: T201
            raise typer.Exit(ExitCode.BAD_FILE) from error

    return run


def _reason(error: OSError) -> str:
    if isinstance(error, FileExistsError | NotADirectoryError):
        return "this is a file, where a folder is expected"
    return str(error.strerror)
