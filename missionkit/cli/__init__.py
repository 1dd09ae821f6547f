"""The command line: the only place that wires things together."""

from __future__ import annotations

INTERRUPTED = 130  # the shell's exit code for a program that Ctrl-C ended


def main() -> None:
    """Run `missionkit`. All imports wait until here, where Ctrl-C leaves no traceback."""
    try:
        from missionkit.cli.app import app  # noqa: PLC0415

        app()
    except KeyboardInterrupt:
        raise SystemExit(INTERRUPTED) from None
    except Exception:  # noqa: BLE001 - a mistake of ours: the traceback is what helps
        import traceback  # noqa: PLC0415

        from missionkit.errors import ExitCode  # noqa: PLC0415

        traceback.print_exc()
        raise SystemExit(ExitCode.CRASH) from None
