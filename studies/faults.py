"""The matrix of faults, expected and actual outcomes by ground truth: `python -m studies.faults`.

Each fault is injected with many seeds. The judge is the ground truth of the simulator or of the
simulated autopilot; what the program reports is compared with it.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from string import Template

from rich.progress import track

from missionkit.errors import nearest
from studies.fault_flights import AT_HOME, Seen
from studies.fault_rows import FLIGHTS, PROCESSES, ROWS, Row, once
from studies.markdown import table
from studies.parallel import in_parallel

PAGE = Path(__file__).with_suffix(".md")
WAITING = 4  # processes for rows that mostly wait, against two for rows that compute


def good(row: Row, seen: Seen) -> bool:
    """Return whether a seed ended as declared and was reported truthfully."""
    return seen.outcome in row.declared and not seen.false_success


def seen_of(orders: Sequence[tuple[str, int]], workers: int) -> Iterator[Seen]:
    """Inject faults, each by name and seed; with one worker in this process."""
    return in_parallel(_once, orders, workers)


def _once(order: tuple[str, int]) -> Seen:
    return once(*order)


def known_from(kept: Path | None) -> dict[tuple[str, int], Seen]:
    """Return the results in a file, by fault and seed."""
    lines = [] if kept is None or not kept.exists() else kept.read_text().splitlines()
    each = [(name, Seen(*seen)) for name, seen in map(json.loads, lines)]
    return {(name, seen.seed): seen for name, seen in each}


def gathered(
    rows: Sequence[Row], seeds: Sequence[int], workers: int, kept: Path | None
) -> list[tuple[Row, Seen]]:
    """Inject every fault with every seed; results in the file `kept` are not repeated."""
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
    false = sum(seen.false_success for seen in all_seen)
    came = [f"{outcome}: {count}" for outcome, count in counts.most_common()]
    came += [f"false success: {false}"] if false else []
    as_declared = sum(good(row, seen) for seen in all_seen)
    return [
        row.name,
        row.what,
        "; or ".join(row.declared),
        "; ".join(came),
        f"{as_declared} of {len(all_seen)}",
    ]


def deviations(results: Sequence[tuple[Row, Seen]]) -> str:
    """Return a line for each seed that ended otherwise than declared."""
    others = [
        f"- {row.name}, seed {seen.seed}: {seen.outcome}"
        f"{', reported as a success' if seen.false_success else ''} ({seen.details})"
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
        false=sum(seen.false_success for _, seen in results),
        home=f"{AT_HOME:g}",
        rows=table(header, lines),
        deviations=deviations(results),
    )


def chosen_rows(names: Sequence[str]) -> tuple[Row, ...]:
    """Return the rows with these names, all rows without names.

    Raises:
        SystemExit: a name is unknown.
    """
    known = {row.name: row for row in ROWS}
    for name in names:
        if name not in known:
            raise SystemExit(f"no such fault {name!r}: {nearest(name, known)}")
    return tuple(known[name] for name in names) or ROWS


def main(arguments: Sequence[str] | None = None) -> int:
    """Inject all faults; the exit code is 1 if something was hit or a success was false."""
    parser = argparse.ArgumentParser(prog="python -m studies.faults", description=main.__doc__)
    parser.add_argument("--seeds", type=int, default=20, help="of each fault")
    parser.add_argument("--first", type=int, default=100, metavar="SEED")
    parser.add_argument("--only", action="append", default=[], metavar="FAULT")
    parser.add_argument("--workers", type=int, default=2, help="processes that compute")
    parser.add_argument("--kept", type=Path, help="file of results, to continue after a break")
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    chosen = parser.parse_args(arguments)
    seeds = range(chosen.first, chosen.first + chosen.seeds)
    rows = chosen_rows(chosen.only)
    results = gathered(rows, seeds, chosen.workers, chosen.kept)
    command = f"python -m studies.faults --seeds {chosen.seeds} --first {chosen.first}"
    chosen.out.mkdir(parents=True, exist_ok=True)
    (chosen.out / "faults.md").write_text(page(results, command), encoding="utf-8")
    hurt = {"crashed", "hit something"}
    return int(any(seen.false_success or seen.outcome in hurt for _, seen in results))


if __name__ == "__main__":
    sys.exit(main())
