"""The page of the study."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from string import Template
from typing import NamedTuple

from studies import tables
from studies.assumptions import assumptions
from studies.flight import Outcome, Run, setting
from studies.losses import losses_of
from studies.statistics import wilson

TEMPLATE = Path(__file__).with_name("page.md")
NO_MISSES = "None: no flight was hurt, and none failed without a lasting fault."
RENDERED = (
    "The camera of the first two groups is rendered: 640x480 px images with noise, blur and "
    "latency, in which the detector has to find the marker."
)
CORNERS = (
    "The camera is not rendered: it gives the corners of the markers in view, with noise and "
    "latency. The detector is left out."
)


class Results(NamedTuple):
    """All flights of the study."""

    nominal: Sequence[Run]
    hidden: Sequence[Run]
    faults: tables.Cells

    @property
    def groups(self) -> tables.Groups:
        """The flights that are compared, by name."""
        groups = {"nominal": self.nominal, "marker hidden for 6 s": self.hidden}
        return {name: runs for name, runs in groups.items() if runs}

    @property
    def swept(self) -> list[Run]:
        """The flights with faults, in one list."""
        return [run for runs in self.faults.values() for run in runs]


def page(results: Results, command: str) -> str:
    """Return the page in Markdown; `command` is what produced it."""
    mission, world = setting()
    success, *_ = mission.success
    rendered = any(run.order.camera == "rendered" for run in results.nominal)
    parts = {
        "command": command,
        "verdict": verdict(results),
        "outcomes": tables.outcomes(results.groups),
        "position": f"{success.position:g} m",
        "yaw": f"{success.yaw_deg:g} deg",
        "exactness": tables.exactness(results.groups),
        "hidden_for": "6",
        "losses": tables.losses(results.hidden),
        "sweep": str(max(map(len, results.faults.values()), default=0)),
        "faults": tables.faults(results.faults),
        "misses": misses([*results.nominal, *results.hidden, *results.swept]),
        "estimates": tables.estimates(results.nominal),
        "camera_note": RENDERED if rendered else CORNERS,
        "assumptions": "\n".join(f"- **{n}**: {text}" for n, text in assumptions(mission, world)),
    }
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(parts)


def verdict(results: Results) -> str:
    """Return the results, one line for each part of the study."""
    said = [f"{name}: {headline(runs)}." for name, runs in results.groups.items()]
    if lost := [loss.lost for loss in losses_of(results.hidden)]:
        low, high = min(lost), max(lost)
        said.append(f"start of the search: {low:.2f} to {high:.2f} s after the last sighting.")
    if results.swept:
        said.append(f"faults that stay: {len(results.swept)} flights, {harm(results.swept)}.")
    return "\n".join(f"- {line[0].upper()}{line[1:]}" for line in said)


def headline(runs: Sequence[Run]) -> str:
    """Return how many flights succeeded, what that proves, and how many were hurt."""
    good = sum(run.succeeded for run in runs)
    low, _ = wilson(good, len(runs))
    sure = f"at least {100.0 * low:.0f} % with 97.5 % confidence"
    return f"{good} of {len(runs)} flights succeeded ({sure}); {harm(runs)}"


def harm(runs: Sequence[Run]) -> str:
    """Return how many flights were hurt or did not come down."""
    hurt = sum(run.outcome is Outcome.HURT for run in runs)
    return f"{hurt} hit something or stayed up" if hurt else "none was hurt, all came down"


def misses(runs: Sequence[Run]) -> str:
    """Return every flight that was hurt, or that failed without a lasting fault."""
    lines = [_described(run) for run in runs if run.outcome is Outcome.HURT or _surprising(run)]
    return "\n".join(lines) if lines else NO_MISSES


def why(run: Run) -> str:
    """Return in a few words why a flight was no success."""
    grade = run.grade
    if grade.crashed:
        return "hit an obstacle or the ground" if run.charge > 0.0 else "fell, its battery empty"
    if not grade.landed:
        return str(run.end)
    if grade.visit is None:
        return "never reached the task"
    return f"entered the task {100.0 * grade.visit.position_error:.1f} cm from the goal"


def _surprising(run: Run) -> bool:
    lasting = any("+" not in fault for fault in run.order.faults)
    return not run.succeeded and not lasting


def _described(run: Run) -> str:
    faults = " ".join(f"--fault {fault}" for fault in run.order.faults)
    changes = "; ".join(f"{c.at:.1f} s {c.source} → {c.to} ({c.reason})" for c in run.changes)
    return f"- `--seed {run.order.seed} {faults}`: {why(run)}. {changes}."
