"""The requirements of the precision task in flight: all fulfilled, and one broken on purpose."""

from __future__ import annotations

from rehearsed import MISSIONS, Flight, flown, precise

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.rehearsal.stage import stage, world_of


def answers(flight: Flight) -> dict[str, bool | None]:
    return {it.name: it.fulfilled for it in flight.result.requirements}


def test_the_precision_task_fulfils_its_requirements_and_the_record_shows_them():
    flight = precise()
    assert set(answers(flight).values()) == {True}
    near = next(it for it in flight.result.requirements if it.name == "near-trunk")
    assert 2.0 < near.robustness < 4.0  # 4 m, less the standoff and what the injection takes
    shown = [dict(record.verdicts)["requirement ends"] for record in flight.records]
    assert shown[0].why == "open, 900.0 s left"
    holds = [it.holds for it in shown]
    landing = holds.index(True)
    assert holds == [None] * landing + [True] * (len(holds) - landing)


def test_one_that_is_broken_leads_home_and_says_by_how_much():
    text = (MISSIONS / "precision_task.yaml").read_text()
    narrow = text.replace("radius: 4.0}, while", "radius: 1.0}, while").replace(
        "use: rendered", "use: corners"
    )
    assert "radius: 1.0" in narrow
    catalogue = builtin()
    mission = parse(narrow, str(MISSIONS / "precision_task.yaml"), catalogue)
    flight = flown(stage(mission, catalogue, world_of(mission, MISSIONS), 1))
    assert answers(flight) == {**answers(precise()), "near-trunk": False}
    entered = flight.entered("task")
    assert ("return", "requirement near-trunk broken for 1 s") in flight.went()
    assert 1.0 <= flight.entered("return") - entered < 1.1
    near = next(it for it in flight.result.requirements if it.name == "near-trunk")
    assert -0.5 < near.robustness < 0.0
    assert flight.result.passage.failsafes[0].label == "requirement near-trunk broken for 1 s"
    assert not flight.result.succeeded
