"""A flight on the command line: whatever happens, its record stays and a sentence is told."""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable
from pathlib import Path

from missionkit.cli.order import Order
from missionkit.cli.outcome import exit_code, report
from missionkit.errors import ExitCode, MissionkitError
from missionkit.recorder.summary import Summary


def guarded(order: Order, folder: Path, fly: Callable[[], Summary]) -> ExitCode:
    """Fly, tell how it went, and return what the command says to the shell."""
    try:
        summary = fly()
    except MissionkitError:
        raise
    except KeyboardInterrupt:
        print(f"stopped before it had landed; see {folder}", file=sys.stderr)  # noqa: T201
        return ExitCode.VEHICLE_LOST
    except Exception:  # noqa: BLE001 - the flight record stays, the person gets a sentence
        (folder / "crash.txt").write_text(traceback.format_exc(), encoding="utf-8")
        print(f"missionkit crashed; see {folder / 'crash.txt'}", file=sys.stderr)  # noqa: T201
        return ExitCode.CRASH
    report(order, summary, folder)
    return exit_code(summary)
