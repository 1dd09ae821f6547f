"""Landings on pads by `land_on`, flown; the truth is the judge."""

from __future__ import annotations

import math

import numpy as np
import pytest
from rehearsed import MISSIONS, flown

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.rehearsal.stage import stage, world_of
from missionkit.sim.deck import Deck, DeckMarker
from missionkit.sim.fault_injection import parse_fault

TEXT = (MISSIONS / "pad_landing.yaml").read_text()
MARKERS = (
    DeckMarker(dictionary="DICT_6X6_250", id=19, size=0.6),
    DeckMarker(dictionary="DICT_6X6_250", id=227, size=0.08),
)


def landing(*faults, seed=1, deck=None, text=TEXT):
    """Fly it with camera corners; on a deck, if there is one, instead of on the ground."""
    mission = parse(text, str(MISSIONS / "pad_landing.yaml"), builtin())
    eye = mission.camera.model_copy(update={"use": "corners"})
    mission = mission.model_copy(update={"camera": eye})
    world = world_of(mission, MISSIONS)
    if deck is not None:
        world = world.model_copy(update={"deck": deck, "markers": ()})
    return flown(stage(mission, builtin(), world, seed, tuple(map(parse_fault, faults))))


def missed(flight, place=lambda _: (15.3, 0.4)):
    """How far from the middle of the pad it first touched it, in truth (m)."""
    rows = flight.ready.vehicle.track.rows
    touch = rows[np.flatnonzero(rows[:, 14] == 0.0)[-1] + 1]
    return math.dist(touch[1:3], place(touch[0]))


def test_it_lands_on_the_pad_in_wind_of_5_metres_per_second():
    flight = landing()
    assert [to for to, _ in flight.went()] == ["pad", "land"]
    assert flight.result.succeeded
    assert missed(flight) < 0.12
    assert flight.problems() == []


@pytest.mark.parametrize(("speed", "tilt"), [(1.0, 0.0), (0.0, 8.0)])
def test_it_lands_on_a_deck_that_drives_or_leans(speed, tilt):
    deck = Deck(
        at=(15.3 - 12.0 * speed, 0.4),
        height=0.5,
        size=2.0,
        tilt_deg=tilt,
        velocity=(speed, 0.0),
        markers=MARKERS,
    )
    text = TEXT.replace("[15.0, 0.0, 0.0]", "[15.0, 0.0, -0.5]")
    if speed:
        text = text.replace("visual_inertial_ekf}", "visual_inertial_ekf, moving: {pad: 1.5}}")
    flight = landing(deck=deck, text=text)
    truth = flight.ready.vehicle.truth
    assert flight.result.succeeded
    assert truth.on_ground
    assert truth.position[2] < -0.3  # on it, not beside it

    def middle(now):
        north, east = deck.shift(now)
        return deck.at[0] + north, deck.at[1] + east

    assert missed(flight, middle) < 0.2
    assert math.dist(truth.position[:2], middle(truth.at)) < 0.3  # it rides along


def test_a_pad_covered_on_the_way_down_is_tried_again():
    flight = landing("marker_hidden@pad:6+4")
    events = [it for record in flight.records for it in record.estimate.events]
    assert "pad.aborted" in events
    assert flight.result.succeeded
    assert missed(flight) < 0.15


def test_a_pad_that_stays_covered_is_given_up_and_it_goes_home():
    flight = landing("marker_hidden@pad:6")
    assert [to for to, _ in flight.went()] == ["pad", "back", "land"]
    assert not flight.result.succeeded
    assert flight.result.grade.landed
    assert math.hypot(*flight.ready.vehicle.truth.position[:2]) < 2.0


def by_autopilot(*faults, seed=1):
    text = TEXT.replace("use: land_on, ", "use: land_on, by: autopilot, ")
    assert text != TEXT
    return landing(*faults, seed=seed, text=text)


def test_the_simulated_autopilot_lands_on_the_pad_it_is_told_of():
    flight = by_autopilot()
    told = [r.command.landing_target for r in flight.records if r.command.landing_target]
    assert len(told) > 40
    assert flight.result.succeeded
    assert missed(flight) < 0.3
    modes = {r.estimate.status.mode for r in flight.records if r.estimate.status}
    assert "precision_land" in modes


def test_it_takes_over_when_the_pad_is_lost_and_lands_at_the_next_try():
    flight = by_autopilot("marker_hidden@pad:6+4")
    notes = [r.step_note for r in flight.records]
    assert any("attempt 1 of 4 is over" in it for it in notes)
    assert flight.result.succeeded
    assert missed(flight) < 0.3
