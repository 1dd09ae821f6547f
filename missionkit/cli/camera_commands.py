"""`missionkit camera`: calibrates a camera, and looks whether it sees the markers."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from missionkit.cli.command_options import Plugins, Settings, reporting_errors

camera = typer.Typer(help="Calibrate a camera, and check what it sees.", no_args_is_help=True)

Columns = Annotated[int, typer.Option(help="squares across")]
Rows = Annotated[int, typer.Option(help="squares down")]
Square = Annotated[float, typer.Option(help="edge of a square (m)")]
Marker = Annotated[float, typer.Option(help="edge of a marker (m)")]
Dictionary = Annotated[str, typer.Option(metavar="NAME", help="of the markers")]
Most = Annotated[int, typer.Option(min=1, help="number of images to inspect")]


@camera.command()
@reporting_errors
def board(
    out: Annotated[Path, typer.Option(metavar="FILE.png", help="the picture")] = Path("board.png"),
    columns: Columns = 7,
    rows: Rows = 5,
    square: Square = 0.04,
    marker: Marker = 0.03,
    dictionary: Dictionary = "DICT_4X4_50",
) -> None:
    """Draw the ChArUco board that `calibrate` looks for, to be printed in its true size."""
    from missionkit.cli.camera_calibrate import Squares, draw  # noqa: PLC0415

    draw(Squares(columns, rows, square, marker, dictionary), out)


@camera.command()
@reporting_errors
def calibrate(
    sources: Annotated[
        list[str],
        typer.Argument(metavar="SOURCE ...", help="images, a video, a device number or a URL"),
    ],
    columns: Columns = 7,
    rows: Rows = 5,
    square: Square = 0.04,
    marker: Marker = 0.03,
    dictionary: Dictionary = "DICT_4X4_50",
    size: Annotated[
        str | None,
        typer.Option(metavar="WIDTHxHEIGHT", help="image size to request from a device (px)"),
    ] = None,
    images: Most = 300,
) -> None:
    """Find the lens from views of a ChArUco board; prints the mission's `camera:` section."""
    from missionkit.cli.camera_calibrate import Squares, calibration  # noqa: PLC0415

    squares = Squares(columns, rows, square, marker, dictionary)
    calibration(sources, squares, size, images)


@camera.command()
@reporting_errors
def check(
    source: Annotated[
        str | None,
        typer.Argument(metavar="[SOURCE]", help="device number, file or URL; else the mission's"),
    ] = None,
    mission: Annotated[
        Path | None,
        typer.Option(metavar="MISSION.yaml", help="whose device, lens and markers are checked"),
    ] = None,
    settings: Settings = None,
    plugin: Plugins = None,
    dictionary: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="of the markers; the mission's, or DICT_6X6_250"),
    ] = None,
    out: Annotated[Path, typer.Option(metavar="FILE.png", help="the picture")] = Path("camera.png"),
    images: Most = 30,
) -> None:
    """Detect markers, draw them into a PNG, and say what was seen, how far away and how fast."""
    from missionkit.cli.camera_check import CheckOptions  # noqa: PLC0415
    from missionkit.cli.camera_check import check as command  # noqa: PLC0415

    request = CheckOptions(source, mission, settings or (), plugin or (), dictionary, out, images)
    raise typer.Exit(command(request))
