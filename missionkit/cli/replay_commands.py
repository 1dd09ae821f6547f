"""The commands about recorded flights."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from missionkit.cli.command_options import (
    Bind,
    Certificate,
    CertificateKey,
    Json,
    MissionFile,
    Plugins,
    Settings,
    Tiles,
)
from missionkit.errors import UsageError

RunFolder = Annotated[Path, typer.Argument(help="folder of a run, or a journal", metavar="RUN")]


def replay(
    run: RunFolder,
    since: Annotated[
        float,
        typer.Option("--from", min=0.0, help="mission time (s); the nearest memory before it"),
    ] = 0.0,
    plugin: Plugins = None,
    *,
    as_json: Json = False,
) -> None:
    """Compute every tick of a flight again, and compare what it decides, bit by bit."""
    from missionkit.cli import replay_command as command  # noqa: PLC0415

    raise typer.Exit(command.replay(run, since, tuple(plugin or ()), as_json=as_json))


def page(
    run: RunFolder,
    bind: Bind = None,
    tls_cert: Certificate = None,
    tls_key: CertificateKey = None,
    tiles: Tiles = None,
    plugin: Plugins = None,
    *,
    as_json: Json = False,
) -> None:
    """Show a recorded flight in a browser, to be played, searched and asked."""
    from missionkit.cli import page_command as command  # noqa: PLC0415
    from missionkit.page.server.binding import binding  # noqa: PLC0415

    where = binding(bind, tls_cert, tls_key, tiles)
    raise typer.Exit(command.page(run, where, tuple(plugin or ()), as_json=as_json))


def play(
    mission: MissionFile,
    bind: Bind = None,
    tls_cert: Certificate = None,
    tls_key: CertificateKey = None,
    tiles: Tiles = None,
    settings: Settings = None,
    plugin: Plugins = None,
    *,
    as_json: Json = False,
) -> None:
    """Play with a chart in a browser: set what its guards read, and see what it does."""
    from missionkit.cli import page_command as command  # noqa: PLC0415
    from missionkit.page.server.binding import binding  # noqa: PLC0415

    where = binding(bind, tls_cert, tls_key, tiles)
    files = tuple(plugin or ())
    raise typer.Exit(command.play(mission, where, settings or (), files, as_json=as_json))


def what_if(
    runs: Annotated[
        list[Path], typer.Argument(help="folders of runs, or a folder that holds several")
    ],
    mission: Annotated[
        Path | None,
        typer.Option(metavar="MISSION.yaml", help="the other mission; the one flown if absent"),
    ] = None,
    settings: Settings = None,
    sweep: Annotated[
        str | None,
        typer.Option(metavar="NAME=LOW:HIGH", help="find the values at which decisions change"),
    ] = None,
    plugin: Plugins = None,
    *,
    fork: Annotated[
        bool, typer.Option("--fork", help="fly on in the simulator from the first difference")
    ] = False,
    as_json: Json = False,
) -> None:
    """Say what another mission, or other parameters, would have decided in recorded flights."""
    from missionkit.cli import fork_command, sweep_command, what_if_command  # noqa: PLC0415

    changed = tuple(settings or ())
    files = tuple(plugin or ())
    if sweep is not None:
        if mission is not None or fork:
            raise UsageError("--sweep asks the mission that was flown: leave --mission, --fork out")
        raise typer.Exit(sweep_command.swept(runs, sweep, changed, files, as_json=as_json))
    asked = fork_command.flown_on if fork else what_if_command.what_if
    raise typer.Exit(asked(runs, mission, changed, files, as_json=as_json))


def why(
    run: RunFolder,
    transition: Annotated[
        str, typer.Argument(metavar="FROM->TO", help="two states, as in 'gps->visual'; quote it")
    ],
    moment: Annotated[
        str | None,
        typer.Argument(metavar="[@TIME]", help="mission time (s); else the first time, or ever"),
    ] = None,
    plugin: Plugins = None,
    *,
    changes: Annotated[
        bool,
        typer.Option(help="look for the smallest change that would have let it be taken"),
    ] = True,
    as_json: Json = False,
) -> None:
    """Say why a transition was taken in a recorded flight, or why it was not."""
    from missionkit.cli import why_command as command  # noqa: PLC0415

    files = tuple(plugin or ())
    code = command.why(run, transition, moment, files, changes=changes, as_json=as_json)
    raise typer.Exit(code)


def runs(
    folder: Annotated[
        Path, typer.Argument(help="folder of runs, or a run", metavar="[FOLDER]")
    ] = Path("runs"),
    search: Annotated[
        str, typer.Option(metavar="WORDS", help="only runs in which all these words stand")
    ] = "",
    tag: Annotated[
        list[str] | None, typer.Option(metavar="TAG", help="only runs with this tag")
    ] = None,
    outcome: Annotated[
        str, typer.Option(metavar="OUTCOME", help="success, ended_safely, crash or unknown")
    ] = "",
    add_tag: Annotated[
        list[str] | None, typer.Option(metavar="TAG", help="give this tag to the runs listed")
    ] = None,
    remove_tag: Annotated[
        list[str] | None, typer.Option(metavar="TAG", help="take it from them")
    ] = None,
    compare: Annotated[
        Path | None, typer.Option(metavar="RUN", help="compare the run FOLDER with this one")
    ] = None,
    *,
    as_json: Json = False,
) -> None:
    """List recorded runs: outcome, duration, mission and tags; search, tag and compare them."""
    from missionkit.cli import runs_command as command  # noqa: PLC0415

    if compare is not None:
        raise typer.Exit(command.compare(folder, compare, as_json=as_json))
    wanted = command.Wanted(search, tuple(tag or ()), outcome)
    retag = command.Retag(tuple(add_tag or ()), tuple(remove_tag or ()))
    raise typer.Exit(command.runs(folder, wanted, retag, as_json=as_json))
