"""Opening the page of a flight: the server's process, and what ties the flight to it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from missionkit.engine.clock import stopwatch
from missionkit.engine.flight_loop import Operator
from missionkit.page.facts.mission_facts import FlownMission, chart_picture, mission_facts
from missionkit.page.live.action_desk import ActionDesk
from missionkit.page.live.flight_publisher import FlightPublisher
from missionkit.page.live.message_link import MessageLink, pair
from missionkit.page.server.binding import Binding, PageAddress, address_of, listening
from missionkit.page.server.sessions import Tokens
from missionkit.page.tiles.tile_file import tile_file
from missionkit.recorder.record_sinks import Reports
from missionkit.version import __version__

SERVER = "missionkit.page.live.server_process"
LONGEST_END = 4.0  # s that the server's end is waited for


@dataclass
class FlightPage:
    """The page of a flight: served already, and given the flight once that begins.

    Args:
        mission: that is flown.
        link: to the server.
        address: how a browser gets in.
    """

    mission: FlownMission
    link: MessageLink
    address: PageAddress

    def finish(self, outcome: str, reason: str) -> None:
        """Say how the flight ended.

        Args:
            outcome: in a word.
            reason: in words.
        """
        ended = {"outcome": outcome, "reason": reason}
        self.link.send({"kind": "tick", "facts": {"ended": ended, "offered": []}})

    @contextmanager
    def observing(
        self, operator: Operator, reports: Reports, give_back: Callable[[], None] | None = None
    ) -> Iterator[FlightPublisher]:
        """Give the observer of the flight, while this context is open.

        Args:
            operator: carries out what pilots want.
            reports: take what fails.
            give_back: gives control back after a takeover.
        """
        desk = ActionDesk(self.mission.plan.chart, operator, stopwatch, give_back)
        publisher = FlightPublisher(self.mission, self.link, desk, reports)
        operator.present = desk.report
        try:
            yield publisher
        finally:
            operator.present = None
            publisher.close()


@contextmanager
def flight_page(
    mission: FlownMission,
    where: Binding,
    tokens: Tokens,
    run: Path,
    plugins: Sequence[Path] = (),
    dialect: str | None = None,
) -> Iterator[FlightPage]:
    """Serve the page of a flight, by a process of its own, while this context is open.

    Args:
        mission: that is flown.
        where: the page is served.
        tokens: that open a session.
        run: folder of the run, whose journal says why.
        plugins: files that the flight uses.
        dialect: of the autopilot, if there is one.

    Raises:
        UsageError: the address cannot be served, or the file of map tiles not be used.
    """
    if where.tiles is not None:
        tile_file(where.tiles)  # refused here, not in the server
    with listening(where) as bound, tempfile.TemporaryFile("w+", encoding="utf-8") as file:
        facts = {**mission_facts(mission, "live", __version__), "dialect": dialect}
        files = (where.certificate, where.key, where.tiles)
        *tls, tiles = (None if it is None else str(it.absolute()) for it in files)
        said = {
            "mission": facts,
            "chart": chart_picture(mission),
            "tokens": list(tokens),
            "run": str(run.absolute()),
            "plugins": [str(it.absolute()) for it in plugins],
            "binding": {"host": where.host, "port": where.port, "tls": tls, "tiles": tiles},
        }
        json.dump(said, file)
        file.seek(0)
        ours, theirs = pair()
        address = address_of(where, bound, tokens)
        with theirs:
            process = _started([theirs.fileno(), bound.fileno(), file.fileno()])
    link = MessageLink(ours)
    try:
        yield FlightPage(mission, link, address)
    finally:
        link.close()
        _end(process)


def _started(files: list[int]) -> subprocess.Popen[bytes]:
    package = str(Path(__file__).parents[3])
    paths = filter(None, (package, os.environ.get("PYTHONPATH")))
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}
    return subprocess.Popen(  # noqa: S603 - this program, with numbers of open files
        [sys.executable, "-m", SERVER, *map(str, files)],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env=environment,
        pass_fds=files,
        start_new_session=True,
        cwd=Path("/"),
    )


def _end(process: subprocess.Popen[bytes]) -> None:
    """Wait until the server has ended; end one that does not."""
    with suppress(subprocess.TimeoutExpired):
        process.wait(LONGEST_END)
        return
    process.kill()
    process.wait()
