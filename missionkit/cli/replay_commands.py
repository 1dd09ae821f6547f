"""The commands about recorded flights."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from missionkit.cli.command_options import Json, Plugins

RunFolder = Annotated[Path, typer.Argument(help="folder of a run, or a journal", metavar="RUN")]


def replay(
    run: RunFolder,
    since: Annotated[
        float,
        typer.Option("--from", min=0.0, help="mission time (s); the nearest memory before it"),
    ] = 0.0,
    plugin: Plugins = None,
    *,
    as_json: Json = False,
) -> None:
    """Compute every tick of a flight again, and compare what it decides, bit by bit."""
    from missionkit.cli import replay_command as command  # noqa: PLC0415

    raise typer.Exit(command.replay(run, since, tuple(plugin or ()), as_json=as_json))
