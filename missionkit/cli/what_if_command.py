"""`missionkit what-if`: the decisions of recorded flights, by another mission."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from missionkit.api.replay import runs_in
from missionkit.api.what_if import Question, WhatIf, what_if_each, without_copies
from missionkit.cli.overrides import overrides
from missionkit.cli.printing import say, say_json
from missionkit.errors import ExitCode, MissionkitError, UsageError, printable
from missionkit.replays.decision_table import ComparedTransition, Taken

PROCESSES = 2  # that share the flights


def what_if(
    folders: Sequence[Path],
    mission: Path | None,
    settings: Sequence[str],
    plugins: Sequence[Path],
    *,
    as_json: bool,
) -> ExitCode:
    """Compare the decisions of flights with those of another mission, and print the tables.

    Args:
        folders: runs, or folders of runs.
        mission: file of the other mission; None: the one that was flown.
        settings: NAME=VALUE.
        plugins: files that the mission uses.
        as_json: print the tables as JSON.

    Raises:
        FileError: the mission has errors.
        UsageError: nothing was changed, or there is no journal.
    """
    require_change(mission, settings)
    question = Question(mission, overrides(settings), tuple(plugins))
    runs, copies = without_copies(runs_in(folders))
    answers = what_if_each(runs, question, processes=min(PROCESSES, os.cpu_count() or 1))
    found = [it for it in answers if isinstance(it, WhatIf)]
    wrong = [it for it in answers if isinstance(it, MissionkitError)]
    if wrong and not found:
        raise wrong[0]
    _show(found, as_json=as_json)
    for sentence in (*copies, *(line for it in wrong for line in str(it).splitlines())):
        print(printable(sentence), file=sys.stderr)  # noqa: T201
    differs = any(it.table.differs_at is not None for it in found)
    ended = ExitCode.ENDED_SAFELY if differs else ExitCode.SUCCESS
    return ExitCode.BAD_FILE if wrong else ended


def require_change(mission: Path | None, settings: Sequence[str]) -> None:
    """Refuse a comparison in which nothing is different.

    Raises:
        UsageError: neither a mission nor a parameter is given.
    """
    if mission is None and not settings:
        raise UsageError("say what is to be different: --mission FILE or --set NAME=VALUE")


def _show(found: Sequence[WhatIf], *, as_json: bool) -> None:
    if as_json:
        say_json([plain_table(it) for it in found])
    else:
        for it in found:
            for line in _lines(it):
                say(line)
        say(_count(found))


def _count(found: Sequence[WhatIf]) -> str:
    other = [(it, at) for it in found if (at := it.table.differs_at) is not None]
    flights = f"{len(found)} flight" + ("s" if len(found) != 1 else "")
    if not other:
        return f"{flights} would have gone the same way"
    first, at = other[0]
    place = f"first in {first.journal.parent} at {at:.2f} s"
    return f"{len(other)} of {flights} would have gone another way, {place}"


def _lines(it: WhatIf) -> Iterator[str]:
    yield f"{it.journal.parent}:"
    marked = False
    for row in it.table.rows:
        if not row.evidence and not marked:
            marked = True
            yield f"  from {it.table.parted:.2f} s the vehicle would have flown differently:"
        yield f"  {row_text(row)}" if row.evidence else f"  ? {row_text(row)}"
    if it.table.parted is not None and not marked:
        yield f"  from {it.table.parted:.2f} s the vehicle would have flown differently"
    yield from (f"  {note}" for note in it.notes)


def row_text(row: ComparedTransition) -> str:
    """Return one transition in flight and now, for people."""
    taken = row.now or row.flown
    assert taken is not None  # noqa: S101 - a row has one of them
    times = f"{_at(row.flown)} flown, {_at(row.now)} now"
    return f"{row.change:<8} {taken.source} -> {taken.to}: {times} ({taken.reason})"


def _at(taken: Taken | None) -> str:
    return "not" if taken is None else f"{taken.at:.2f} s"


def plain_table(it: WhatIf) -> dict[str, object]:
    """Return an answer as JSON has it."""
    return {
        "journal": str(it.journal),
        "parted": it.table.parted,
        "until": it.table.until,
        "transitions": [
            {
                "change": row.change,
                "evidence": row.evidence,
                "flown": None if row.flown is None else row.flown._asdict(),
                "now": None if row.now is None else row.now._asdict(),
            }
            for row in it.table.rows
        ],
        "notes": list(it.notes),
    }
