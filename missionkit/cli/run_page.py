"""The page of `missionkit run --page`: served before the flight begins, announced, and remembered.

A flight that was killed and is resumed gets the same address and the same tokens: browsers that
were open find it again.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from missionkit.cli.run_options import RunOptions
from missionkit.errors import printable
from missionkit.page.facts.mission_facts import FlownMission
from missionkit.page.live.flight_page import FlightPage, flight_page
from missionkit.page.server.binding import Binding, PageAddress
from missionkit.page.server.sessions import Tokens
from missionkit.recorder.run_summary import Summary

PAGE_FILE = "page.json"  # beside the record, while the flight lasts


@contextmanager
def page_of(order: RunOptions, mission: FlownMission, folder: Path) -> Iterator[FlightPage | None]:
    """Serve the page of a run, if it has one, while this context is open.

    Args:
        order: the options of the command.
        mission: that is flown.
        folder: of the run.

    Raises:
        UsageError: the address cannot be served.
    """
    if order.page is None:
        yield None
        return
    kept = folder / PAGE_FILE
    where, tokens = _remembered(kept, order.page)
    with flight_page(mission, where, tokens, folder, order.plugins, order.sitl) as page:
        _remember(kept, page.address)
        _announce(page.address)
        yield page
    kept.unlink(missing_ok=True)


def ended(page: FlightPage | None, summary: Summary) -> None:
    """Tell the page how the flight ended.

    Args:
        page: None: there is none.
        summary: of the flight.
    """
    if page is not None:
        page.finish(summary.outcome, summary.reason)


def _remembered(kept: Path, where: Binding) -> tuple[Binding, Tokens]:
    """Return where to serve, and the tokens: those of the flight that is resumed, if there are."""
    with suppress(OSError, ValueError, KeyError, TypeError):
        known = json.loads(kept.read_text(encoding="utf-8"))
        tokens = Tokens(str(known["pilot"]), str(known["view"]))
        return where._replace(port=where.port or int(known["port"])), tokens
    return where, Tokens.fresh()


def _remember(kept: Path, address: PageAddress) -> None:
    tokens = address.tokens
    if tokens is None:
        return
    port = int(address.url.rstrip("/").rpartition(":")[2])
    text = json.dumps({"port": port, "pilot": tokens.pilot, "view": tokens.view})
    with suppress(OSError):  # a flight needs no page
        kept.unlink(missing_ok=True)
        number = os.open(kept, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        with os.fdopen(number, "w", encoding="utf-8") as file:
            file.write(text)


def _announce(address: PageAddress) -> None:
    lines = (f"page: {address.pilot}", f"to look only: {address.view}")
    for line in lines:
        print(printable(line), file=sys.stderr, flush=True)  # noqa: T201
