"""Requirements that some run of the chart, or every run, breaks."""

from __future__ import annotations

from collections.abc import Iterator

from missionkit.chart.checks.exploration.example_run import steps_text
from missionkit.chart.checks.exploration.exploration_result import Exploration
from missionkit.chart.checks.exploration.explored_chart import ExploredChart
from missionkit.chart.checks.exploration.requirement_proof import Proof, Standing, proofs
from missionkit.chart.checks.exploration.search import explore
from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.state_contracts import fulfilled
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.errors import Level, Problem


def problems_of(chart: ExploredChart, explored: Exploration) -> Iterator[Problem]:
    """Yield each requirement that is refuted before the flight."""
    for proof in proofs(chart, explored):
        if proof.standing is not Standing.REFUTED:
            continue
        name = proof.requirement.name
        why = (
            "no run of the chart fulfils it"
            if proof.run is None
            else f"a run of the chart breaks it: {steps_text(chart, proof.run.steps)}"
        )
        yield Problem(
            proof.requirement.place("name"),
            f"requirement {name!r}: {why}",
            Level.ERROR if proof.always else Level.WARNING,
            "requirement-broken",
            "change the chart so that this cannot happen, or the requirement",
        )


def standings(mission: Mission, catalogue: Catalogue) -> dict[str, str]:
    """Return in words what is known of each requirement before the flight.

    Args:
        mission: as loaded without problems.
        catalogue: what it was loaded with.
    """
    if not mission.requirements:
        return {}
    catalogue = catalogue.flying(mission.vehicle.use)
    chart = ExploredChart(AnalysedChart(fulfilled(mission, catalogue), catalogue))
    every = proofs(chart, explore(chart))
    return {proof.requirement.name: _said(chart, proof) for proof in every}


def _said(chart: ExploredChart, proof: Proof) -> str:
    if proof.standing is Standing.PROVED:
        return "Proved: no run of the chart breaks it"
    if proof.standing is Standing.OPEN:
        return "Open before the flight"
    if proof.run is None:
        return "Refuted: no run of the chart fulfils it"
    return f"Refuted by a run: {steps_text(chart, proof.run.steps)}"
