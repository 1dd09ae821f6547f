"""The commands about mission files and plug-ins, and their options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from missionkit.cli.command_options import Json, MissionFile, Plugins, Settings
from missionkit.cli.garbage_collection import collected_rarely


@collected_rarely()
def validate(
    missions: Annotated[
        list[Path], typer.Argument(help="mission files", metavar="MISSION.yaml ...")
    ],
    form: Annotated[
        str, typer.Option("--format", metavar="FORMAT", help="text, json or sarif")
    ] = "text",
    settings: Settings = None,
    plugin: Plugins = None,
    *,
    strict: Annotated[bool, typer.Option("--strict", help="refuse warnings too")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="the same as --format json")] = False,
) -> None:
    """Check mission files without flying them, and say all that is wrong."""
    from missionkit.cli import mission_commands  # noqa: PLC0415

    form = "json" if as_json else form
    raise typer.Exit(
        mission_commands.validate(missions, settings or (), plugin or (), form, strict=strict)
    )


def check(
    mission: MissionFile,
    record: Annotated[
        Path, typer.Argument(help="flight.mcap, or the folder of a run", metavar="RUN")
    ],
    settings: Settings = None,
    plugin: Plugins = None,
    *,
    as_json: Json = False,
) -> None:
    """Check the requirements of a mission on the record of a flight."""
    from missionkit.cli import check_command  # noqa: PLC0415

    raise typer.Exit(
        check_command.check(mission, record, settings or (), plugin or (), as_json=as_json)
    )


@collected_rarely()
def explain(mission: MissionFile, settings: Settings = None, plugin: Plugins = None) -> None:
    """Say in plain sentences what a mission does, state by state."""
    from missionkit.cli import mission_commands  # noqa: PLC0415

    mission_commands.explain(mission, settings or (), plugin or ())


@collected_rarely()
def plugins(
    name: Annotated[str | None, typer.Argument(help="show the manual page of this one")] = None,
    plugin: Plugins = None,
    *,
    as_json: Json = False,
) -> None:
    """List guards, behaviours and other plug-ins, with parameters, units and defaults."""
    from missionkit.cli import plugin_manual  # noqa: PLC0415

    plugin_manual.plugins(name, plugin or (), as_json=as_json)


@collected_rarely()
def schema(
    kind: Annotated[str, typer.Argument(help="mission, world or free_flyer_world")] = "mission",
    plugin: Plugins = None,
    write: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="write both schemas there")
    ] = None,
    of: Annotated[
        Path | None,
        typer.Option("--for", metavar="MISSION.yaml", help="list its states, targets and guards"),
    ] = None,
) -> None:
    """Print the JSON Schema of mission or world files, for editors."""
    from missionkit.cli import mission_commands  # noqa: PLC0415

    mission_commands.schema(kind, plugin or (), write, of)


@collected_rarely()
def graph(
    mission: MissionFile,
    out: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help=".mmd or .svg; Mermaid on stdout if absent"),
    ] = None,
    campaign: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="of a campaign, whose flights are drawn over it"),
    ] = None,
    settings: Settings = None,
    plugin: Plugins = None,
) -> None:
    """Draw the chart of a mission; what `validate` finds is marked in red."""
    from missionkit.cli import mission_commands  # noqa: PLC0415

    mission_commands.graph(mission, out, settings or (), plugin or (), campaign)


def new(
    kind: Annotated[str, typer.Argument(help="guard, behavior or mission")],
    name: Annotated[str, typer.Argument(help="what it will be called")],
    to: Annotated[Path, typer.Option(help="folder to write into")] = Path(),
) -> None:
    """Write a working example to start from."""
    from missionkit.cli import mission_commands  # noqa: PLC0415

    mission_commands.new(kind, name, to)
