"""Flying a campaign: what is still to be flown, the journal, and when to stop."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable
from contextlib import closing
from pathlib import Path

from missionkit.campaigns.campaign_plan import Campaign
from missionkit.campaigns.run_journal import Journal, read
from missionkit.campaigns.run_row import Case, Row
from missionkit.campaigns.stopping_rule import enough

Crew = Callable[[Iterable[Case]], Generator[Row, None, None]]
"""Flies cases and yields their rows as they end."""


def conduct(
    campaign: Campaign, folder: Path, crew: Crew, tell: Callable[[Row], None]
) -> tuple[Row, ...]:
    """Fly what the journal does not hold yet; return the rows that count.

    Args:
        campaign: what to fly.
        folder: where its journal is.
        crew: flies; closed when enough is known.
        tell: called with every row that is new.
    """
    known = {row.number: row for row in read(folder)}
    if _counted(known, campaign) is None:
        todo = (case for case in campaign.cases() if case.number not in known)
        with Journal(folder) as journal, closing(crew(todo)) as rows:
            for row in rows:
                journal.add(row)
                known[row.number] = row
                tell(row)
                if _counted(known, campaign) is not None:
                    break
    return counted(known.values(), campaign)


def counted(rows: Iterable[Row], campaign: Campaign) -> tuple[Row, ...]:
    """Return the rows up to the one at which it was known enough; those in flight do not count."""
    known = {row.number: row for row in rows}
    stop = _counted(known, campaign)
    ordered = [known[number] for number in sorted(known)]
    return tuple(ordered if stop is None else ordered[:stop])


def _counted(known: dict[int, Row], campaign: Campaign) -> int | None:
    """Return after how many runs enough is known: only those without a gap before them count."""
    if campaign.rule.idle:
        return None
    rows: list[Row] = []
    while (row := known.get(len(rows))) is not None:
        rows.append(row)
    return enough(rows, campaign.rule, campaign.variants)
