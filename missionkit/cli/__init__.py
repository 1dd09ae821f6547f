"""The command line: the only place that wires things together."""

from __future__ import annotations

import traceback


def main() -> None:
    """Run `missionkit`."""
    from missionkit.cli.app import app  # noqa: PLC0415 - keeps `import missionkit.cli` free
    from missionkit.errors import ExitCode  # noqa: PLC0415

    try:
        app()
    except Exception:  # noqa: BLE001 - a mistake of ours: the traceback is what helps
        traceback.print_exc()
        raise SystemExit(ExitCode.CRASH) from None
