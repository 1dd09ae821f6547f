"""`missionkit why`: what decided a transition of a recorded flight, or what stood before it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from missionkit.api.why import Why
from missionkit.api.why import why as asked
from missionkit.cli.printing import say, say_json
from missionkit.errors import ExitCode, UsageError


def why(
    run: Path,
    transition: str,
    moment: str | None,
    plugins: Sequence[Path],
    *,
    changes: bool,
    as_json: bool,
) -> ExitCode:
    """Explain a transition of a flight, and print it.

    Args:
        run: folder of a run, or a journal.
        transition: FROM->TO, with @t behind it or not.
        moment: @t, if it stands by itself.
        plugins: files that the flight used.
        changes: look for the smallest change that would have let it be taken.
        as_json: print it as JSON.

    Raises:
        FileError: the mission cannot be used by this version of missionkit.
        UsageError: there is no journal, it cannot be read, or nothing leads there.
    """
    states, _, behind = transition.partition("@")
    at = _time(moment.removeprefix("@") if moment else behind)
    answers = asked(run, states, at=at, changes=changes, plugins=plugins)
    if as_json:
        say_json([_plain(it) for it in answers])
    else:
        for it in answers:
            for line in it.text.splitlines():
                say(line)
    return ExitCode.SUCCESS


def _time(text: str) -> float | None:
    if not text:
        return None
    try:
        return float(text.removesuffix("s"))
    except ValueError as error:
        raise UsageError(f"@{text}: expected a mission time in seconds, as in @36.5") from error


def _plain(it: Why) -> dict[str, object]:
    change = it.smallest_change
    ahead = it.if_nothing_changes
    return {
        **it._asdict(),
        "journal": str(it.journal),
        "text": it.text,
        "conjuncts": [
            {
                **part._asdict(),
                "closest": None if part.closest is None else part.closest._asdict(),
            }
            for part in it.conjuncts
        ],
        "if_nothing_changes": None if ahead is None else ahead._asdict(),
        "smallest_change": None
        if change is None
        else {**change._asdict(), "numbers": [number._asdict() for number in change.numbers]},
    }
