"""Whether `what-if` finds edits planted into a mission: `python -m studies.planted_edits`.

Each edit changes one thing in the mission of a recorded rehearsal: a threshold, a `for`, a timer,
the order of transitions, or it leaves a failsafe out. When that must first show is worked out from
the guards' values in the journal, without the edited mission, and compared with what `what-if`
says.
"""

from __future__ import annotations

import argparse
import itertools
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np

import missionkit
from missionkit.recorder.flight_journal import Decision
from missionkit.recorder.journal_reader import read_journal, tick_of
from studies.markdown import table
from studies.recorded_flights import ERRAND

EPSILON = 1e-9  # s
DWELL, HOLD, TIMER, RADIUS = 2.0, 0.5, 4.0, 1.0  # of the mission
PAGE = """# Study: does `what-if` find edits at the right tick?

Edits are planted into the missions of recorded rehearsals. When each must first show is worked out
from the journal: the first tick at which the other threshold is crossed, the guard has held for the
other time, the other timer has run, the transition that now stands first is ready, or the failsafe
that is gone was taken. `what-if` must name that tick.

    {command}

{rows}
"""
WAYS = "      - {to: back, after: 4}\n      - {to: land, when: {not: close}, for: 2.0}\n"
FIRST = "      - {to: land, when: {use: within, of: pole, radius: 9.0}, after: 4}\n"
SECOND = "      - {to: back, when: {use: battery_below, floor: 0.999}, after: 4}\n"
PATROL = ERRAND.replace(WAYS, FIRST + SECOND)
FAILSAFE = "  - {name: battery, when: {use: battery_below, floor: 0.20}, to: back}\n"
LOW = FAILSAFE.replace("0.20", "0.994")

Ticks = Sequence[tuple[float, Decision]]


class Edit(NamedTuple):
    """One edit, and when it must first show."""

    kind: str
    old: str
    new: str
    expected: float  # s, mission time


def first_held(ticks: Ticks, state: str, holds: Callable[[Decision], bool], hold: float) -> float:
    """Return the first time (s) at which something has held long enough in a state; inf: never.

    Args:
        ticks: of the flight.
        state: whose transition waits for it.
        holds: says whether it does at a tick.
        hold: s.
    """
    entered, since = entry(ticks, state), float("inf")
    for before, (now, decision) in itertools.pairwise(ticks):
        if state not in before[1].active:
            continue
        since = min(since, now) if holds(decision) else float("inf")
        if now - since >= hold - EPSILON and now - entered >= DWELL:
            return now
    return float("inf")


def entry(ticks: Ticks, state: str) -> float:
    """Return when a state was first entered (s)."""
    return next(now for now, decision in ticks if any(it.to == state for it in decision.fired))


def near(radius: float) -> Callable[[Decision], bool]:
    """Return what says whether the goal is nearer than a radius (m), and the pole is near."""

    def holds(decision: Decision) -> bool:
        answers = dict(decision.verdicts)
        value, pole = answers["close"].value, answers["within (of pole, radius 3.6)"]
        return value is not None and value <= radius and pole.holds is True

    return holds


def edits(ticks: Ticks, rng: np.random.Generator) -> list[Edit]:
    """Return one edit of each kind but the last, with when it must first show.

    Args:
        ticks: of a flight of the patrol.
        rng: draws the numbers.
    """
    looked, left = entry(ticks, "look"), entry(ticks, "land")
    radius = round(float(rng.uniform(0.3, 2.5)), 3)
    hold = round(float(rng.choice([rng.uniform(0.0, 0.45), rng.uniform(0.55, 2.0)])), 3)
    timer = round(float(rng.choice([rng.uniform(2.1, 3.9), rng.uniform(4.1, 9.0)])), 3)
    crossed = first_held(ticks, "out", near(radius), HOLD)
    held = first_held(ticks, "out", near(RADIUS), hold)
    due = next((now for now, _ in ticks if now - looked >= timer), float("inf"))
    return [
        Edit("threshold", f"radius: {RADIUS}}}", f"radius: {radius}}}", min(crossed, looked)),
        Edit("for", f"for: {HOLD}}}", f"for: {hold}}}", min(held, looked)),
        Edit(
            "timer", "radius: 9.0}, after: 4}", f"radius: 9.0}}, after: {timer}}}", min(due, left)
        ),
        Edit("order", FIRST + SECOND, SECOND + FIRST, left),
    ]


def removal(ticks: Ticks) -> Edit:
    """Return the edit that leaves the failsafe out, which shows where it was taken."""
    taken = [now for now, it in ticks if any(way.reason == "failsafe battery" for way in it.fired)]
    return Edit("failsafe removed", LOW, "", taken[0])


def decisions(run: Path) -> Ticks:
    """Return what each tick of a flight decided."""
    journal = read_journal(run / "journal.mcap")
    return [(now, tick_of(journal, text).decision) for now, text in journal.ticks]


def tried(
    text: str, seed: int, folder: Path, planted: Callable[[Ticks], list[Edit]]
) -> list[tuple[Edit, float | None]]:
    """Fly a mission, plant edits, and return each with the time (s) that `what-if` names.

    Args:
        text: of the mission.
        seed: of the flight.
        folder: empty.
        planted: gives the edits.
    """
    path = folder / "mission.yaml"
    path.write_text(text, encoding="utf-8")
    missionkit.rehearse(missionkit.load(path), seed=seed, folder=folder / "run")
    found = []
    for edit in planted(decisions(folder / "run")):
        if text.count(edit.old) != 1:
            raise ValueError(edit.old)
        path.write_text(text.replace(edit.old, edit.new), encoding="utf-8")
        said = missionkit.what_if(folder / "run", path).table.differs_at
        found.append((edit, said))
        print(edit.kind, edit.expected, said, file=sys.stderr, flush=True)  # noqa: T201
    return found


def main(arguments: Sequence[str]) -> int:
    """Fly, plant, compare, and print the page."""
    parser = argparse.ArgumentParser(prog="studies.planted_edits", description=__doc__)
    parser.add_argument("--flights", type=int, default=8)
    parser.add_argument("--seed", type=int, default=1)
    chosen = parser.parse_args(arguments)
    rng, found = np.random.default_rng(chosen.seed), list[tuple[Edit, float | None]]()
    for seed in range(chosen.seed, chosen.seed + chosen.flights):
        with TemporaryDirectory() as folder:
            found += tried(PATROL, seed, Path(folder), lambda ticks: edits(ticks, rng))
        with TemporaryDirectory() as folder:
            text = ERRAND.replace(FAILSAFE, LOW)
            found += tried(text, seed, Path(folder), lambda ticks: [removal(ticks)])
    rows = []
    for kind in dict.fromkeys(edit.kind for edit, _ in found):
        right = [said == edit.expected for edit, said in found if edit.kind == kind]
        rows.append((kind, f"{sum(right)} of {len(right)}"))
    command = f"python -m studies.planted_edits {' '.join(arguments)}".strip()
    print(PAGE.format(command=command, rows=table(("edit", "right tick"), rows)))  # noqa: T201
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
