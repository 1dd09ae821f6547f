"""The command that flies a mission, and its options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from missionkit.cli.command_options import (
    Bind,
    Certificate,
    CertificateKey,
    Json,
    Plugins,
    Settings,
    System,
    Tiles,
)
from missionkit.errors import UsageError


def run(
    mission: Annotated[
        Path | None, typer.Argument(help="mission file", metavar="MISSION.yaml")
    ] = None,
    seed: Annotated[
        int, typer.Option(min=0, help="seed of everything random in the simulator")
    ] = 0,
    settings: Settings = None,
    fault: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME[=VALUE][@WHEN][+DURATION]",
            help="something that goes wrong, such as gnss_lost@20+5 or marker_hidden@visual+6",
        ),
    ] = None,
    vehicle: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="MAVLink, such as udpin://0.0.0.0:14540"),
    ] = None,
    sitl: Annotated[
        str | None,
        typer.Option(
            metavar="DIALECT",
            help="px4 or ardupilot: start a simulated autopilot, fly it over MAVLink, and end it",
        ),
    ] = None,
    system: System = None,
    camera: Annotated[
        str | None,
        typer.Option(metavar="SOURCE", help="with --vehicle: device number, file, URL, rendered"),
    ] = None,
    share: Annotated[
        list[str] | None,
        typer.Option(metavar="WHAT", help="with --vehicle: tell it pose, or target=NAME"),
    ] = None,
    event: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME@WHEN", help="an event from the operator, such as go@12.5 or go@hover:3"
        ),
    ] = None,
    plugin: Plugins = None,
    speed: Annotated[
        float | None, typer.Option(min=0.01, help="times real time; as fast as possible if absent")
    ] = None,
    out: Annotated[Path, typer.Option(help="where the run's folder is made")] = Path("runs"),
    resume: Annotated[
        Path | None,
        typer.Option(metavar="RUN", help="folder of a run that was killed: go on with it"),
    ] = None,
    gap: Annotated[
        float, typer.Option(min=0.0, help="s that the simulated vehicle flew alone before --resume")
    ] = 1.0,
    folder: Annotated[
        Path | None, typer.Option("--in", hidden=True, help="folder of the run")
    ] = None,
    bind: Bind = None,
    tls_cert: Certificate = None,
    tls_key: CertificateKey = None,
    tiles: Tiles = None,
    fleet_place: Annotated[
        str | None, typer.Option(hidden=True, help="for `missionkit fleet`")
    ] = None,
    *,
    force: Annotated[
        bool, typer.Option("--force", help="resume although the mission was changed")
    ] = False,
    anyway: Annotated[
        bool,
        typer.Option(
            "--anyway", help="take off although a failsafe or the pre-flight report says no"
        ),
    ] = False,
    page: Annotated[
        bool,
        typer.Option("--page", help="show the flight in a browser, where it can be piloted"),
    ] = False,
    headless: Annotated[
        bool, typer.Option("--headless", help="no live view, only log lines")
    ] = False,
    as_json: Json = False,
) -> None:
    """Fly a mission in the simulator; Ctrl-C lands."""
    from missionkit.cli import run_command as command  # noqa: PLC0415
    from missionkit.cli.run_options import RunOptions  # noqa: PLC0415
    from missionkit.page.server.binding import binding  # noqa: PLC0415
    from missionkit.vehicle.link.traffic_link import FleetPlace  # noqa: PLC0415

    if mission is None and resume is None:
        raise UsageError("name the mission file to fly, or --resume RUN")
    if sitl is not None and (vehicle is not None or resume is not None):
        other = "--vehicle" if vehicle is not None else "--resume"
        raise UsageError(f"--sitl starts an autopilot of its own: leave out {other}")
    over_mavlink = vehicle is not None or sitl is not None
    if camera is not None and not over_mavlink:
        raise UsageError("--camera needs --vehicle: the simulator draws what the camera sees")
    if system is not None and not over_mavlink:
        raise UsageError("--system needs --vehicle: the simulator has one vehicle")
    of_page = {"--bind": bind, "--tls-cert": tls_cert, "--tls-key": tls_key, "--tiles": tiles}
    if not page and (given := [name for name, value in of_page.items() if value is not None]):
        raise UsageError(f"{given[0]} is about the page: add --page")
    if share and not over_mavlink:
        raise UsageError("--share needs --vehicle: the simulator has no autopilot to send to")
    order = RunOptions(
        mission or Path(),
        tuple(settings or ()),
        tuple(plugin or ()),
        seed,
        tuple(fault or ()),
        speed,
        out,
        headless=headless,
        as_json=as_json,
        vehicle=vehicle,
        sitl=sitl,
        system=system,
        source=camera,
        share=tuple(share or ()),
        events=tuple(event or ()),
        resume=resume,
        gap=gap,
        force=force,
        anyway=anyway,
        page=binding(bind, tls_cert, tls_key, tiles) if page else None,
        folder=folder,
        place=None if fleet_place is None else FleetPlace.read(fleet_place),
    )
    raise typer.Exit(command.run(order))
