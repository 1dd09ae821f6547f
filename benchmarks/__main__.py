"""`python -m benchmarks [TOPIC ...] [--write]`: times, printed; nothing passes or fails."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Iterable
from pathlib import Path

from benchmarks import (
    arena,
    campaign,
    command_line,
    cycle,
    ddp,
    engine,
    estimation,
    feature_navigator,
    growth,
    perception,
    planning,
    recording,
    speed,
    tandem,
    wire,
)
from benchmarks.measure import Table, machine
from studies.markdown import table

TOPICS: dict[str, Callable[[], list[Table]]] = {
    "cycle": cycle.tables,
    "growth": growth.tables,
    "speed": speed.tables,
    "arena": arena.tables,
    "campaign": campaign.tables,
    "engine": engine.tables,
    "command-line": command_line.tables,
    "perception": perception.tables,
    "estimation": estimation.tables,
    "features": feature_navigator.tables,
    "tandem": tandem.tables,
    "recording": recording.tables,
    "planning": planning.tables,
    "ddp": ddp.tables,
    "wire": wire.tables,
}
PAGE = Path("docs/benchmarks.md")
INTRODUCTION = """# Benchmarks

Written by `python -m benchmarks --write`. Compare figures only within one such page: they depend
on the machine and on what else it does.
"""


def main() -> None:
    """Measure the topics asked for, or all."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=main.__doc__)
    parser.add_argument("topics", nargs="*", metavar="TOPIC", help=", ".join(TOPICS))
    parser.add_argument("--write", action="store_true", help=f"write {PAGE} as well")
    options = parser.parse_args()
    if unknown := set(options.topics) - TOPICS.keys():
        parser.error(f"unknown topic {', '.join(sorted(unknown))}; there are {', '.join(TOPICS)}")
    about = machine()
    print(about)
    parts = [INTRODUCTION, f"{about}.\n"]
    for part in _measured(options.topics or TOPICS):
        print(f"\n{part}", flush=True)
        parts.append(f"{part}\n")
    if options.write:
        PAGE.write_text("\n".join(parts), encoding="utf-8")


def _measured(topics: Iterable[str]) -> Iterable[str]:
    for topic in topics:
        for it in TOPICS[topic]():
            note = f"\n\n{it.note}" if it.note else ""
            yield f"## {it.title}\n\n{table(it.header, it.rows)}{note}"


if __name__ == "__main__":
    main()
