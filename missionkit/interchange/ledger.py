"""The loss ledger: what became of each item of a file."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from enum import StrEnum
from typing import NamedTuple


class Outcome(StrEnum):
    """What became of an item."""

    KEPT = "kept"
    APPROXIMATED = "approximated"
    REFUSED = "refused"


class Entry(NamedTuple):
    """One item of the source."""

    item: str  # which one, such as `item 3`
    what: str  # what the file calls it
    outcome: Outcome
    note: str = ""  # what it is now, or why not
    figure: float | None = None  # how much it differs
    unit: str = ""

    def line(self) -> str:
        """Return it as a line of text."""
        figure = "" if self.figure is None else f" by {self.figure:.3g} {self.unit}".rstrip()
        note = f": {self.note}" if self.note else ""
        return f"{self.outcome}{figure}: {self.item}, {self.what}{note}"


@dataclass
class Ledger:
    """Every item of one source, in its order, and what was added that the source has not."""

    source: str  # name of the file
    form: str  # its format
    entries: list[Entry] = field(default_factory=list)
    added: list[str] = field(default_factory=list)

    def open(self, item: str, what: str) -> int:
        """Begin an entry, kept so far; return its number."""
        self.entries.append(Entry(item, what, Outcome.KEPT))
        return len(self.entries) - 1

    def approximate(
        self, number: int, note: str, figure: float | None = None, unit: str = "m"
    ) -> None:
        """Note that an item is not quite what it was; a refusal stays, the larger figure too.

        Args:
            number: of the entry.
            note: what differs.
            figure: by how much.
            unit: of the figure.
        """
        entry = self.entries[number]
        if entry.outcome is Outcome.REFUSED:
            return
        note = f"{entry.note}; {note}" if entry.note and note not in entry.note else note
        if figure is None or (entry.figure is not None and entry.figure >= figure):
            figure, unit = entry.figure, entry.unit
        self.entries[number] = entry._replace(
            outcome=Outcome.APPROXIMATED, note=note, figure=figure, unit=unit
        )

    def refuse(self, number: int, why: str) -> None:
        """Note that an item is left out."""
        entry = self.entries[number]
        if entry.outcome is not Outcome.REFUSED:
            self.entries[number] = entry._replace(
                outcome=Outcome.REFUSED, note=why, figure=None, unit=""
            )

    def remark(self, number: int, note: str) -> None:
        """Say what a kept item is now."""
        entry = self.entries[number]
        if not entry.note:
            self.entries[number] = entry._replace(note=note)

    def counts(self) -> dict[str, int]:
        """Return how many items were kept, approximated and refused; they add up to all."""
        found = Counter(entry.outcome for entry in self.entries)
        return {str(outcome): found[outcome] for outcome in Outcome}

    def summary(self) -> str:
        """Return the counts in words."""
        parts = ", ".join(f"{count} {name}" for name, count in self.counts().items())
        plural = "" if len(self.entries) == 1 else "s"
        return f"{self.form}: {len(self.entries)} item{plural}: {parts}"

    def lines(self) -> Iterator[str]:
        """Yield it as text: what was not kept, what was added, the counts."""
        for entry in self.entries:
            if entry.outcome is not Outcome.KEPT:
                yield entry.line()
        yield from (f"added: {it}" for it in self.added)
        yield self.summary()

    def as_json(self) -> str:
        """Return the whole ledger, for programs."""
        rows: Sequence[dict[str, object]] = [
            {key: value for key, value in entry._asdict().items() if value not in {None, ""}}
            for entry in self.entries
        ]
        whole = {
            "source": self.source,
            "format": self.form,
            "items": len(self.entries),
            "counts": self.counts(),
            "entries": rows,
            "added": self.added,
        }
        return json.dumps(whole, indent=2, ensure_ascii=False) + "\n"
