"""Missions of jobs that people fly, in the simulator: shortened where that leaves what is shown."""

from __future__ import annotations

import math

import numpy as np
import pytest
from rehearsed import MISSIONS, Flight, flown

from missionkit.chart.load import load, parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.engine.flight_loop import Operator
from missionkit.engine.pause import BY_OPERATOR
from missionkit.messages import CONTINUE, PAUSE
from missionkit.rehearsal.stage import stage, world_of

FILES = ("three_poles", "survey", "tower", "find_and_orbit")


class Pausing(Operator):
    """Pauses at a tick of the flight and lets it continue at another."""

    def __init__(self, first: int, last: int) -> None:
        super().__init__()
        self.due = {first: PAUSE, last: CONTINUE}
        self.ticks = 0

    def take(self) -> tuple[str, ...]:
        self.ticks += 1
        if self.ticks in self.due:
            self.send(self.due[self.ticks])
        return super().take()


def fly(name: str, operator: Operator | None = None, **parameters: str) -> Flight:
    catalogue = builtin()
    mission = load(MISSIONS / f"{name}.yaml", catalogue, parameters)
    eye = mission.camera.model_copy(update={"use": "corners"})
    mission = mission.model_copy(update={"camera": eye})
    return flown(stage(mission, catalogue, world_of(mission, MISSIONS), 5), operator)


@pytest.mark.parametrize("name", FILES)
def test_each_is_a_page(name):
    assert len((MISSIONS / f"{name}.yaml").read_text().splitlines()) <= 60


def test_one_state_serves_each_pole():
    path, catalogue = MISSIONS / "three_poles.yaml", builtin()
    text = path.read_text().partition("success:")[0]  # which names all three
    mission = parse(text, str(path), catalogue, {"poles": "[p1]"})
    eye = mission.camera.model_copy(update={"use": "corners"})
    mission = mission.model_copy(update={"camera": eye})
    flight = flown(stage(mission, catalogue, world_of(mission, MISSIONS), 5))
    assert flight.result.grade.landed
    went = [to for to, _ in flight.went()]
    assert went == ["poles", "poles/p1/look", "poles/p1/seen", "poles/finished", "home", "land"]


def test_a_survey_that_is_paused_covers_its_field():
    field = "[[6, 0], [20, 0], [20, 9], [6, 9]]"
    flight = fly("survey", Pausing(360, 460), field=field, height="8", speed="2.2")
    assert flight.result.succeeded
    notes = [r.step_note for r in flight.records if r.state == "map"]
    first = notes.index(BY_OPERATOR)
    assert notes[first + 100].startswith(notes[first - 1])
    assert [dict(r.verdicts)["mapped"].holds for r in flight.records if r.verdicts][-1]


def test_a_search_finds_what_lies_there_and_circles_it():
    flight = fly("find_and_orbit")
    assert flight.result.succeeded
    states = [to for to, _ in flight.went()]
    assert states == ["out", "search", "circle", "home", "land"]
    marker = np.array((20.0, 36.0))
    true = [it for it in flight.ready.vehicle.track.rows if it[0] > flight.entered("circle") + 15.0]
    on = [it for it in true if it[0] < flight.entered("home")]
    radii = [math.dist(it[1:3], marker) for it in on]
    assert max(radii) < 8.0
    assert min(radii) > 6.0
