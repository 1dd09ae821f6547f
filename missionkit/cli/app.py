"""All commands of `missionkit`. What they do is imported when they are called."""

from __future__ import annotations

from typing import Annotated

import typer

from missionkit.cli.autopilot_commands import fence, preflight, sitl
from missionkit.cli.camera_commands import camera as camera_commands
from missionkit.cli.campaign_commands import campaign, report
from missionkit.cli.command_options import reporting_errors
from missionkit.cli.detector_commands import detector as detector_commands
from missionkit.cli.fleet_commands import fleet
from missionkit.cli.flight_commands import run
from missionkit.cli.interchange_commands import export, import_, log
from missionkit.cli.mission_file_commands import (
    check,
    explain,
    graph,
    new,
    plugins,
    schema,
    validate,
)
from missionkit.cli.option_errors import Commands
from missionkit.cli.replay_commands import page, replay, what_if
from missionkit.errors import ExitCode
from missionkit.version import __version__

app = typer.Typer(
    name="missionkit",
    cls=Commands,
    help="Drone missions as YAML state charts: checked, rehearsed, flown.",
    epilog=(
        "Exit codes: 0 flown and succeeded, 1 ended safely without success, 2 a file or an option "
        "is wrong, 3 the vehicle could not be reached, was lost or crashed, 4 missionkit itself "
        "crashed."
    ),
    no_args_is_help=True,
    add_completion=False,
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)

_COMMANDS = (
    *(run, validate, check, explain, plugins, schema, graph, new),
    *(fleet, preflight, fence, sitl, campaign, report, replay, page, what_if, export, log),
)
for _command in _COMMANDS:
    app.command()(reporting_errors(_command))
app.command("import")(reporting_errors(import_))
app.add_typer(camera_commands, name="camera")
app.add_typer(detector_commands, name="detector")


@app.callback(invoke_without_command=True)
def missionkit(
    *, version: Annotated[bool, typer.Option("--version", help="print the version")] = False
) -> None:
    """Drone missions as YAML state charts: checked, rehearsed, flown."""
    if version:
        print(__version__)  # noqa: T201
        raise typer.Exit(ExitCode.SUCCESS)
