"""Errors of a flight on the command line: the record is kept and one sentence is printed."""

from __future__ import annotations

import io
import sys
import traceback
from collections.abc import Callable
from pathlib import Path

from missionkit.api.interrupts import landing_on_interrupt
from missionkit.cli.run_options import RunOptions
from missionkit.cli.run_result import exit_code, report
from missionkit.engine.flight_loop import Operator
from missionkit.errors import ExitCode, MissionkitError
from missionkit.recorder.run_summary import Summary


def guarded(order: RunOptions, folder: Path, fly: Callable[[Operator], Summary]) -> ExitCode:
    """Fly, tell how it went, and return what the command says to the shell.

    Signals that end a program land the vehicle, from the first tick until all files are written.

    Args:
        order: says whether the result is printed as JSON.
        folder: of the run, in which `crash.txt` is left if something unexpected is raised.
        fly: flies to the end and returns the summary; what its operator requests is heeded.

    Raises:
        MissionkitError: raised by `fly`; whoever parses the command line prints it.
    """
    operator = Operator()
    try:
        with landing_on_interrupt(operator):
            summary = fly(operator)
    except MissionkitError:
        raise
    except KeyboardInterrupt:
        print(f"stopped before it had landed; see {folder}", file=sys.stderr)  # noqa: T201
        return ExitCode.VEHICLE_LOST
    except Exception:  # noqa: BLE001 - the flight record stays, the person gets a sentence
        _tell_crash(folder / "crash.txt", traceback.format_exc())
        return ExitCode.CRASH
    try:
        report(order, summary, folder)
        sys.stdout.flush()
    except BrokenPipeError:  # the reader has gone, as `head` does; typer ends quietly
        raise
    except OSError:  # the terminal has gone: the summary is in the folder
        sys.stdout = io.StringIO()
    return exit_code(summary)


def _tell_crash(path: Path, trace: str) -> None:
    """Keep the trace for a bug report, on the terminal if the disk does not take it."""
    try:
        path.write_text(trace, encoding="utf-8")
    except OSError as error:
        print(f"{path}: {error.strerror}\n{trace}", file=sys.stderr)  # noqa: T201
        print("missionkit crashed", file=sys.stderr)  # noqa: T201
    else:
        print(f"missionkit crashed; see {path}", file=sys.stderr)  # noqa: T201
