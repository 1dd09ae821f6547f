"""All commands of `missionkit`, each imported when it is called."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from missionkit.cli.commands_on_demand import CommandsOnDemand
from missionkit.cli.option_errors import WordedErrors
from missionkit.errors import ExitCode
from missionkit.version import __version__

_COMMANDS = {  # in the order of `--help`
    "run": "flight_commands.run",
    "validate": "mission_file_commands.validate",
    "check": "mission_file_commands.check",
    "explain": "mission_file_commands.explain",
    "plugins": "mission_file_commands.plugins",
    "schema": "mission_file_commands.schema",
    "graph": "mission_file_commands.graph",
    "new": "mission_file_commands.new",
    "fleet": "fleet_commands.fleet",
    "preflight": "autopilot_commands.preflight",
    "fence": "autopilot_commands.fence",
    "sitl": "autopilot_commands.sitl",
    "campaign": "campaign_commands.campaign",
    "report": "campaign_commands.report",
    "replay": "replay_commands.replay",
    "page": "replay_commands.page",
    "what-if": "replay_commands.what_if",
    "export": "interchange_commands.export",
    "log": "interchange_commands.log",
    "import": "interchange_commands.import_",
    "camera": "camera_commands.camera",
    "detector": "detector_commands.detector",
}


class Commands(WordedErrors):
    """The commands of `missionkit`."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options | {"commands": CommandsOnDemand(_COMMANDS)})


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
