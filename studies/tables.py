"""The tables of the study."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence

from scipy.stats import chi2

from studies.flight import Outcome, Run
from studies.losses import losses_of
from studies.markdown import table
from studies.statistics import Spread, rms, spread, wilson
from studies.watch import Sample

Groups = Mapping[str, Sequence[Run]]
Cells = Mapping[tuple[str, str], Sequence[Run]]


def outcomes(groups: Groups) -> str:
    """Return the number of flights per group and outcome, with Wilson's interval."""
    rows = []
    for name, runs in groups.items():
        good = sum(run.succeeded for run in runs)
        low, high = wilson(good, len(runs))
        share = f"{100.0 * low:.1f} to {100.0 * high:.1f} %"
        counts = [sum(run.outcome is outcome for run in runs) for outcome in Outcome]
        rows.append((name, str(len(runs)), str(good), share, *map(str, counts)))
    header = ("flights", "number", "succeeded", "95 % interval", *Outcome)
    return table(header, rows)


def exactness(groups: Groups) -> str:
    """Return what ground truth says of each group: errors, clearance, time, energy."""
    rows = []
    for name, runs in groups.items():
        visits = [run.grade.visit for run in runs if run.grade.visit is not None]
        turns = [math.degrees(v.yaw_error) for v in visits if v.yaw_error is not None]
        measures = {
            "position error on entry, cm": ([100.0 * v.position_error for v in visits], 1),
            "heading error on entry, deg": (turns, 2),
            "largest offset across the normal in task, cm": (
                [100.0 * v.worst_sideways for v in visits],
                1,
            ),
            "least clearance on the way, m": ([run.passed for run in runs], 2),
            "least clearance, trunk included, m": ([run.grade.clearance for run in runs], 2),
            "armed, s": ([run.grade.duration for run in runs], 0),
            "flown, m": ([run.grade.distance for run in runs], 0),
            "energy, kJ": ([1e-3 * run.grade.energy for run in runs], 1),
        }
        rows += [
            (name, what, *_shown(spread(values), digits))
            for what, (values, digits) in measures.items()
            if values
        ]
    return table(("flights", "measure", "least", "median", "95 %", "most"), rows)


def losses(runs: Iterable[Run]) -> str:
    """Return how long the loss of the marker took to be noticed and to be mended."""
    seen = list(losses_of(runs))
    found = [loss.found for loss in seen if loss.found is not None]
    measures = {
        "last sighting to start of search, s": [loss.lost for loss in seen],
        "marker's return to lock, s": found,
    }
    rows = [(w, str(len(v)), *_shown(spread(v), 2)) for w, v in measures.items() if v]
    return table(("measure", "flights", "least", "median", "95 %", "most"), rows)


def estimates(runs: Sequence[Run]) -> str:
    """Return the errors of the estimate in each state, and how many the filter admitted.

    The last columns give the share of samples inside the region that holds 95 % of them if the
    filter's own standard deviation σ is right: ‖e‖² ≤ χ²₀.₉₅ σ², with 2 degrees of freedom for
    the horizontal position and 3 for the vector to the target.
    """
    samples = [sample for run in runs for sample in run.samples]
    states = dict.fromkeys(sample.state for sample in samples)
    rows = [_estimate(state, [s for s in samples if s.state == state]) for state in states]
    header = (
        "state",
        "horizontal, m",
        "vertical, m",
        "heading, deg",
        "to the target, m",
        "horizontal within 95 %",
        "to the target within 95 %",
    )
    return table(header, rows)


def faults(cells: Cells) -> str:
    """Return the number of flights with each outcome, by fault and moment."""
    names = dict.fromkeys(name for name, _ in cells)
    moments = dict.fromkeys(moment for _, moment in cells)
    rows = [(f"`{n}`", *(_counts(cells.get((n, m), ())) for m in moments)) for n in names]
    return table(("fault", *moments), rows)


def _estimate(state: str, samples: Sequence[Sample]) -> tuple[str, ...]:
    seen = [(s.relative, s.relative_sd) for s in samples if s.relative and s.relative_sd]
    flat = [(s.horizontal, s.sd) for s in samples]
    return (
        state,
        f"{rms([s.horizontal for s in samples]):.2f}",
        f"{rms([s.vertical for s in samples]):.2f}",
        f"{math.degrees(rms([s.heading for s in samples])):.2f}",
        f"{rms([error for error, _ in seen]):.3f}" if seen else "",
        _inside(flat, 2),
        _inside(seen, 3) if seen else "",
    )


def _inside(pairs: Sequence[tuple[float, float]], degrees: int) -> str:
    limit = float(chi2.ppf(0.95, degrees))
    inside = sum(error * error <= limit * sd * sd for error, sd in pairs)
    return f"{100.0 * inside / len(pairs):.0f} %"


def _counts(runs: Sequence[Run]) -> str:
    return " / ".join(str(sum(run.outcome is outcome for run in runs)) for outcome in Outcome)


def _shown(it: Spread, digits: int) -> tuple[str, ...]:
    return tuple(f"{value:.{digits}f}" for value in it)
