"""Fuzzing of mission files, which must be checked or refused at once: `python -m studies.fuzz`.

Broken documents of nine families are treated as by `missionkit validate`: loading, contracts,
proof, and the report in every format. The study counts exceptions that reach the user as a
traceback, and times each document.
"""

from __future__ import annotations

import argparse
import shutil
import signal
import sys
import tempfile
import traceback
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache, partial
from pathlib import Path
from time import perf_counter, process_time
from types import FrameType
from typing import NamedTuple

from rich.progress import track

from missionkit.chart.checks import findings
from missionkit.chart.load import load
from missionkit.chart.model.state_contracts import unmet
from missionkit.chart.plugin_catalogue import Catalogue, builtin
from missionkit.cli.problem_report import as_json, sources, text
from missionkit.cli.sarif import sarif
from missionkit.errors import FileError, Problem
from studies.fuzz_documents import FAMILIES, ROOT, document
from studies.markdown import table
from studies.parallel import in_parallel

LIMIT = 2.0  # s of CPU time per document, so that other load does not count
HANG = 60.0  # s after which a document is given up


class Order(NamedTuple):
    """Document `number` of a family."""

    family: str
    seed: int
    number: int


class Outcome(NamedTuple):
    """Result of one document."""

    order: Order
    wall: float  # s
    cpu: float  # s
    loaded: bool
    problems: int
    crash: str  # the traceback, empty if there was none


def orders(count: int, seed: int) -> list[Order]:
    """Return so many documents, the families in turn."""
    families = list(FAMILIES)
    return [Order(families[n % len(families)], seed, n) for n in range(count)]


def judge(order: Order, folder: Path) -> Outcome:
    """Write one document and take it through the way of `missionkit validate`."""
    path = folder / f"{order.family}-{order.number}.yaml"
    path.write_bytes(document(*order))
    loaded, found, crash = False, [], ""
    wall, cpu = perf_counter(), process_time()
    try:
        with _given_up_after(HANG):
            loaded, found = checked(path, _catalogue())
            check_message(found)
    except BaseException as error:  # noqa: BLE001  any is a finding
        crash = "".join(traceback.format_exception(error, limit=-6))
    wall, cpu = perf_counter() - wall, process_time() - cpu
    path.unlink()
    return Outcome(order, wall, cpu, loaded, len(found), crash)


def checked(path: Path, catalogue: Catalogue) -> tuple[bool, Sequence[Problem]]:
    """Return whether a file was read as a mission, and all that is wrong with it."""
    try:
        mission = load(path, catalogue)
    except FileError as error:
        return False, error.problems
    return True, [*unmet(mission, catalogue), *findings(mission, catalogue)]


def check_message(problems: Sequence[Problem]) -> None:
    """Write the report in every format."""
    text(problems, sources(problems), colours=True)
    as_json(problems)
    sarif(problems)


@cache
def _catalogue() -> Catalogue:
    return builtin()


@contextmanager
def _given_up_after(seconds: float) -> Iterator[None]:
    def give_up(_: int, __: FrameType | None) -> None:
        raise TimeoutError(f"not done after {seconds:g} s")

    before = signal.signal(signal.SIGALRM, give_up)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)


def judged(every: Sequence[Order], workers: int) -> Iterator[Outcome]:
    """Judge each document, in order, `workers` at a time; with one worker in this process."""
    with tempfile.TemporaryDirectory() as folder:
        shutil.copytree(ROOT / "missions" / "worlds", Path(folder) / "worlds")
        work: Callable[[Order], Outcome] = partial(judge, folder=Path(folder))
        yield from in_parallel(work, every, workers, chunk=16)


def summary(outcomes: Sequence[Outcome]) -> str:
    """Return a table with a row for each family."""
    rows = [
        _row(family, [it for it in outcomes if it.order.family == family]) for family in FAMILIES
    ]
    header = ["family", "documents", "read", "problems", "tracebacks", "slowest, s", "most CPU, s"]
    return table(header, [*rows, _row("all", outcomes)])


def _row(family: str, outcomes: Sequence[Outcome]) -> list[str]:
    return [
        family,
        str(len(outcomes)),
        str(sum(it.loaded for it in outcomes)),
        str(sum(it.problems for it in outcomes)),
        str(sum(bool(it.crash) for it in outcomes)),
        f"{max((it.wall for it in outcomes), default=0.0):.2f}",
        f"{max((it.cpu for it in outcomes), default=0.0):.2f}",
    ]


def main(arguments: Sequence[str] | None = None) -> int:
    """Check very many broken documents; the exit code is 1 if one crashed or took too long."""
    parser = argparse.ArgumentParser(prog="python -m studies.fuzz", description=main.__doc__)
    parser.add_argument("--documents", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--only", metavar="FAMILY:NUMBER", help="write this document to stdout")
    chosen = parser.parse_args(arguments)
    if chosen.only:
        family, _, number = chosen.only.partition(":")
        sys.stdout.buffer.write(document(family, chosen.seed, int(number)))
        return 0
    every = orders(chosen.documents, chosen.seed)
    done = judged(every, chosen.workers)
    outcomes = list(track(done, "checking", len(every), disable=not sys.stderr.isatty()))
    print(summary(outcomes))  # noqa: T201
    bad = [it for it in outcomes if it.crash or it.cpu > LIMIT]
    for it in bad:
        print(f"\n--only {it.order.family}:{it.order.number}: {it.cpu:.2f} s of CPU\n{it.crash}")  # noqa: T201
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
