"""How each requirement stands."""

from __future__ import annotations

import re
from collections.abc import Mapping

from missionkit.chart.semantics.requirement_watch import PREFIX
from missionkit.messages import Record
from missionkit.page.facts.plain_values import number

VERDICTS: Mapping[bool | None, str] = {True: "holds", False: "broken", None: "open"}
TIME_LEFT = re.compile(r"open, (\d+\.\d+) s left")  # as `requirement_watch.verdict` says it


def requirement_rows(record: Record) -> list[dict[str, object]]:
    """Return a row for each requirement."""
    rows: list[dict[str, object]] = []
    for name, verdict in record.verdicts:
        if not name.startswith(PREFIX):
            continue
        left = TIME_LEFT.match(verdict.why)
        rows.append(
            {
                "name": name.removeprefix(PREFIX),
                "verdict": VERDICTS[None if verdict.holds is None else bool(verdict.holds)],
                "robustness": number(verdict.value),
                "deadline_in": None if left is None else float(left[1]),
                "says": verdict.why,
            }
        )
    return rows
