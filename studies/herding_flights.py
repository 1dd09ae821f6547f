"""The herding mission, the whole vehicle in the loop: `python -m studies.herding_flights`."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from string import Template
from typing import NamedTuple

import numpy as np

from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import builtin
from missionkit.outcome import reason
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import stage, world_of
from studies.markdown import table
from studies.parallel import in_parallel
from studies.statistics import wilson

MISSION = Path("missions/herding.yaml")
TEMPLATE = Path(__file__).with_name("herding_flights.md")
GOAL = 7  # robots home
HEADER = ("seed", "home", "lost", "remained", "bumps, touches", "nearest tower", "estimate", "end")


class Flight(NamedTuple):
    """One flight, graded by the truth."""

    seed: int
    home: int
    lost: int
    remained: int
    bumps: int
    touches: int
    crashed: bool
    clearance: float  # m, least, to an obstacle robot with its tower
    off: float  # m, the largest error of the estimate
    duration: float  # s
    took: float  # s of processor time
    reason: str


def flown(seed: int, camera: str, settings: Mapping[str, str]) -> Flight:
    """Fly the mission once.

    Args:
        seed: of everything random.
        camera: `rendered`, or `corners` for boxes as detectors would find them.
        settings: of the mission's parameters.
    """
    begun = time.process_time()
    catalogue = builtin()
    mission = load(MISSION, catalogue, dict(settings))
    lens = mission.camera.model_copy(update={"use": camera})
    mission = mission.model_copy(update={"camera": lens})
    result = rehearse(stage(mission, catalogue, world_of(mission, MISSION.parent), seed))
    grade, herd = result.grade, result.grade.herd
    assert herd is not None  # noqa: S101 - the world has robots
    return Flight(
        seed=seed,
        home=herd.home,
        lost=herd.lost,
        remained=herd.remaining,
        bumps=herd.bumps,
        touches=herd.touches,
        crashed=grade.crashed,
        clearance=float("inf") if grade.clearance is None else grade.clearance,
        off=grade.estimate_error or 0.0,
        duration=result.flown.duration,
        took=time.process_time() - begun,
        reason=reason(result),
    )


def share(hits: int, of: int) -> str:
    """Return a share with its Wilson interval."""
    low, high = wilson(hits, of)
    return f"{hits} of {of} ({100 * hits / of:.0f} % [{100 * low:.0f}, {100 * high:.0f}])"


def cells(it: Flight) -> tuple[str, ...]:
    """Return a row of the table."""
    return (
        str(it.seed),
        str(it.home),
        str(it.lost),
        str(it.remained),
        f"{it.bumps}, {it.touches}",
        f"{it.clearance:.2f} m",
        f"{100 * it.off:.0f} cm",
        f"crash at {it.duration:.0f} s" if it.crashed else f"down at {it.duration:.0f} s",
    )


def verdict(flights: Sequence[Flight]) -> str:
    """Return the results in a few lines."""
    count = len(flights)
    means = np.mean([(it.home, it.lost, it.remained, it.bumps) for it in flights], axis=0)
    home, lost, remained, bumps = means.tolist()
    speed = sum(it.duration for it in flights) / sum(it.took for it in flights)
    return "\n".join(
        (
            f"- At least seven home: {share(sum(it.home >= GOAL for it in flights), count)}.",
            f"- No tower hit, no crash: {share(sum(not it.crashed for it in flights), count)}.",
            f"- On average {home:.1f} home, {lost:.1f} lost, {remained:.1f} still driving, "
            f"after {bumps:.0f} bumps.",
            f"- Nearest to a tower in any flight: {min(it.clearance for it in flights):.2f} m; "
            f"largest error of the estimate: {100 * max(it.off for it in flights):.0f} cm.",
            f"- {speed:.1f} times real time (processor time).",
        )
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Fly the mission and write the page."""
    parser = argparse.ArgumentParser(
        prog="python -m studies.herding_flights", description=main.__doc__
    )
    parser.add_argument("--flights", type=int, default=100)
    parser.add_argument("--first", type=int, default=500, help="seed")
    parser.add_argument("--camera", choices=("rendered", "corners"), default="rendered")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    chosen = parser.parse_args(arguments)
    settings = dict(it.split("=", 1) for it in chosen.set)
    seeds = range(chosen.first, chosen.first + chosen.flights)
    flights: list[Flight] = []
    one = partial(flown, camera=chosen.camera, settings=settings)
    for it in in_parallel(one, seeds, chosen.workers):
        flights.append(it)
        sys.stdout.write(" | ".join((*cells(it), it.reason)) + "\n")
        sys.stdout.flush()
    words = " ".join(f"--{key} {getattr(chosen, key)}" for key in ("flights", "first", "camera"))
    more = "".join(f" --set {it}" for it in chosen.set)
    text = Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        command=f"python -m studies.herding_flights {words}{more}",
        verdict=verdict(flights),
        table=table(HEADER, [cells(it) for it in flights]),
    )
    chosen.out.mkdir(parents=True, exist_ok=True)
    (chosen.out / "herding_flights.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
