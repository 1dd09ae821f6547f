"""What other values of parameters would have decided in a recorded flight, for the page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from missionkit.api.what_if import what_if
from missionkit.page.server.page_source import PageError
from missionkit.replays.decision_table import Taken


def what_if_answer(
    run: Path, body: Mapping[str, Any], plugins: Sequence[Path] = ()
) -> dict[str, object]:
    """Return the transitions of the flight beside those with other values.

    Args:
        run: folder of the run.
        body: of the request: `set`, values of parameters by name.
        plugins: files that the flight used.

    Raises:
        FileError: the mission has errors with these values.
        PageError: the request is not one.
        UsageError: the journal cannot be used.
    """
    settings = body.get("set")
    if not isinstance(settings, dict) or not settings:
        raise PageError("set: an object with names of parameters and their values")
    if body.get("from") is not None:
        raise PageError("from: values are changed from the start of the flight: leave it out")
    found = what_if(run, settings=settings, plugins=plugins)
    return {
        "rows": [
            {
                "at": row.at,
                "was": _said(row.flown),
                "now": _said(row.now),
                "kind": row.change.value,
                "evidence": row.evidence,
            }
            for row in found.table.rows
        ],
        "evidence_until": found.table.parted,
        "notes": list(found.notes),
    }


def _said(it: Taken | None) -> str | None:
    return None if it is None else f"{it.at:.2f} s {it.source} -> {it.to}: {it.reason}"
