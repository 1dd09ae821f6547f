"""The commands and their options. What they do is imported when they are called."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from missionkit.cli.camera_commands import camera as camera_commands
from missionkit.cli.campaign_commands import campaign, report
from missionkit.cli.command_options import (
    Json,
    MissionFile,
    Plugins,
    Settings,
    System,
    told,
)
from missionkit.cli.option_errors import Commands
from missionkit.errors import ExitCode, UsageError

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


@app.command()
@told
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
        typer.Option(metavar="NAME@SECONDS", help="an event from the operator, such as go@12.5"),
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
    headless: Annotated[
        bool, typer.Option("--headless", help="no live view, only log lines")
    ] = False,
    as_json: Json = False,
) -> None:
    """Fly a mission in the simulator; Ctrl-C lands."""
    from missionkit.cli import run_command as command  # noqa: PLC0415
    from missionkit.cli.run_options import RunOptions  # noqa: PLC0415

    if mission is None and resume is None:
        raise UsageError("name the mission file to fly, or --resume RUN")
    if camera is not None and vehicle is None:
        raise UsageError("--camera is for --vehicle: the simulator draws what the camera would see")
    if system is not None and vehicle is None:
        raise UsageError("--system is for --vehicle: the simulator has one vehicle")
    if share and vehicle is None:
        raise UsageError("--share is for --vehicle: nobody else is there to be told")
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
        system=system,
        source=camera,
        share=tuple(share or ()),
        events=tuple(event or ()),
        resume=resume,
        gap=gap,
        force=force,
        anyway=anyway,
    )
    raise typer.Exit(command.run(order))


@app.command()
@told
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


@app.command()
@told
def explain(mission: MissionFile, settings: Settings = None, plugin: Plugins = None) -> None:
    """Say in plain sentences what a mission does, state by state."""
    from missionkit.cli import mission_commands  # noqa: PLC0415

    mission_commands.explain(mission, settings or (), plugin or ())


@app.command()
@told
def plugins(
    name: Annotated[str | None, typer.Argument(help="show the manual page of this one")] = None,
    plugin: Plugins = None,
    *,
    as_json: Json = False,
) -> None:
    """List guards, behaviours and other plug-ins, with parameters, units and defaults."""
    from missionkit.cli import plugin_manual  # noqa: PLC0415

    plugin_manual.plugins(name, plugin or (), as_json=as_json)


@app.command()
@told
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


@app.command()
@told
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


@app.command()
@told
def new(
    kind: Annotated[str, typer.Argument(help="guard, behavior or mission")],
    name: Annotated[str, typer.Argument(help="what it will be called")],
    to: Annotated[Path, typer.Option(help="folder to write into")] = Path(),
) -> None:
    """Write a working example to start from."""
    from missionkit.cli import mission_commands  # noqa: PLC0415

    mission_commands.new(kind, name, to)


@app.command()
@told
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


@app.command()
@told
def fence(
    address: Annotated[str, typer.Argument(metavar="ADDRESS", help="udpin://0.0.0.0:14540")],
    mission: MissionFile,
    margin: Annotated[
        float, typer.Option(min=0.0, help="m beyond the mission's own fence, which acts first")
    ] = 5.0,
    rally: Annotated[
        list[str] | None,
        typer.Option(metavar="NORTH,EAST,HEIGHT", help="a place to return to (m, from home)"),
    ] = None,
    system: System = None,
    settings: Settings = None,
    plugin: Plugins = None,
) -> None:
    """Give the mission's fence to the autopilot itself, and read it back."""
    from missionkit.cli.fence_command import FenceOptions  # noqa: PLC0415
    from missionkit.cli.fence_command import fence as command  # noqa: PLC0415

    points = tuple(rally or ())
    files = tuple(settings or ()), tuple(plugin or ())
    wanted = FenceOptions(address, mission, *files, margin, points, system)
    raise typer.Exit(command(wanted))


@app.command()
@told
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
    airframe: Annotated[
        str, typer.Option(help="sih: that of PX4's own simulation; the world's without")
    ] = "",
    parameter: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE", help="a parameter of the autopilot, from the start"),
    ] = None,
    *,
    as_json: Annotated[bool, typer.Option("--json", help="say the ports as JSON")] = False,
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
    )
    raise typer.Exit(command(wanted))


app.command()(told(campaign))
app.command()(told(report))
app.add_typer(camera_commands, name="camera")


@app.callback(invoke_without_command=True)
def missionkit(
    *, version: Annotated[bool, typer.Option("--version", help="print the version")] = False
) -> None:
    """Drone missions as YAML state charts: checked, rehearsed, flown."""
    if version:
        from missionkit.version import __version__  # noqa: PLC0415

        print(__version__)  # noqa: T201
        raise typer.Exit(ExitCode.SUCCESS)
