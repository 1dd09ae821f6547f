"""`missionkit what-if --sweep`: the values of a parameter at which flights decide differently."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import Path

from missionkit.api.replay import runs_in
from missionkit.api.sweep import Sweep, sweep
from missionkit.cli.overrides import overrides
from missionkit.cli.printing import say, say_json
from missionkit.errors import ExitCode, UsageError
from missionkit.replays.decision_sweep import AS_FLOWN


def swept(
    folders: Sequence[Path],
    text: str,
    settings: Sequence[str],
    plugins: Sequence[Path],
    *,
    as_json: bool,
) -> ExitCode:
    """Find the values of a parameter at which flights decide differently, and print them.

    Args:
        folders: runs, or folders of runs.
        text: NAME=LOW:HIGH.
        settings: NAME=VALUE of other parameters.
        plugins: files that the mission uses.
        as_json: print the parts of the range as JSON.

    Raises:
        FileError: the mission has errors.
        UsageError: the range cannot be read, or there is no journal or no such parameter.
    """
    name, low, high = _range(text)
    values = overrides(settings)
    found = [
        sweep(run, name, low, high, settings=values, plugins=plugins) for run in runs_in(folders)
    ]
    if as_json:
        plain = [
            {**it._asdict(), "journal": str(it.journal), "parts": [p._asdict() for p in it.parts]}
            for it in found
        ]
        say_json(plain)
    else:
        for it in found:
            for line in _sweep_lines(it):
                say(line)
    differs = any(part.says != AS_FLOWN for it in found for part in it.parts)
    return ExitCode.ENDED_SAFELY if differs else ExitCode.SUCCESS


def _range(text: str) -> tuple[str, float, float]:
    found = re.fullmatch(r"([^=]+)=([^:]+):([^:]+)", text)
    try:
        if found is not None:
            return found[1], float(found[2]), float(found[3])
    except ValueError:
        pass
    raise UsageError(f"--sweep {text}: expected NAME=LOW:HIGH, as in cruise=2:8")


def _sweep_lines(it: Sweep) -> Iterator[str]:
    yield f"{it.journal.parent}: {it.parameter} {it.flown:g} flown"
    for part in it.parts:
        times = ""
        if part.first is not None and part.last is not None:
            same = part.first == part.last
            times = f", at {part.first:.2f} s" + ("" if same else f" to {part.last:.2f} s")
        yield f"  {part.low:.4g} to {part.high:.4g}: {part.says}{times}"
    yield from (f"  {note}" for note in it.notes)
