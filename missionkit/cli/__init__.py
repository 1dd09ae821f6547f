"""The command line: the only place that wires things together."""

from __future__ import annotations


def main() -> None:
    """Run `missionkit`."""
    from missionkit.cli.app import app  # noqa: PLC0415 - keeps `import missionkit.cli` free

    app()
