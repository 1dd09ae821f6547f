"""The command that flies several missions at once, and its options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from missionkit.cli.command_options import Json, Plugins
from missionkit.errors import UsageError


def fleet(
    missions: Annotated[
        list[str], typer.Argument(help="one for each vehicle", metavar="[NAME=]MISSION.yaml...")
    ],
    seed: Annotated[
        int, typer.Option(min=0, help="seed of everything random in the simulator")
    ] = 0,
    settings: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="[VEHICLE:]NAME=VALUE", help="value of a parameter"),
    ] = None,
    fault: Annotated[
        list[str] | None,
        typer.Option(
            metavar="VEHICLE:NAME[=VALUE][@WHEN][+DURATION]",
            help="something that goes wrong with one vehicle, such as west:traffic_lost@20",
        ),
    ] = None,
    separation: Annotated[
        float,
        typer.Option(min=0.0, help="m; two vehicles in the air that come nearer are in conflict"),
    ] = 2.0,
    runs: Annotated[
        int | None, typer.Option(min=1, help="fly so many seeds and count the conflicts")
    ] = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="with --runs: processes; one a core if absent")
    ] = None,
    sitl: Annotated[
        str | None,
        typer.Option(
            metavar="DIALECT", help="px4 or ardupilot: a simulated autopilot for each, over MAVLink"
        ),
    ] = None,
    vehicle: Annotated[
        list[str] | None,
        typer.Option(metavar="ADDRESS", help="MAVLink, one for each mission, in their order"),
    ] = None,
    system: Annotated[
        list[int] | None,
        typer.Option(min=1, max=255, metavar="N", help="MAVLink system id, one for each mission"),
    ] = None,
    plugin: Plugins = None,
    speed: Annotated[
        float | None, typer.Option(min=0.01, help="times real time; as fast as possible if absent")
    ] = None,
    out: Annotated[Path, typer.Option(help="where the run's folder is made")] = Path("runs"),
    *,
    anyway: Annotated[
        bool,
        typer.Option(
            "--anyway", help="take off although a failsafe or the pre-flight report says no"
        ),
    ] = False,
    as_json: Json = False,
) -> None:
    """Fly several missions at once, a vehicle each; Ctrl-C lands all."""
    from missionkit.cli import run_fleet as command  # noqa: PLC0415
    from missionkit.cli.fleet_members import FleetOptions  # noqa: PLC0415

    if sitl is not None and vehicle:
        raise UsageError("--sitl starts autopilots of its own: leave out --vehicle")
    if workers is not None and runs is None:
        raise UsageError("--workers needs --runs")
    for option, values in (("--vehicle", vehicle), ("--system", system)):
        if values and len(values) != len(missions):
            raise UsageError(
                f"{option} is given {len(values)} times, for {len(missions)} missions: "
                "give one for each, in their order"
            )
    if system and not vehicle:
        raise UsageError("--system needs --vehicle: simulated vehicles have ids 1, 2, 3, …")
    order = FleetOptions(
        tuple(missions),
        tuple(settings or ()),
        tuple(fault or ()),
        tuple(plugin or ()),
        seed,
        speed,
        separation,
        out,
        sitl,
        tuple(vehicle or ()),
        tuple(system or ()),
        runs,
        workers,
        anyway=anyway,
        as_json=as_json,
    )
    raise typer.Exit(command.fleet(order))
