"""`missionkit page` and `missionkit play`: serve the page of a recorded flight, or of a chart."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from contextlib import closing
from pathlib import Path

from missionkit.api.missions import load
from missionkit.cli.overrides import overrides
from missionkit.engine.prepared_mission import prepare
from missionkit.errors import ExitCode, printable
from missionkit.page.facts.mission_facts import FlownMission
from missionkit.page.recording.recorded_run import recorded_run
from missionkit.page.recording.recording_source import RecordingSource
from missionkit.page.server.binding import Binding, PageAddress, is_loopback
from missionkit.page.server.serving import serve
from missionkit.page.server.sessions import Tokens
from missionkit.recorder.scenery import scenery_of
from missionkit.rehearsal.stage import world_of


def page(run: Path, where: Binding, plugins: Sequence[Path], *, as_json: bool) -> ExitCode:
    """Serve the page of a recorded flight until it is interrupted.

    Args:
        run: folder of a run, or a journal.
        where: the page is served.
        plugins: files that the flight used.
        as_json: print the address as JSON.

    Raises:
        FileError: the mission cannot be used by this version of missionkit.
        UsageError: there is no journal, or the address cannot be served.
    """
    found = recorded_run(run, plugins)
    tokens = None if is_loopback(where.host) else Tokens.fresh()
    with closing(found.images):
        source = RecordingSource(found, plugins)
        serve(source, where, tokens, lambda address: announce(address, as_json=as_json))
    return ExitCode.SUCCESS


def play(
    path: Path,
    where: Binding,
    settings: Iterable[str],
    plugins: Sequence[Path],
    *,
    as_json: bool,
) -> ExitCode:
    """Serve the page of a chart that is played with, until it is interrupted.

    Args:
        path: of the mission.
        where: the page is served.
        settings: values of parameters.
        plugins: files.
        as_json: print the address as JSON.

    Raises:
        FileError: the mission, its world or a plug-in file cannot be used.
        UsageError: the address cannot be served.
    """
    from missionkit.page.play.play_source import PlaySource  # noqa: PLC0415

    mission = load(path, settings=overrides(settings), plugins=plugins)
    scenery = scenery_of(world_of(mission.model, path.parent), mission.model)
    plan = prepare(mission.model, mission.catalogue)
    source = PlaySource(FlownMission(mission.model, mission.catalogue, plan, scenery))
    tokens = None if is_loopback(where.host) else Tokens.fresh()
    serve(source, where, tokens, lambda address: announce(address, as_json=as_json))
    return ExitCode.SUCCESS


def announce(address: PageAddress, *, as_json: bool) -> None:
    """Print how to get in.

    Args:
        address: of the page.
        as_json: for programs.
    """
    if as_json:
        said = {"url": address.url, "pilot": address.pilot, "view": address.view}
        print(json.dumps(said), flush=True)  # noqa: T201
        return
    print(printable(f"page: {address.pilot}"), flush=True)  # noqa: T201
    if address.tokens is not None:
        print(printable(f"to look only: {address.view}"), flush=True)  # noqa: T201
