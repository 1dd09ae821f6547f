"""The commands for files of other programs, and their options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from missionkit.cli.command_options import Plugins, Settings

Home = Annotated[
    str | None,
    typer.Option(metavar="LAT,LON,ALT", help="where it takes off, degrees and m above the sea"),
]
Force = Annotated[bool, typer.Option("--force", help="replace a file that exists")]


def import_(
    file: Annotated[Path, typer.Argument(help="of another program", metavar="FILE")],
    out: Annotated[
        Path | None,
        typer.Option("--out", "-o", metavar="FILE", help="to write; on stdout if absent"),
    ] = None,
    home: Home = None,
    height: Annotated[
        float | None, typer.Option(metavar="M", help="above home, where the file has no heights")
    ] = None,
    heights: Annotated[
        str | None,
        typer.Option(
            metavar="REFERENCE",
            help="what heights above the ellipsoid mean: amsl, above_home or agl",
        ),
    ] = None,
    spacing: Annotated[
        float | None, typer.Option(metavar="M", help="between lines, where the file has none")
    ] = None,
    areas: Annotated[
        str, typer.Option(metavar="WHAT", help="what areas are: survey or fence")
    ] = "survey",
    *,
    flat_ground: Annotated[
        bool, typer.Option("--flat-ground", help="take the ground as level with home")
    ] = False,
    strict: Annotated[
        bool, typer.Option("--strict", help="write nothing if an item is refused")
    ] = False,
    force: Force = False,
) -> None:
    """Turn a plan, a chart or a calibration of another program into a file of missionkit."""
    from missionkit.cli import import_command as command  # noqa: PLC0415

    options = command.ImportOptions(
        file, out, home, height, heights, spacing, areas, flat_ground, strict, force
    )
    raise typer.Exit(command.import_file(options))


def export(
    mission: Annotated[
        Path,
        typer.Argument(help="mission file, or the folder of a campaign", metavar="MISSION.yaml"),
    ],
    out: Annotated[
        Path,
        typer.Option(
            "--out",
            "-o",
            metavar="FILE",
            help=".plan, .waypoints, .kml, .kmz, .geojson, .gpx or .wpml.kmz",
        ),
    ],
    home: Home = None,
    settings: Settings = None,
    plugin: Plugins = None,
    *,
    force: Force = False,
) -> None:
    """Write a mission as a plan of another program, along the way that 'done' leads."""
    from missionkit.cli import export_command as command  # noqa: PLC0415

    raise typer.Exit(command.export(mission, out, home, settings or (), plugin or (), force=force))


def log(
    file: Annotated[Path, typer.Argument(help="ULog, .tlog, or .bin of ArduPilot", metavar="FILE")],
    mission: Annotated[
        Path | None,
        typer.Option(metavar="MISSION.yaml", help="check its requirements, from its origin"),
    ] = None,
    out: Annotated[Path, typer.Option(help="parent folder of the record's folder")] = Path("runs"),
    settings: Settings = None,
    plugin: Plugins = None,
) -> None:
    """Turn the log of an autopilot into a flight record, with its picture."""
    from missionkit.cli import log_command as command  # noqa: PLC0415

    raise typer.Exit(command.log(file, out, mission, settings or (), plugin or ()))
