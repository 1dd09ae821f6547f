"""What every fault comes to, declared and seen, by ground truth: `python -m studies.faults`.

Each fault of the matrix is brought about with many seeds. What counts is what the simulator or the
simulated autopilot knows to be true; what the program says is compared with it.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from string import Template

from rich.progress import track

from missionkit.errors import nearest
from studies.fault_flights import AT_HOME, Seen
from studies.fault_rows import FLIGHTS, PROCESSES, ROWS, Row, once
from studies.markdown import table

PAGE = Path(__file__).with_suffix(".md")
WAITING = 6  # processes for what mostly waits, against two for what computes


def good(row: Row, seen: Seen) -> bool:
    """Return whether a seed came to what was declared, and was called by its name."""
    return seen.outcome in row.declared and not seen.lied


def seen_of(orders: Sequence[tuple[str, int]], workers: int) -> Iterator[Seen]:
    """Bring faults about, each by its name and seed; with one worker in this process."""
    names, seeds = [name for name, _ in orders], [seed for _, seed in orders]
    if workers == 1:
        yield from map(once, names, seeds)
        return
    with ProcessPoolExecutor(workers, get_context("spawn")) as pool:
        yield from pool.map(once, names, seeds)


def known_from(kept: Path | None) -> dict[tuple[str, int], Seen]:
    """Return what a file of results holds."""
    lines = [] if kept is None or not kept.exists() else kept.read_text().splitlines()
    each = [(name, Seen(*seen)) for name, seen in map(json.loads, lines)]
    return {(name, seen.seed): seen for name, seen in each}


def gathered(
    rows: Sequence[Row], seeds: Sequence[int], workers: int, kept: Path | None
) -> list[tuple[Row, Seen]]:
    """Bring every fault about with every seed; what `kept` holds is not done again."""
    known = known_from(kept)
    for group, many in ((FLIGHTS, workers), (PROCESSES, 1 if workers == 1 else WAITING)):
        some = [row.name for row in rows if row in group]
        new = [order for name in some for seed in seeds if (order := (name, seed)) not in known]
        quiet = not sys.stderr.isatty()
        every = track(seen_of(new, many), "faults", len(new), disable=quiet)
        for order, seen in zip(new, every, strict=True):
            known[order] = seen
            if kept is not None:
                with kept.open("a", encoding="utf-8") as file:
                    file.write(json.dumps([order[0], seen]) + "\n")
    return [(row, known[row.name, seed]) for row in rows for seed in seeds]


def line(row: Row, all_seen: Sequence[Seen]) -> list[str]:
    """Return the row of the table."""
    counts = Counter(seen.outcome for seen in all_seen)
    lied = sum(seen.lied for seen in all_seen)
    came = [f"{outcome}: {count}" for outcome, count in counts.most_common()]
    came += [f"called a success wrongly: {lied}"] if lied else []
    as_declared = sum(good(row, seen) for seen in all_seen)
    return [
        row.name,
        row.what,
        "; or ".join(row.declared),
        "; ".join(came),
        f"{as_declared} of {len(all_seen)}",
    ]


def deviations(results: Sequence[tuple[Row, Seen]]) -> str:
    """Return a sentence for each seed that came to something else, or that there was none."""
    others = [
        f"- {row.name}, seed {seen.seed}: {seen.outcome}"
        f"{', called a success' if seen.lied else ''} ({seen.told})"
        for row, seen in results
        if not good(row, seen)
    ]
    return "\n".join(others) if others else "None."


def page(results: Sequence[tuple[Row, Seen]], command: str) -> str:
    """Return the study as Markdown."""
    by_name: dict[str, tuple[Row, list[Seen]]] = {}
    for row, seen in results:
        by_name.setdefault(row.name, (row, []))[1].append(seen)
    header = ["fault", "what happens", "declared", "seen", "as declared"]
    lines = [line(row, all_seen) for row, all_seen in by_name.values()]
    right = sum(good(row, seen) for row, seen in results)
    return Template(PAGE.read_text(encoding="utf-8")).substitute(
        command=command,
        faults=len(by_name),
        right=right,
        total=len(results),
        hit=sum("hit" in seen.outcome or seen.outcome == "crashed" for _, seen in results),
        lied=sum(seen.lied for _, seen in results),
        home=f"{AT_HOME:g}",
        rows=table(header, lines),
        deviations=deviations(results),
    )


def chosen_rows(names: Sequence[str]) -> tuple[Row, ...]:
    """Return the rows of these names, all without any.

    Raises:
        SystemExit: there is no such row.
    """
    known = {row.name: row for row in ROWS}
    for name in names:
        if name not in known:
            raise SystemExit(f"no such fault {name!r}: {nearest(name, known)}")
    return tuple(known[name] for name in names) or ROWS


def main(arguments: Sequence[str] | None = None) -> int:
    """Bring all faults about; the exit code is 1 if something was hit or a success invented."""
    parser = argparse.ArgumentParser(prog="python -m studies.faults", description=main.__doc__)
    parser.add_argument("--seeds", type=int, default=20, help="of each fault")
    parser.add_argument("--first", type=int, default=100, metavar="SEED")
    parser.add_argument("--only", action="append", default=[], metavar="FAULT")
    parser.add_argument("--workers", type=int, default=2, help="processes that compute")
    parser.add_argument("--kept", type=Path, help="file of results, to go on after a break")
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    chosen = parser.parse_args(arguments)
    seeds = range(chosen.first, chosen.first + chosen.seeds)
    rows = chosen_rows(chosen.only)
    results = gathered(rows, seeds, chosen.workers, chosen.kept)
    command = f"python -m studies.faults --seeds {chosen.seeds} --first {chosen.first}"
    (chosen.out / "faults.md").write_text(page(results, command), encoding="utf-8")
    bad = [seen for _, seen in results if seen.lied or seen.outcome in {"crashed", "hit something"}]
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
