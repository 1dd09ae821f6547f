"""Speed, wind, gusts and random troubles: `python -m studies.envelope`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from rich.progress import track

from studies.envelope_flight import Run, Trouble, fly
from studies.envelope_orders import groups
from studies.envelope_page import page
from studies.parallel import in_parallel


def flown(orders: Sequence[Trouble], known: dict[Trouble, Run], workers: int) -> Iterator[Run]:
    """Fly each order that is not known yet, in order, `workers` at a time."""
    new = [order for order in orders if order not in known]
    return in_parallel(fly, new, workers)


def gathered(orders: Sequence[Trouble], kept: Path | None, workers: int) -> dict[Trouble, Run]:
    """Fly everything; what `kept` holds is not flown again, and what is flown is added to it."""
    lines = [] if kept is None or not kept.exists() else kept.read_text().splitlines()
    runs = {run.order: run for run in map(Run.read, lines)}
    new = flown(orders, runs, workers)
    for run in track(new, "flying", len(orders) - len(runs), disable=not sys.stderr.isatty()):
        runs[run.order] = run
        if kept is not None:
            with kept.open("a", encoding="utf-8") as file:
                file.write(run.written() + "\n")
    return runs


def main(arguments: Sequence[str] | None = None) -> None:
    """Fly the precision task at the edges of its envelope and write up the results."""
    parser = argparse.ArgumentParser(prog="python -m studies.envelope", description=main.__doc__)
    parser.add_argument("--seeds", type=int, default=30, help="flights of each group")
    parser.add_argument("--random", type=int, default=500, help="flights of the random search")
    parser.add_argument("--first", type=int, default=1000, help="first seed")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--kept", type=Path, help="file of flights, to go on after a break")
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    chosen = parser.parse_args(arguments)
    wanted = groups(chosen.seeds, chosen.random, chosen.first)
    orders = [order for group in wanted.values() for order in group]
    runs = gathered(orders, chosen.kept, chosen.workers)
    command = (
        f"python -m studies.envelope --seeds {chosen.seeds} --random {chosen.random} "
        f"--first {chosen.first}"
    )
    found = {name: [runs[order] for order in group] for name, group in wanted.items()}
    chosen.out.mkdir(parents=True, exist_ok=True)
    (chosen.out / "envelope.md").write_text(page(found, command), encoding="utf-8")


if __name__ == "__main__":
    main()
