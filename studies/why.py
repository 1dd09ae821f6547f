"""Whether the smallest change of `missionkit why` does what it says: `python -m studies.why`.

Transitions of recorded flights are asked at random times at which they were not taken. The change
is written into the mission file, and the file is compared with the flight, as `what-if` does.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np

import missionkit
from missionkit.api.recorded_mission import origin_of, restored
from missionkit.api.transition_change import ChangedNumber
from missionkit.engine.clock import stopwatch
from missionkit.errors import FileError
from missionkit.recorder.journal_reader import read_journal, tick_of
from studies.recorded_flights import flown

LESS = 0.99
PAGE = """# Study: does the smallest change do what `missionkit why` says?

Transitions of recorded rehearsals are asked at random times at which they were not taken. The
change that `why` names is written into the text of the mission file; the file is then compared with
the flight as `missionkit what-if` does it. It counts if the first transition that differs is the
one asked for, at the tick that was named, and if it is not with 1 % less of the change.

    {command}

- {right} of {all} do ({pairs} of them are changes of two numbers).
- Asked {asked} times; in {none} no change of one number or two was found and verified, as the
  answer says.
- An answer took {middle:.1f} s of wall time in the middle, {most:.1f} s at most.
{wrong}"""


class Asked(NamedTuple):
    """One question and what came of it."""

    run: str
    transition: str
    at: float
    numbers: tuple[ChangedNumber, ...]
    taken: bool  # at the tick that was named
    less: bool  # it is taken with less of the change too
    took: float  # s, wall time

    @property
    def right(self) -> bool:
        """Whether the change does what was said."""
        return self.taken and not self.less


def questions(run: Path, rng: np.random.Generator) -> Iterator[tuple[str, float]]:
    """Yield transitions and times at which they were not taken, in random order.

    Args:
        run: folder of a flight.
        rng: draws.
    """
    journal = read_journal(run / "journal.mcap")
    with TemporaryDirectory() as folder:
        path = restored(journal.path, origin_of(journal), Path(folder))
        mission = missionkit.load(path).model
    ticks = [(at, tick_of(journal, text).decision) for at, text in journal.ticks]
    while True:
        at, decision = ticks[int(rng.integers(len(ticks)))]
        source = decision.active[-1]
        ways = [to for way in mission.states[source].transitions for to in way.targets]
        to = rng.choice([*ways, *(it.to for it in mission.failsafes)]) if ways else source
        if to != source and not decision.fired:
            yield f"{source}->{to}", at


def applied(text: str, number: ChangedNumber, value: float) -> str:
    """Return the text of a mission with another value of a number.

    Args:
        text: of the file.
        number: where it stands.
        value: new.
    """
    lines = text.splitlines(keepends=True)
    begin = sum(map(len, lines[: number.line - 1])) + number.column - 1
    head, tail = text[:begin], text[begin:]
    if number.where.endswith(": dwell"):
        return head + tail.replace("kind:", f"dwell: {value!r}\n    kind:", 1)
    line, newline, rest = tail.partition("\n")
    written = rf"\b{number.key}: [\w.+-]+"
    if re.search(written, line):
        return head + re.sub(written, f"{number.key}: {value!r}", line, count=1) + newline + rest
    return (
        head
        + re.sub(r"use: \w+", rf"\g<0>, {number.key}: {value!r}", line, count=1)
        + newline
        + rest
    )


def asked(run: Path, transition: str, at: float) -> list[Asked]:
    """Ask a transition of a flight, and try each answer in the file."""
    begun = stopwatch()
    answers = missionkit.why(run, transition, at=at)
    took = stopwatch() - begun
    found = []
    for answer in answers:
        change = answer.smallest_change
        if answer.fired:
            continue
        if change is None or not change.verified:
            found.append(Asked(run.name, transition, at, (), taken=False, less=False, took=took))
            continue
        full = [(it, it.changed) for it in change.numbers]
        taken = _taken(run, answer, full) == change.at
        less = any(_taken(run, answer, it) is not None for it in _less(full))
        found.append(Asked(run.name, transition, at, change.numbers, taken, less, took))
    return found


def _less(
    full: Sequence[tuple[ChangedNumber, float]],
) -> Iterator[list[tuple[ChangedNumber, float]]]:
    for index, (number, value) in enumerate(full):
        way = value - number.flown
        nearer = number.flown + LESS * way
        if isinstance(number.flown, int):
            nearer = int(value) - (1 if way > 0 else -1)
        yield [*full[:index], (number, nearer), *full[index + 1 :]]


def _taken(
    run: Path, answer: missionkit.Why, values: Sequence[tuple[ChangedNumber, float]]
) -> float | None:
    """Return when a mission file with other values takes the transition first of all; None: not."""
    journal = read_journal(run / "journal.mcap")
    with TemporaryDirectory() as folder:
        path = restored(journal.path, origin_of(journal), Path(folder))
        text = path.read_text(encoding="utf-8")
        for number, value in sorted(values, key=lambda it: (-it[0].line, -it[0].column)):
            text = applied(text, number, value)
        path.write_text(text, encoding="utf-8")
        try:
            first = missionkit.what_if(run, path).table.first
        except FileError:
            return None
    if first is None or first.now is None or first.now.at > answer.at:
        return None
    return first.now.at if first.now.to == answer.to else None


def main(arguments: Sequence[str]) -> int:
    """Fly, ask, and print the page."""
    parser = argparse.ArgumentParser(prog="studies.why", description=__doc__)
    parser.add_argument("--answers", type=int, default=50)
    parser.add_argument("--flights", type=int, default=5)
    parser.add_argument("--seed", type=int, default=1)
    chosen = parser.parse_args(arguments)
    rng, found = np.random.default_rng(chosen.seed), list[Asked]()
    with TemporaryDirectory() as folder:
        seeds = range(chosen.seed, chosen.seed + chosen.flights)
        runs = [
            *flown("errand", seeds, Path(folder)),
            *flown("precision_task", seeds[: max(1, chosen.flights // 4)], Path(folder)),
        ]
        streams = [questions(run, rng) for run in runs]
        turn = 0
        while sum(bool(it.numbers) for it in found) < chosen.answers:
            run, stream = runs[turn % len(runs)], streams[turn % len(runs)]
            turn += 1
            found += asked(run, *next(stream))
            print(found[-1] if found else "", file=sys.stderr, flush=True)  # noqa: T201
    print(page(found, f"python -m studies.why {' '.join(arguments)}".strip()))  # noqa: T201
    return 0


def page(found: Sequence[Asked], command: str) -> str:
    """Return what came of all questions as a page.

    Args:
        found: the questions.
        command: that made it.
    """
    answered = [it for it in found if it.numbers]
    took = [it.took for it in found]
    wrong = [f"- not: {it.run} {it.transition} @{it.at:.2f}\n" for it in answered if not it.right]
    return PAGE.format(
        command=command,
        right=sum(it.right for it in answered),
        all=len(answered),
        pairs=sum(len(it.numbers) > 1 for it in answered),
        asked=len(found),
        none=len(found) - len(answered),
        middle=float(np.median(took)),
        most=max(took),
        wrong="".join(wrong),
    )


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
