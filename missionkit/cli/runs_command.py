"""`missionkit runs`: the library of runs, searched, tagged and compared."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from missionkit.cli.printing import say, say_json
from missionkit.errors import ExitCode, UsageError
from missionkit.recorder.run_library import ListedRun, listed, runs_of, tag
from missionkit.recorder.run_summary import Summary, outcome_text
from missionkit.replays.decision_table import ComparedTransition, Taken, tabulated


class Wanted(NamedTuple):
    """Which runs are listed: those that fulfil all of it."""

    search: str = ""  # words that all stand in it somewhere
    tags: tuple[str, ...] = ()
    outcome: str = ""

    def fits(self, run: ListedRun) -> bool:
        """Say whether a run is wanted."""
        words = self.search.lower().split()
        outcome = self.outcome.replace(" ", "_")
        return (
            all(word in run.words for word in words)
            and set(self.tags) <= set(run.tags)
            and outcome in {"", run.outcome}
        )


class Retag(NamedTuple):
    """Tags that the runs listed get and lose."""

    add: tuple[str, ...] = ()
    remove: tuple[str, ...] = ()


def runs(folder: Path, wanted: Wanted, retag: Retag, *, as_json: bool) -> ExitCode:
    """List the runs in a folder.

    Args:
        folder: of runs, or a run.
        wanted: which of them.
        retag: tags that they get and lose.
        as_json: print them as JSON.

    Raises:
        UsageError: there is no such folder, or a tag cannot be one.
    """
    found = [it for it in runs_of(folder) if wanted.fits(it)]
    if retag.add or retag.remove:
        found = [it._replace(tags=tag(it.folder, retag.add, retag.remove)) for it in found]
    if as_json:
        say_json([_plain(it) for it in found])
        return ExitCode.SUCCESS
    width = max((len(_name(it, folder)) for it in found), default=0)
    for it in found:
        say(_line(it, _name(it, folder), width))
    say(_count(found))
    return ExitCode.SUCCESS


def compare(one: Path, other: Path, *, as_json: bool) -> ExitCode:
    """Compare two runs by their summaries.

    Args:
        one: folder of a run.
        other: folder of another.
        as_json: print it as JSON.

    Raises:
        UsageError: one has no summary that can be read.
    """
    first, second = _summary_of(one), _summary_of(other)
    rows = tabulated(_taken(first), _taken(second), None, 0.0).rows
    fields = list(_fields(first, second))
    if as_json:
        plain = {
            "fields": [{"field": name, "one": a, "other": b} for name, a, b in fields],
            "transitions": [_plain_row(row) for row in rows],
        }
        say_json(plain)
        return ExitCode.SUCCESS
    for name, a, b in fields:
        say(f"{name}: {a} | {b}")
    for row in rows:
        say(_row(row))
    return ExitCode.SUCCESS


def _summary_of(folder: Path) -> Summary:
    if not folder.is_dir():
        raise UsageError(f"{folder}: no such folder")
    run = listed(folder)
    if run.summary is None:
        raise UsageError(f"{folder}: {run.problem}")
    return run.summary


def _fields(one: Summary, other: Summary) -> Iterator[tuple[str, object, object]]:
    """Yield what two runs are compared by; parameters and figures only where they differ."""
    yield "mission", one.mission, other.mission
    yield "outcome", outcome_text(one.outcome), outcome_text(other.outcome)
    yield "reason", one.reason, other.reason
    yield "duration (s)", round(one.duration, 2), round(other.duration, 2)
    yield "seed", one.seed, other.seed
    yield "faults", ", ".join(one.faults) or "none", ", ".join(other.faults) or "none"
    yield "problems", len(one.problems), len(other.problems)
    for title, first, second in (
        ("parameter", one.parameters, other.parameters),
        ("grade", one.grade, other.grade),
    ):
        for name in dict.fromkeys((*first, *second)):
            if first.get(name) != second.get(name):
                yield f"{title} {name}", first.get(name), second.get(name)
    met = {it.requirement: it.fulfilled for it in one.requirements}
    now = {it.requirement: it.fulfilled for it in other.requirements}
    for name in dict.fromkeys((*met, *now)):
        if met.get(name) != now.get(name):
            yield f"requirement {name}", _met(met.get(name)), _met(now.get(name))


def _met(fulfilled: bool | None) -> str:  # noqa: FBT001 - a value of the summary
    return {True: "fulfilled", False: "broken", None: "undecided"}[fulfilled]


def _taken(summary: Summary) -> list[Taken]:
    return [Taken(it.at, it.source, it.to, it.reason) for it in summary.transitions]


def _row(row: ComparedTransition) -> str:
    taken = row.now or row.flown
    name = "" if taken is None else f"{taken.source} -> {taken.to}"
    return f"{row.change:<8} {name}: {_at(row.flown)} | {_at(row.now)}"


def _at(taken: Taken | None) -> str:
    return "not taken" if taken is None else f"{taken.at:.2f} s ({taken.reason})"


def _plain_row(row: ComparedTransition) -> dict[str, object]:
    return {
        "change": row.change,
        "one": None if row.flown is None else row.flown._asdict(),
        "other": None if row.now is None else row.now._asdict(),
    }


def _name(run: ListedRun, folder: Path) -> str:
    inside = run.folder.relative_to(folder)
    return str(inside) if inside.parts else run.folder.name or str(run.folder)


def _line(run: ListedRun, name: str, width: int) -> str:
    tags = f"  [{', '.join(run.tags)}]" if run.tags else ""
    if run.summary is None:
        return f"{name:<{width}}  {run.problem}{tags}"
    it = run.summary
    how = f"{outcome_text(it.outcome):<12}  {it.duration:7.1f} s  {it.mission}"
    more = f": {it.reason}" if it.outcome != "success" else ""
    note = f" ({run.problem})" if run.problem else ""
    return f"{name:<{width}}  {how}{more}{tags}{note}"


def _count(found: Sequence[ListedRun]) -> str:
    outcomes = [outcome_text(it.outcome) for it in found]
    counts = ", ".join(f"{outcomes.count(name)} {name}" for name in dict.fromkeys(outcomes))
    return f"{len(found)} run{'' if len(found) == 1 else 's'}" + (f": {counts}" if counts else "")


def _plain(run: ListedRun) -> dict[str, object]:
    it = run.summary
    return {
        "folder": str(run.folder),
        "tags": list(run.tags),
        "problem": run.problem,
        "outcome": run.outcome,
        "mission": None if it is None else it.mission,
        "reason": None if it is None else it.reason,
        "duration": None if it is None else it.duration,
        "seed": None if it is None else it.seed,
        "faults": None if it is None else list(it.faults),
    }
