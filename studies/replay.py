"""Whether flights decide the same when they are ticked again: `python -m studies.replay`.

Rehearsals of an errand and of the precision task are replayed in another process: from the start,
and from a memory in the middle.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from studies.recorded_flights import flown

PAGE = """# Study: do flights decide the same when they are ticked again?

Rehearsals are flown, and replayed in another process: from their start, and from the last memory
before the middle. Verdicts, transitions and commands are compared to the last bit.

    {command}

- From the start: {whole} of {all} without a difference, {ticks} ticks.
- From a memory: {middle} of {all} without a difference.
"""


class Replayed(NamedTuple):
    """What came of one flight."""

    ticks: int
    whole: bool  # the same from the start
    middle: bool  # the same from a memory


def replayed(run: Path) -> Replayed:
    """Replay a flight in another process, twice."""
    ticks, until, whole = _asked(run)
    _, _, middle = _asked(run, "--from", str(until / 2))
    return Replayed(ticks, whole, middle)


def _asked(run: Path, *options: str) -> tuple[int, float, bool]:
    """Return the number of ticks, the time of the last (s), and whether all were the same."""
    command = [sys.executable, "-m", "missionkit", "replay", str(run), "--json", *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603
    (part,) = json.loads(done.stdout)
    return part["ticks"], part["until"], part["difference"] is None


def main(arguments: Sequence[str]) -> int:
    """Fly, replay, and print the page."""
    parser = argparse.ArgumentParser(prog="studies.replay", description=__doc__)
    parser.add_argument("--flights", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    chosen = parser.parse_args(arguments)
    found: list[Replayed] = []
    with TemporaryDirectory() as folder:
        split = chosen.seed + (chosen.flights + 1) // 2
        missions = {
            "errand": range(chosen.seed, split),
            "precision_task": range(split, chosen.seed + chosen.flights),
        }
        for name, seeds in missions.items():
            for run in flown(name, seeds, Path(folder)):
                found.append(replayed(run))
                print(run.name, *found[-1], file=sys.stderr, flush=True)  # noqa: T201
    print(  # noqa: T201
        PAGE.format(
            command=f"python -m studies.replay {' '.join(arguments)}".strip(),
            whole=sum(it.whole for it in found),
            middle=sum(it.middle for it in found),
            all=len(found),
            ticks=sum(it.ticks for it in found),
        )
    )
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
