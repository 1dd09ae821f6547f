"""Times from the loss of the marker to the search, and from its return to the lock."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import NamedTuple

from missionkit.sim.fault_injection import parse_fault
from studies.flight import Run


class Loss(NamedTuple):
    """One loss of the marker in the state visual."""

    lost: float  # s, from the last sighting to the start of the search
    found: float | None  # s, from the marker's return to the state visual; None if never


def losses_of(runs: Iterable[Run]) -> Iterator[Loss]:
    """Yield the first loss of each flight whose marker was covered and that went searching."""
    for run in runs:
        bare = _uncovered(run)
        search = next((c for c in run.changes if (c.source, c.to) == ("visual", "search")), None)
        if bare is None or search is None or search.unseen is None:
            continue
        again = next((c.at for c in run.changes if c.to == "visual" and c.at > search.at), None)
        yield Loss(search.unseen, None if again is None else again - bare)


def _uncovered(run: Run) -> float | None:
    """Return when the marker could be seen again (s), None if it was never covered."""
    for fault in map(parse_fault, run.order.faults):
        since = 0.0 if fault.state is None else run.entered(fault.state)
        if fault.name == "marker_hidden" and since is not None:
            return since + fault.start + fault.duration
    return None
