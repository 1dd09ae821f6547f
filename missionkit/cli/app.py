"""All commands of `missionkit`, each imported when it is called."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from missionkit.cli.command_building import built
from missionkit.cli.option_errors import WordedErrors
from missionkit.errors import ExitCode
from missionkit.import_on_demand import ImportedOnDemand
from missionkit.version import __version__

_COMMANDS = {  # in the order of `--help`
    "run": "missionkit.cli.flight_commands.run",
    "validate": "missionkit.cli.mission_file_commands.validate",
    "check": "missionkit.cli.mission_file_commands.check",
    "explain": "missionkit.cli.mission_file_commands.explain",
    "plugins": "missionkit.cli.mission_file_commands.plugins",
    "schema": "missionkit.cli.mission_file_commands.schema",
    "graph": "missionkit.cli.mission_file_commands.graph",
    "new": "missionkit.cli.mission_file_commands.new",
    "fleet": "missionkit.cli.fleet_commands.fleet",
    "preflight": "missionkit.cli.autopilot_commands.preflight",
    "fence": "missionkit.cli.autopilot_commands.fence",
    "sitl": "missionkit.cli.autopilot_commands.sitl",
    "campaign": "missionkit.cli.campaign_commands.campaign",
    "report": "missionkit.cli.campaign_commands.report",
    "replay": "missionkit.cli.replay_commands.replay",
    "page": "missionkit.cli.replay_commands.page",
    "play": "missionkit.cli.replay_commands.play",
    "what-if": "missionkit.cli.replay_commands.what_if",
    "why": "missionkit.cli.replay_commands.why",
    "runs": "missionkit.cli.replay_commands.runs",
    "export": "missionkit.cli.interchange_commands.export",
    "log": "missionkit.cli.interchange_commands.log",
    "import": "missionkit.cli.interchange_commands.import_",
    "camera": "missionkit.cli.camera_commands.camera",
    "detector": "missionkit.cli.detector_commands.detector",
}


class Commands(WordedErrors):
    """The commands of `missionkit`."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options | {"commands": ImportedOnDemand(_COMMANDS, built)})


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


@app.callback(invoke_without_command=True)
def missionkit(
    *, version: Annotated[bool, typer.Option("--version", help="print the version")] = False
) -> None:
    """Drone missions as YAML state charts: checked, rehearsed, flown."""
    if version:
        print(__version__)  # noqa: T201
        raise typer.Exit(ExitCode.SUCCESS)
