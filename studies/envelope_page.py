"""The page of the envelope study."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from statistics import median

from studies.envelope_flight import LIMIT, Run
from studies.markdown import table
from studies.statistics import wilson

TEXT = """\
# Study: the flight envelope

`missions/precision_task.yaml` in its orchard: faster, in more wind, with gusts during its work, and
with random faults. The random search draws a cruise speed of 3 to 8 m/s, wind up to 8 m/s from any
direction with gusts, and one or two faults at random moments for random times. The camera gives the
corners of markers instead of images; a flight is ordered to land after {limit:g} s.
Outcomes come from the simulator's ground truth.

    {command}

{outcomes}

Crashed: the vehicle touched an obstacle, or the ground at more than 2 m/s. The interval is
Wilson's, for the probability of a crash. Clearance is measured from the vehicle's surface; the
trunk that it works on counts.

## Crashes

{crashes}
"""
HEADER = (
    *("flights", "number", "crashed", "95 % interval", "landed", "succeeded"),
    *("least clearance, m", "median error, cm", "median time, s"),
)


def page(groups: Mapping[str, Sequence[Run]], command: str) -> str:
    """Return the page."""
    rows = [_row(name, runs) for name, runs in groups.items()]
    return TEXT.format(
        limit=LIMIT, command=command, outcomes=table(HEADER, rows), crashes=_crashes(groups)
    )


def _row(name: str, runs: Sequence[Run]) -> tuple[str, ...]:
    crashed = sum(run.crashed for run in runs)
    low, high = wilson(crashed, len(runs))
    errors = [run.error for run in runs if run.succeeded and run.error is not None]
    return (
        name,
        str(len(runs)),
        str(crashed),
        f"{100.0 * low:.1f} to {100.0 * high:.1f} %",
        str(sum(run.landed for run in runs)),
        str(sum(run.succeeded for run in runs)),
        f"{min(run.clearance for run in runs):.2f}",
        f"{100.0 * median(errors):.1f}" if errors else "—",
        f"{median(run.armed for run in runs):.0f}",
    )


def _crashes(groups: Mapping[str, Sequence[Run]]) -> str:
    lines = [
        f"- {name}: {run.order.described()}: {run.where}{'' if run.powered else ', battery empty'}"
        for name, runs in groups.items()
        for run in runs
        if run.crashed
    ]
    return "\n".join(lines) or "None."
