"""`missionkit what-if --fork`: rehearsals, flown on in the simulator by another mission."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path

from missionkit.api.fork import Fork, fork
from missionkit.api.replay import runs_in
from missionkit.api.what_if import WhatIf
from missionkit.cli.overrides import overrides
from missionkit.cli.printing import say, say_json
from missionkit.cli.what_if_command import plain_table, require_change, row_text
from missionkit.errors import ExitCode


def flown_on(
    folders: Sequence[Path],
    mission: Path | None,
    settings: Sequence[str],
    plugins: Sequence[Path],
    *,
    as_json: bool,
) -> ExitCode:
    """Fly rehearsals on in the simulator by another mission, and print the tables.

    Args:
        folders: runs, or folders of runs.
        mission: file of the other mission; None: the one that was flown.
        settings: NAME=VALUE.
        plugins: files that the mission uses.
        as_json: print the tables as JSON.

    Raises:
        FileError: the mission has errors.
        UsageError: nothing was changed, there is no journal, or it is of a real flight.
    """
    require_change(mission, settings)
    values = overrides(settings)
    found = [fork(run, mission, settings=values, plugins=plugins) for run in runs_in(folders)]
    if as_json:
        say_json([_plain_fork(it) for it in found])
    else:
        for it in found:
            for line in _fork_lines(it):
                say(line)
    differs = any(it.table.differs_at is not None for it in found)
    return ExitCode.ENDED_SAFELY if differs else ExitCode.SUCCESS


def _fork_lines(it: Fork) -> Iterator[str]:
    parted = it.table.parted
    yield f"{it.journal.parent}:"
    for row in it.table.rows:
        yield f"  {row_text(row)}"
    if parted is None:
        yield "  the vehicle would have flown the same"
    else:
        how = "exactly as rehearsed until then" if it.exact else "approximately"
        yield f"  from {parted:.2f} s in the simulator, {how}; it ends: {it.outcome}"
    yield from (f"  {note}" for note in it.notes)


def _plain_fork(it: Fork) -> dict[str, object]:
    table = plain_table(WhatIf(it.journal, it.table, it.notes))
    return {**table, "outcome": it.outcome, "exact": it.exact}
