"""SIGKILL at random ticks of the precision task, then resume: `python -m studies.resume`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from statistics import median
from string import Template
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import NamedTuple

import numpy as np
from rich.progress import track

from missionkit.cli.resume_rehearsal import RehearsalCheckpointWriter
from missionkit.messages import Observation, Record
from missionkit.recorder.checkpoint import NEWEST
from missionkit.recorder.flight_recorder import FlightRecorder
from missionkit.recorder.record_sinks import inline
from missionkit.rehearsal.rehearse import Kept, rehearse
from studies.flight import Camera, Order, staged
from studies.kills import PERIOD, Kill, Survived, copied, survived
from studies.markdown import table
from studies.statistics import wilson

TEMPLATE = Path(__file__).with_name("resume.md")


class Whole(NamedTuple):
    """A flight without a kill."""

    ticks: int
    succeeded: bool


class Cost(NamedTuple):
    """Cost of the checkpoints of one flight."""

    took: tuple[float, ...]  # s each
    size: int  # bytes of the last one
    ticks: int


def whole(seed: int, camera: Camera) -> Whole:
    """Fly without a kill."""
    result = rehearse(staged(Order(seed, camera)))
    return Whole(result.flown.ticks, result.succeeded)


def kills(flights: Sequence[Whole], seed: int, gap: float) -> list[Kill]:
    """Return one kill a flight, at any of its ticks but those of its last second."""
    rng = np.random.default_rng(seed)
    last = round(1.0 / PERIOD)
    return [
        Kill(number, int(rng.integers(1, flight.ticks - last)), gap)
        for number, flight in enumerate(flights)
    ]


def cost(camera: Camera) -> Cost:
    """Time every checkpoint of one flight."""
    took: list[float] = []
    ready = staged(Order(0, camera))
    with TemporaryDirectory() as name, FlightRecorder(Path(name)) as recorder:
        saving = RehearsalCheckpointWriter(Path(name), ready, recorder, "", inline().checkpoints)

        def save(kept: Kept) -> None:
            before = perf_counter()
            saving(kept)
            took.append(perf_counter() - before)

        def record(each: Record, seen: Observation) -> None:
            recorder.write(each, seen.frame, ready.vehicle.truth)

        ticks = rehearse(ready, [record], save=save).flown.ticks
        size = (Path(name) / NEWEST).stat().st_size
    return Cost(tuple(took), size, ticks)


def page(runs: Sequence[Survived], flights: Sequence[Whole], spent: Cost, command: str) -> str:
    """Return the page in Markdown; `command` is what produced it."""
    ages = [run.kill.at - run.saved_at for run in runs]
    errors = [100.0 * run.error for run in runs if run.error is not None]
    parts = {
        "command": command,
        "verdict": verdict(runs, flights),
        "states": by_state(runs),
        "age": f"{median(ages):.2f}",
        "oldest": f"{max(ages):.2f}",
        "error": f"{median(errors):.1f}" if errors else "-",
        "worst": f"{max(errors):.1f}" if errors else "-",
        "save": f"{1e3 * median(spent.took):.1f}",
        "slowest": f"{1e3 * max(spent.took):.1f}",
        "saves": str(len(spent.took)),
        "ticks": str(spent.ticks),
        "size": f"{spent.size / 1000.0:.0f}",
        "misses": misses(runs),
    }
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(parts)


def verdict(runs: Sequence[Survived], flights: Sequence[Whole]) -> str:
    """Return the result in three lines."""
    n = len(runs)
    landed, good = sum(run.landed for run in runs), sum(run.outcome == "success" for run in runs)
    low, _ = wilson(good, n)
    undisturbed = sum(flight.succeeded for flight in flights)
    return "\n".join(
        [
            f"- Killed and resumed: {landed} of {n} ended on the ground, unhurt.",
            f"- Success: {good} of {n} (at least {100.0 * low:.0f} % with 97.5 % confidence); "
            f"the same seeds without a kill: {undisturbed} of {n}.",
            f"- The work itself was finished in {sum(run.finished for run in runs)} of {n}.",
        ]
    )


def by_state(runs: Sequence[Survived]) -> str:
    """Return a table of how flights were found on resuming, by the state of the checkpoint."""
    found: dict[tuple[str, str], list[Survived]] = {}
    for run in sorted(runs, key=lambda run: run.saved_at):
        said = run.resumed.partition(": ")[2]
        found.setdefault((run.state, said), []).append(run)
    rows = [
        (
            state,
            said,
            str(len(group)),
            str(sum(run.landed for run in group)),
            str(sum(run.outcome == "success" for run in group)),
        )
        for (state, said), group in found.items()
    ]
    return table(("killed in", "found", "flights", "on the ground", "succeeded"), rows)


def misses(runs: Sequence[Survived]) -> str:
    """Return every flight that did not succeed."""
    lines = [
        f"- seed {run.kill.seed}, killed at {run.kill.at:.2f} s in {run.state}: {run.reason}"
        for run in runs
        if run.outcome != "success"
    ]
    return "\n".join(lines) or "None."


def main(arguments: Sequence[str] | None = None) -> None:
    """Kill the precision task at random ticks, resume it, and write up the results."""
    parser = argparse.ArgumentParser(prog="python -m studies.resume", description=main.__doc__)
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=0, help="of the moments")
    parser.add_argument("--gap", type=float, default=1.0, help="s until the flight is resumed")
    parser.add_argument("--camera", choices=("rendered", "corners"), default="corners")
    parser.add_argument("--workers", type=int, default=1, help="flights side by side")
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    chosen = parser.parse_args(arguments)
    spent = cost(chosen.camera)
    flights = [whole(seed, chosen.camera) for seed in range(chosen.kills)]
    moments = kills(flights, chosen.seed, chosen.gap)
    with TemporaryDirectory() as name, ThreadPoolExecutor(chosen.workers) as pool:
        mission = copied(Path(name), chosen.camera)
        going = pool.map(lambda kill: survived(mission, kill), moments)
        quiet = not sys.stderr.isatty()
        runs = list(track(going, "killing", len(moments), disable=quiet))
    command = (
        f"python -m studies.resume --kills {chosen.kills} --seed {chosen.seed} "
        f"--gap {chosen.gap:g} --camera {chosen.camera}"
    )
    chosen.out.mkdir(parents=True, exist_ok=True)
    (chosen.out / "resume.md").write_text(page(runs, flights, spent, command), encoding="utf-8")
    print(verdict(runs, flights))  # noqa: T201


if __name__ == "__main__":
    main()
