"""Fences of polygons: with holes, with heights, and those that are wrong."""

from __future__ import annotations

import numpy as np
import pytest
from samples import calm

from missionkit.api.missions import assemble
from missionkit.chart.checks import findings
from missionkit.chart.load import parse
from missionkit.chart.prose.mission_text import explained
from missionkit.errors import FileError
from missionkit.guards.geofence import Hole, Inside, InsideFence

FIELD = ((0.0, 0.0), (60.0, 0.0), (60.0, 40.0), (0.0, 40.0))
BARN = ((20.0, 10.0), (30.0, 10.0), (30.0, 20.0), (20.0, 20.0))
MAST = ((40.0, 28.0), (42.0, 28.0), (42.0, 30.0), (40.0, 30.0))
FENCE = InsideFence(
    polygon=FIELD, holes=(Hole(polygon=BARN, height=8.0), Hole(polygon=MAST)), height=30.0
)
MISSION = """\
missionkit: 1
mission: field
origin: {{lat: 47.397742, lon: 8.545594, alt: 488}}
fence:
  polygon: {polygon}
  holes: [{holes}]
  height: 30
targets:
  far: {{position: [50, 15, -5]}}
failsafes:
  - {{name: fence, when: {{not: inside_fence}}, to: land}}
initial: idle
states:
  idle:
    kind: idle
    behavior: {{use: take_off, height: {height}}}
    transitions: [{{to: out, when: done}}]
  out:
    kind: gps
    behavior: {{use: go_to, target: far, height: {height}}}
    transitions: [{{to: land, when: done}}, {{to: land, after: 60}}]
  land: {{kind: land}}
"""
CORNERS = "[[-5, -5], [60, -5], [60, 40], [-5, 40]]"
HOLE = "{polygon: [[20, 0], [30, 0], [30, 20], [20, 20]], height: 8}"


def mission(polygon=CORNERS, holes=HOLE, height=5):
    text = MISSION.format(polygon=polygon, holes=holes, height=height)
    return parse(text, "field.yaml", assemble(()))


@pytest.mark.parametrize(
    ("point", "margin"),
    [
        ((10.0, 20.0, -5.0), 10.0),
        ((10.0, 20.0, -28.0), 2.0),
        ((-3.0, 20.0, -5.0), -3.0),
        ((25.0, 15.0, -5.0), -3.0),  # 3 m below the barn's top
        ((25.0, 15.0, -12.0), 4.0),  # over it
        ((17.0, 15.0, -12.0), 5.0),  # 3 m beside and 4 m above its edge
        ((41.0, 29.0, -29.0), -1.0),  # the mast reaches to the sky
        ((10.0, 20.0, -33.0), -3.0),
    ],
)
def test_the_margin_is_the_distance_to_what_is_nearest(point, margin):
    verdict = FENCE.check(calm(position=np.array(point)))
    assert verdict.value == pytest.approx(margin)
    assert verdict.holds == (margin >= 0.0)


def test_inside_is_about_the_ground():
    guard = Inside(polygon=BARN)
    assert guard.check(calm(position=np.array((25.0, 18.0, -90.0)))).value == pytest.approx(2.0)
    assert guard.check(calm(position=np.array((25.0, 22.0, 0.0)))).holds is False
    assert guard.region() != Inside(polygon=MAST).region()


def test_cuts_find_every_change():
    start, end = (-10.0, 15.0, -2.0), (70.0, 15.0, -2.0)
    cuts = sorted(FENCE.cuts(start, end))
    assert cuts == pytest.approx([0.125, 0.375, 0.5, 0.875])


def test_the_section_is_the_guard_without_parameters():
    loaded = mission()
    failsafe = loaded.failsafes[0].when.part
    assert failsafe.plugin is not None
    assert failsafe.plugin.polygon == loaded.fence.polygon
    assert failsafe.plugin.holes[0].height == 8.0


def test_a_leg_through_a_hole_is_found_and_one_over_it_is_not():
    found = [it for it in findings(mission(), assemble(())) if it.code == "outside-fence"]
    assert len(found) == 1
    assert "leg from 'idle' lies where failsafe 'fence' acts" in found[0].message
    assert findings(mission(height=12), assemble(())) == []


@pytest.mark.parametrize(
    ("polygon", "holes", "says"),
    [
        ("[[0, 0], [9, 9]]", "", "'polygon': a polygon needs at least 3 corners, got 2"),
        ("[[0, 0], [9, 9], [9, 0], [0, 9]]", "", "the edges 1 to 2 and 3 to 4 cross"),
        (CORNERS, "{polygon: [[50, 0], [70, 0], [70, 9]]}", "hole 1 lies outside the fence"),
        (
            CORNERS,
            "{polygon: [[1, 0], [7, 0]]}",
            "item 1: 'polygon': a polygon needs at least 3 corners",
        ),
        (CORNERS, "[[1, 0], [7, 0]]", "'holes', item 1: a polygon needs at least 3 corners, got 2"),
        ("[[0, 0], [9, 9], {lat: 91, lon: 8}]", "", "'lat': must be at least -90"),
        ("[[0, 0], [9, 9], [9, north]]", "", "expected a number (m), got 'north'"),
    ],
)
def test_a_wrong_fence_is_said_once_where_it_stands(polygon, holes, says):
    with pytest.raises(FileError) as refused:
        mission(polygon, holes)
    assert says in str(refused.value)
    assert str(refused.value).count("field.yaml:") == 1


def test_explain_names_the_places():
    text = " ".join(each.text for each in explained(mission(), assemble(())))
    assert "far: 50 m north and 15 m east of the take-off point, 5 m above it (47.39819" in text
    assert "The fence: 4 corners from -5 to 60 m north and -5 to 40 m east, up to 30 m" in text


def test_a_fence_that_no_failsafe_keeps_is_told():
    text = MISSION.format(polygon=CORNERS, holes="", height=5)
    loose = text.replace("when: {not: inside_fence}", "when: {use: link_lost, longer_than: 3}")
    found = findings(parse(loose, "field.yaml", assemble(())), assemble(()))
    assert "unkept-fence" in {it.code for it in found}


def test_a_hole_may_be_its_corners_alone():
    assert mission(holes="[[1, 0], [7, 0], [7, 7]]").fence.holes == (
        Hole(polygon=((1.0, 0.0), (7.0, 0.0), (7.0, 7.0))),
    )


def test_corners_in_degrees():
    north = "{lat: 47.3986416, lon: 8.545594}"
    loaded = mission(polygon=f"[[-5, -5], {north}, [-5, 60]]", holes="")
    np.testing.assert_allclose(loaded.fence.polygon[1], (100.0, 0.0), atol=0.1)
