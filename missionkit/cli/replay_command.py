"""`missionkit replay`: say whether a flight decides the same when it is ticked again."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from missionkit.api.replay import Replay
from missionkit.api.replay import replay as replayed
from missionkit.cli.printing import say, say_json
from missionkit.engine.clock import stopwatch
from missionkit.errors import ExitCode


def replay(run: Path, since: float, plugins: Sequence[Path], *, as_json: bool) -> ExitCode:
    """Replay a run, and print what came of each of its journals.

    Args:
        run: folder of a run, or a journal.
        since: s, mission time.
        plugins: files that the flight used.
        as_json: print it as JSON.

    Raises:
        FileError: the mission cannot be used by this version of missionkit.
        UsageError: there is no journal, it cannot be read, or a plug-in file is not named.
    """
    begun = stopwatch()
    parts = replayed(run, since=since, plugins=plugins)
    took = stopwatch() - begun
    if as_json:
        say_json([_plain(part) for part in parts])
    else:
        for part in parts:
            for line in _lines(part):
                say(line)
        flown = sum(part.until - part.since for part in parts)
        say(f"{flown:.1f} s of flight in {took:.1f} s")
    return ExitCode.ENDED_SAFELY if any(it.difference for it in parts) else ExitCode.SUCCESS


def _lines(part: Replay) -> list[str]:
    head = f"{part.journal}: {part.ticks} ticks from {part.since:.2f} s to {part.until:.2f} s"
    if part.difference is None:
        return [f"{head}: no difference", *part.notes]
    first = f"  at {part.difference.at:.2f} s, tick {part.difference.tick}"
    return [f"{head}: first difference", f"{first}: {part.difference.field}", *part.notes]


def _plain(part: Replay) -> dict[str, object]:
    difference = part.difference
    return {
        **part._asdict(),
        "journal": str(part.journal),
        "difference": None if difference is None else difference._asdict(),
    }
