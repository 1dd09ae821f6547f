"""Behaviours that fly along places and lines."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from flying import fly, places
from playing import marker
from pydantic import ValidationError

from missionkit.behaviors.area_search import ExpandingSquare, Sector
from missionkit.behaviors.survey import Corridor, Survey
from missionkit.behaviors.waypoints import Waypoints
from missionkit.geometry import wrap
from missionkit.perception.camera_section import Camera, Mount

MAST = marker(20.0, 20.0, -8.0)
DOWN = Camera(width=800, height=600, focal=500, mount=Mount(tilt_deg=90)).model()
FIELD = ((0.0, 0.0), (40.0, 0.0), (40.0, 24.0), (0.0, 24.0))


def runs(items):
    return [it for it, _ in itertools.groupby(items)]


def test_places_are_flown_in_their_order_each_as_it_says():
    route = Waypoints(
        height=6.0,
        places=[
            (20.0, 0.0),
            {"at": (20.0, 20.0, -12.0), "speed": 2.0, "heading_deg": 90.0, "event": "halfway"},
            {"at": "mast", "height": 15.0, "wait": 2.0, "payload": "camera"},
            {"at": (0.0, 20.0), "look_at": "mast"},
        ],
    )
    assert route.targets() == ("mast",)
    flown = fly(route, (0.0, 0.0, -6.0), 200.0, lambda _: {"mast": MAST})
    assert flown[-1].step.done
    at = places(flown)
    for place in ((20, 0, -6), (20, 20, -12), (20, 20, -15), (0, 20, -6)):
        assert np.linalg.norm(at - place, axis=1).min() < 2.0
    slow = [it for it in flown if it.step.note.startswith("2 of 4")]
    assert max(np.linalg.norm(it.seen.velocity) for it in slow[60:]) < 2.1
    assert {it.step.guidance.yaw for it in slow[1:]} == {math.radians(90.0)}
    assert [it.step.events for it in flown if it.step.events] == [("halfway",)]
    payload = [it.step.payload for it in flown]
    assert runs(payload) == [None, "camera", None]
    assert payload.count("camera") == pytest.approx(40, abs=2)
    last = [it for it in flown if it.step.note.startswith("4 of 4")][60:]
    for seen, step in last:
        north, east, _ = MAST.position - seen.position
        assert math.hypot(north, east) < 0.6 or step.guidance.yaw == pytest.approx(
            math.atan2(east, north)
        )


def test_a_single_place_and_a_wait_at_the_end_are_finished():
    flown = fly(Waypoints(places=[{"at": (10.0, 0.0), "wait": 3.0}]), (0.0, 0.0, -6.0), 60.0)
    assert flown[-1].step.done
    assert not flown[-2].step.done
    assert np.linalg.norm(places(flown)[-1] - (10, 0, -6)) < 0.7
    assert sum("waiting" in it.step.note for it in flown) == pytest.approx(60, abs=2)


@pytest.mark.parametrize(
    ("place", "height", "down"),
    [
        ("parcel", 20.0, -20.0),
        ("parcel", None, -0.2),
        ({"at": "parcel", "height": 3.0}, 20.0, -3.0),
        ((20.0, 0.0, -7.0), 20.0, -7.0),
        ("home", None, -6.0),
    ],
)
def test_a_target_on_the_ground_is_flown_over_at_the_height_of_the_route(place, height, down):
    route = Waypoints(places=[place], height=height)
    (way,) = route.way((0.0, 0.0, -6.0), {"parcel": (20.0, 0.0, -0.2)})
    assert way[2] == down


def test_a_place_that_is_not_known_is_waited_for():
    flown = fly(Waypoints(places=["mast"]), (0.0, 0.0, -6.0), 1.0)
    assert {it.step.note for it in flown} == {"the position of mast is unknown"}
    assert flown[-1].step.guidance is None


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ([], "at least 1"),
        ([(0, 0)] * 2001, "2001 places: at most 2000"),
        ([{"at": (0, 0), "heading_deg": 3, "look_at": "mast"}], "either heading_deg or look_at"),
        ([{"at": (0, 0), "payload": "camera"}], "'wait'"),
        ([{"at": (0, 0), "event": "not one"}], "name of an event"),
    ],
)
def test_places_that_contradict_themselves_are_refused(wrong, says):
    with pytest.raises(ValidationError, match=says):
        Waypoints(places=wrong)


def survey(**changes):
    return Survey(**({"polygon": FIELD, "height": 20.0, "spacing": 6.0, "speed": 4.0} | changes))


def test_an_area_is_photographed_along_its_lines_and_nowhere_else():
    flown = fly(survey(payload="camera"), (0.0, 0.0, -20.0), 300.0)
    assert flown[-1].step.done
    at = places(flown)
    on = np.array([it.step.payload == "camera" for it in flown])
    lines = [3.0, 9.0, 15.0, 21.0]
    assert np.abs(at[on][:, 1:2] - lines).min(axis=1).max() < 0.6
    for east in lines:
        north = at[on][np.abs(at[on][:, 1] - east) < 0.6][:, 0]
        assert north.min() < 1.0
        assert north.max() > 39.0
    assert at[on][:, 0].min() > -1.0
    assert at[on][:, 0].max() < 41.0
    assert at[:, 0].min() < -2.0  # it turns outside
    assert runs(it.step.note for it in flown) == [f"line {n} of 4" for n in (1, 2, 3, 4)]


def test_a_survey_goes_on_at_the_line_where_it_was_interrupted():
    whole = fly(survey(payload="camera"), (0.0, 0.0, -20.0), 300.0)
    away = whole[len(whole) // 2].seen.now
    flown = fly(survey(payload="camera"), (0.0, 0.0, -20.0), 300.0, absent=(away, away + 15.0))
    before = [it for it in flown if it.seen.now < away]
    after = [it for it in flown if it.seen.now >= away]
    assert "returning to where it was interrupted" in after[0].step.note
    assert after[0].step.payload is None
    assert after[0].step.note.startswith(before[-1].step.note)
    assert flown[-1].step.done
    seen = places([it for it in flown if it.step.payload])
    for north, east in itertools.product(np.arange(1.0, 40.0), (3.0, 9.0, 15.0, 21.0)):
        assert np.linalg.norm(seen[:, :2] - (north, east), axis=1).min() < 0.8


def test_a_later_line_can_be_the_first():
    flown = fly(survey(from_line=3), (0.0, 15.0, -20.0), 300.0)
    assert runs(it.step.note for it in flown) == ["line 3 of 4", "line 4 of 4"]


def test_the_camera_says_how_far_apart_lines_are():
    bare = survey(spacing=None, side_overlap=0.5)
    assert fly(bare, (0.0, 0.0, -20.0), 0.1)[0].step.guidance is None
    ready = bare.with_camera(DOWN)
    assert ready.spacing == pytest.approx(0.5 * 20.0 * 800 / 500)
    assert len(ready.lines((0.0, 0.0))) == 2
    says = bare.explained(DOWN)
    assert "960 m² along 0 deg: 2 lines 16.0 m apart" in says
    assert "a pixel 4.0 cm" in says
    assert "32.0 m x 24.0 m" in says
    assert survey().with_camera(DOWN) == survey()
    level = Camera(use="none").model()
    assert "does not look down" in bare.explained(level)
    assert bare.with_camera(level).way((0.0, 0.0, -20.0), {}) == ()


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"polygon": ((0, 0), (9, 9), (9, 0), (0, 9))}, "edges 1 to 2 and 3 to 4 cross"),
        ({"height": 3.0, "ground": 4.0}, "not above ground"),
        ({"spacing": 0.001}, "at most 2000"),
        ({"entry": "north"}, "north-east"),
    ],
)
def test_an_area_that_cannot_be_flown_is_refused(wrong, says):
    with pytest.raises(ValidationError, match=says):
        survey(**wrong)


def test_a_corridor_is_flown_there_and_back():
    line = ((0.0, 0.0), (40.0, 0.0), (40.0, 40.0))
    corridor = Corridor(line=line, breadth=12.0, spacing=6.0, height=20.0, payload="camera")
    flown = fly(corridor, (0.0, 0.0, -20.0), 300.0)
    assert flown[-1].step.done
    on = places([it for it in flown if it.step.payload])
    for spot in ((3, -3), (43, -3), (43, 37), (37, 37), (37, 3), (3, 3)):
        assert np.linalg.norm(on[:, :2] - spot, axis=1).min() < 1.6
    assert "80 m of corridor" in corridor.explained(DOWN)
    with pytest.raises(ValidationError, match="turns back"):
        Corridor(line=((0, 0), (9, 0), (0, 0)), breadth=2, height=5)


@pytest.mark.parametrize(
    ("search", "farthest", "seconds"),
    [
        (ExpandingSquare(spacing=4.0, outer=12.0, speed=4.0), 12.0 * math.sqrt(2.0), 200.0),
        (Sector(radius=15.0, speed=4.0, heading_deg=40.0), 15.0, 120.0),
    ],
)
def test_a_search_keeps_to_its_pattern(search, farthest, seconds):
    flown = fly(search, (5.0, 6.0, -9.0), seconds)
    assert flown[-1].step.done
    at = places(flown)
    np.testing.assert_allclose(at[:, 2], -9.0, atol=0.2)
    out = np.linalg.norm(at[:, :2] - (5.0, 6.0), axis=1)
    assert out.max() == pytest.approx(farthest, abs=0.8)
    for corner in search.way((5.0, 6.0, -9.0), {}):
        assert np.linalg.norm(at - corner, axis=1).min() < 1.1


def test_a_search_may_be_about_a_target_and_at_a_height():
    search = Sector(target="mast", centre="target", radius=10.0, height=12.0, heading="free")
    flown = fly(search, (0.0, 0.0, -8.0), 200.0, lambda _: {"mast": MAST})
    at = places(flown)
    assert np.linalg.norm(at[-1] - (20, 20, -12)) < 1.0
    assert np.linalg.norm(at[400:, :2] - (20, 20), axis=1).max() < 10.5
    assert all(wrap(it.step.guidance.yaw) == pytest.approx(0.0) for it in flown)
    assert flown[0].step.note.startswith("searching for mast, leg 1 of")
    with pytest.raises(ValidationError, match="needs a target"):
        Sector(centre="target")


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (survey(spacing=None, side_overlap=0.999999), "at most 2000"),
        (survey(from_line=5), "'from_line' is 5, of 4 lines"),
        (Corridor(line=((0, 0), (5, 0), (5, 5)), breadth=50, height=5), "too wide"),
    ],
)
def test_lines_that_the_camera_makes_unflyable_are_refused(wrong, says):
    with pytest.raises(ValueError, match=says):
        wrong.with_camera(DOWN)
