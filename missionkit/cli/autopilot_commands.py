"""The commands about an autopilot, real or simulated, and their options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from missionkit.cli.command_options import Json, Plugins, Settings, System
from missionkit.errors import UsageError


def preflight(
    address: Annotated[str, typer.Argument(metavar="ADDRESS", help="udpin://0.0.0.0:14540")],
    system: System = None,
    *,
    as_json: Json = False,
    write: Annotated[
        bool, typer.Option("--set", help="write safe failsafe parameters, after asking")
    ] = False,
    yes: Annotated[bool, typer.Option("--yes", help="do not ask; for scripts")] = False,
) -> None:
    """Look at a MAVLink vehicle and say whether it is fit to fly; nothing is commanded."""
    from missionkit.cli.preflight_command import PreflightOptions  # noqa: PLC0415
    from missionkit.cli.preflight_command import preflight as command  # noqa: PLC0415

    raise typer.Exit(command(PreflightOptions(address, system, as_json, write, yes)))


def fence(
    places: Annotated[
        list[str],
        typer.Argument(
            metavar="[ADDRESS] MISSION.yaml", help="udpin://0.0.0.0:14540, and the mission file"
        ),
    ],
    margin: Annotated[
        float, typer.Option(min=0.0, help="m beyond the mission's own fence, which acts first")
    ] = 5.0,
    rally: Annotated[
        list[str] | None,
        typer.Option(metavar="NORTH,EAST,HEIGHT", help="a place to return to (m, from home)"),
    ] = None,
    export: Annotated[
        Path | None,
        typer.Option(metavar="FILE.plan", help="write a plan for QGroundControl instead, or too"),
    ] = None,
    system: System = None,
    settings: Settings = None,
    plugin: Plugins = None,
) -> None:
    """Give the mission's fence to the autopilot itself, and read it back."""
    from missionkit.cli.fence_command import FenceOptions  # noqa: PLC0415
    from missionkit.cli.fence_command import fence as command  # noqa: PLC0415

    address, mission = _address_and_mission(places, export)
    points = tuple(rally or ())
    files = tuple(settings or ()), tuple(plugin or ())
    wanted = FenceOptions(address, mission, *files, margin, points, system, export)
    raise typer.Exit(command(wanted))


def _address_and_mission(places: list[str], export: Path | None) -> tuple[str | None, Path]:
    """Return the address, None if the fence is only exported, and the mission file."""
    *addresses, mission = places
    if len(addresses) > 1 or (not addresses and export is None):
        raise UsageError(
            "usage: missionkit fence ADDRESS MISSION.yaml, or "
            "missionkit fence MISSION.yaml --export FILE.plan"
        )
    if Path(mission).suffix not in {".yaml", ".yml"}:
        usage = "missionkit fence ADDRESS MISSION.yaml"
        raise UsageError(f"{mission} is not a mission file; usage: {usage}")
    return (addresses[0] if addresses else None), Path(mission)


def sitl(
    world: Annotated[Path | None, typer.Option(help="world file; empty without")] = None,
    dialect: Annotated[str, typer.Option(help="px4 or ardupilot")] = "px4",
    link: Annotated[
        list[str] | None,
        typer.Option(metavar="LINK", help="udpout:HOST:PORT, udpin:HOST:PORT or tcpin:HOST:PORT"),
    ] = None,
    control: Annotated[int, typer.Option(min=0, max=65535, help="port; 0: any free one")] = 0,
    speed: Annotated[float, typer.Option(help="times real time, up to 10")] = 1.0,
    seed: Annotated[int, typer.Option(min=0, help="of everything random")] = 0,
    fault: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME[=VALUE][@WHEN][+DURATION]", help="something that goes wrong"),
    ] = None,
    home: Annotated[
        str, typer.Option(metavar="LAT,LON,HEIGHT", help="of the world's origin (deg, deg, m)")
    ] = "47.397742,8.545594,488",
    system: Annotated[int, typer.Option(min=1, max=255, help="MAVLink system id")] = 1,
    start: Annotated[
        str, typer.Option(metavar="NORTH,EAST", help="where it stands (m); the world's without")
    ] = "",
    airframe: Annotated[
        str, typer.Option(help="sih: that of PX4's own simulation; the world's without")
    ] = "",
    parameter: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="a parameter of the autopilot, from the start"),
    ] = None,
    *,
    as_json: Annotated[bool, typer.Option("--json", help="say the ports as JSON")] = False,
    tied: Annotated[
        bool, typer.Option("--tied", hidden=True, help="end when standard input closes")
    ] = False,
) -> None:
    """Simulate an autopilot that speaks MAVLink; Ctrl-C ends it."""
    from missionkit.cli.sitl_command import SitlOptions  # noqa: PLC0415
    from missionkit.cli.sitl_command import sitl as command  # noqa: PLC0415

    wanted = SitlOptions(
        world,
        dialect,
        tuple(link or ()),
        control,
        speed,
        seed,
        tuple(fault or ()),
        home,
        airframe,
        as_json=as_json,
        system=system,
        parameters=tuple(parameter or ()),
        tied=tied,
        start=start,
    )
    raise typer.Exit(command(wanted))
