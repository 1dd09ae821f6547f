"""Commands that are built when they are called, so that none waits for the others."""

from __future__ import annotations

from typing import Any

import typer

from missionkit.cli.command_options import reporting_errors


def built(name: str, found: Any) -> Any:
    """Return a command as the command-line library calls it.

    Args:
        name: that a user types.
        found: the function, or a `typer.Typer` with further commands.
    """
    if isinstance(found, typer.Typer):
        group = typer.main.get_command(found)
        group.name = name
        return group
    alone = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
    alone.command(name)(reporting_errors(found))
    return typer.main.get_command(alone)
