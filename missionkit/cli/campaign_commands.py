"""The commands about campaigns and their options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from missionkit.cli.command_options import Json, Plugins, Settings


def campaign(
    mission: Annotated[
        Path | None, typer.Argument(help="mission file", metavar="MISSION.yaml")
    ] = None,
    runs: Annotated[
        int | None, typer.Option(min=1, help="runs of each variant; 100 if absent")
    ] = None,
    seed: Annotated[
        int, typer.Option(min=0, help="of the first run; each further run adds one")
    ] = 0,
    settings: Settings = None,
    vary: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=VALUE,VALUE", help="fly variants on the same random numbers"),
    ] = None,
    fault: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME[=VALUE][@WHEN][+DURATION]", help="fault to inject"),
    ] = None,
    event: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME@WHEN", help="an event from the operator in every run"),
    ] = None,
    plugin: Plugins = None,
    workers: Annotated[
        int | None, typer.Option(min=1, help="processes; one a core if absent")
    ] = None,
    cluster: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="of a Dask scheduler, tcp://HOST:PORT")
    ] = None,
    timeout: Annotated[
        float, typer.Option(min=0.1, help="wall time after which a run is abandoned (s)")
    ] = 300.0,
    until_width: Annotated[
        float | None,
        typer.Option(min=0.001, max=1.0, help="stop when the success rate is known this precisely"),
    ] = None,
    require: Annotated[
        float | None,
        typer.Option(min=0.0, max=1.0, help="stop when success above this is shown or refuted"),
    ] = None,
    better: Annotated[
        float | None,
        typer.Option(
            max=1.0, help="success rate to distinguish from --require; default: half its failures"
        ),
    ] = None,
    out: Annotated[Path, typer.Option(help="where the campaign's folder is made")] = Path("runs"),
    resume: Annotated[
        Path | None, typer.Option(metavar="FOLDER", help="resume a campaign that was stopped")
    ] = None,
    chain: Annotated[
        Path | None,
        typer.Option(metavar="FILE.yaml", help="write the Markov chain that was flown, for guards"),
    ] = None,
    *,
    records: Annotated[
        bool, typer.Option("--records", help="keep the flight record of every run")
    ] = False,
    as_json: Json = False,
) -> None:
    """Fly a mission many times in the simulator and say what that proves."""
    from missionkit.cli import run_campaign as command  # noqa: PLC0415

    wanted = command.CampaignOptions(
        mission,
        runs,
        seed,
        tuple(settings or ()),
        tuple(vary or ()),
        tuple(fault or ()),
        tuple(event or ()),
        tuple(plugin or ()),
        workers,
        cluster,
        timeout,
        until_width,
        require,
        better,
        out,
        resume,
        chain,
        records=records,
        as_json=as_json,
    )
    raise typer.Exit(command.campaign(wanted))


def report(
    folder: Annotated[Path, typer.Argument(help="folder of a campaign", metavar="FOLDER")],
    *,
    as_json: Json = False,
) -> None:
    """Rewrite the table, the summary and the report of a campaign."""
    from missionkit.cli import run_campaign as command  # noqa: PLC0415

    raise typer.Exit(command.report(folder, as_json=as_json))
