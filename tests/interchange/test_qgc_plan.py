"""Plans of QGroundControl: every item right or refused, and the counts add up."""

from __future__ import annotations

import math

import pytest
from plans import FLAT, HOME, imported, item, mission_of, qgc, survey_item, way

from missionkit.cli.import_command import ImportOptions, import_file
from missionkit.errors import UsageError
from missionkit.interchange.ledger import Outcome
from missionkit.interchange.plan_fitting import FitOptions

UP = item(22, 0, 0, 0, None, HOME.lat, HOME.lon, 20)
RTL = item(20, frame=2)


def entry(ledger, number):
    return ledger.entries[number - 1]


def places_of(text):
    return mission_of(text).by_name()["route-1"].state.behavior.plugin.places


def test_altitudes_of_each_frame_mean_what_they_say():
    text, ledger = imported(
        qgc(
            [UP, way(47.398, 8.5456, 25), way(47.3985, 8.5456, 520, 0), way(47.399, 8.5456, 30, 10)]
        )
    )
    downs = [it.at[2] for it in places_of(text)]
    assert downs == pytest.approx([-25.0, 488.0 - 520.0, -30.0])
    assert entry(ledger, 4).outcome is Outcome.APPROXIMATED
    assert ledger.counts() == {"kept": 3, "approximated": 1, "refused": 0}


def test_terrain_that_is_not_known_is_refused():
    raw = qgc([UP, way(47.399, 8.5456, 30, 10), way(47.398, 8.5456, 25), RTL])
    _, ledger = imported(raw, FitOptions())
    assert entry(ledger, 2).outcome is Outcome.REFUSED
    assert "--flat-ground" in entry(ledger, 2).note


def test_terrain_that_the_plan_knows_is_flown_at_its_own_height():
    text, ledger = imported(
        qgc([UP, way(47.399, 8.5456, 30, 10, AMSLAltAboveTerrain=540.5)]), FitOptions()
    )
    assert places_of(text)[0].at[2] == pytest.approx(488.0 - 540.5)
    assert entry(ledger, 2).figure == 0.0


@pytest.mark.parametrize(
    ("wrong", "why"),
    [
        (way(math.nan, 8.5456, 30), "no latitude"),
        (way(47.399, 8.5456, None), "height is not a number"),
        (way(0, 0, 30), "no latitude"),
        (way(91.0, 8.0, 30), "not a place"),
        (way(47.399, 8.5456, 30, 1), "MAV_FRAME 1"),
        (way(40.0, 8.0, 30), "km from home"),
        (way(47.399, 8.5456, -3), "above home"),
        (way(47.399, 8.5456, 1e9), "1,000,000,000 m above home: at most 10,000 m"),
        (item(177, 1, -1), "jump"),
        (item(31_014), "31014"),
        (item(93, -1, 12, 0, 0), "time of day"),
        ({"type": "SimpleItem"}, "neither"),
        ("nonsense", "neither"),
        (item(22, 0, 0, 0, None, 0, 0, 20), "second take-off"),
    ],
)
def test_what_cannot_be_flown_is_refused_with_its_reason(wrong, why):
    text, ledger = imported(qgc([UP, wrong, way(47.398, 8.5456, 25), RTL]))
    assert entry(ledger, 2).outcome is Outcome.REFUSED
    assert why in entry(ledger, 2).note
    assert len(places_of(text)) == 1
    assert ledger.counts() == {"kept": 3, "approximated": 0, "refused": 1}


def test_a_heading_that_is_not_given_stays_free():
    # null is what QGroundControl writes for NaN; ArduPilot's plans have 0
    raw = qgc([UP, way(47.398, 8.5456, 25), item(16, 0, 0, 0, 0, 47.3985, 8.5456, 25)])
    assert [it.heading_deg for it in places_of(imported(raw)[0])] == [None, 0.0]
    raw = qgc([UP, item(16, 0, 0, 0, 0, 47.3985, 8.5456, 25)], firmwareType=3)
    assert [it.heading_deg for it in places_of(imported(raw)[0])] == [None]
    raw = raw.replace(b"null", b"NaN")
    assert [it.heading_deg for it in places_of(imported(raw)[0])] == [None]


def test_speed_delay_look_and_photograph_belong_to_their_places():
    items = [
        *(UP, way(47.398, 8.5456, 25), item(178, 1, 3.5, -1, frame=2)),
        item(195, 0, 0, 0, 0, 47.3984, 8.5460, 4),
        *(way(47.3985, 8.5456, 25), item(93, 7, frame=2), item(2000, 0, 0, 1, frame=2)),
        *(item(197, frame=2), way(47.399, 8.5456, 25), RTL),
    ]
    text, ledger = imported(qgc(items))
    first, second, third = places_of(text)
    assert (first.wait, second.wait, third.wait) == (0.0, 7.0, 0.0)
    assert (first.look_at, second.look_at, third.look_at) == (None, "look-1", None)
    assert (second.payload, second.speed, third.speed) == ("camera", 3.5, 3.5)
    assert ledger.counts() == {"kept": 9, "approximated": 1, "refused": 0}


def test_items_after_the_landing_are_refused():
    _, ledger = imported(qgc([UP, way(47.398, 8.5456, 25), RTL, way(47.399, 8.5456, 25)]))
    assert entry(ledger, 4).note == "it comes after the landing"


def test_a_survey_is_compared_with_the_lines_that_the_plan_holds():
    _, unexpanded = imported(qgc([UP, survey_item(), RTL]))
    assert (entry(unexpanded, 2).figure, entry(unexpanded, 2).unit) == (6.0, "m")  # half a line
    beside = [[47.3975, 8.544], [47.3975, 8.5451]]
    _, expanded = imported(qgc([UP, survey_item(VisualTransectPoints=beside), RTL]))
    assert entry(expanded, 2).figure == pytest.approx(12.3, abs=0.1)  # of its place at a corner
    broken = survey_item(Items=[{"command": 16}, {"command": 16, "params": 3}, None])
    assert imported(qgc([UP, broken, RTL]))[1].counts()["approximated"] == 1
    _, crossed = imported(qgc([UP, survey_item(Refly90Degrees=True), RTL]))
    assert crossed.counts()["refused"] == 0


def test_surveys_that_say_too_little_are_refused():
    bare = survey_item(CameraCalc={"DistanceToSurface": 30})
    crossing = {
        **survey_item(),
        "polygon": [[47.3, 8.5], [47.31, 8.51], [47.3, 8.51], [47.31, 8.5]],
    }
    crossing["polygon"] = [[a + 0.0977, b + 0.0456] for a, b in crossing["polygon"]]
    follows = survey_item(FollowTerrain=True)
    raw = qgc([UP, bare, crossing, follows, {"type": "ComplexItem"}, way(47.398, 8.5456, 25), RTL])
    _, ledger = imported(raw, FitOptions())
    notes = [it.note for it in ledger.entries if it.outcome is Outcome.REFUSED]
    for note, word in zip(notes, ("apart", "cross", "terrain", "nothing like"), strict=True):
        assert word in note


def test_a_corridor_and_a_structure_become_what_they_are():
    camera = {"AdjustedFootprintSide": 20, "DistanceToSurface": 25}
    corridor = {
        "type": "ComplexItem",
        "complexItemType": "CorridorScan",
        "CorridorWidth": 40,
        "polyline": [[47.398, 8.5456], [47.399, 8.5456]],
        "TransectStyleComplexItem": {"CameraCalc": camera},
    }
    structure = {
        "type": "ComplexItem",
        "complexItemType": "StructureScan",
        "StructureHeight": 20,
        "Layers": 2,
        "ScanBottomAlt": 5,
        "CameraCalc": {"DistanceToSurface": 10},
        "polygon": [[47.398, 8.546], [47.3982, 8.546], [47.3982, 8.5463], [47.398, 8.5463]],
    }
    text, ledger = imported(qgc([UP, corridor, structure, RTL]))
    states = mission_of(text).by_name()
    assert states["corridor-1"].state.behavior.plugin.breadth == 40.0
    round_it = states["route-1"].state.behavior.plugin.places
    assert len(round_it) == 10
    assert {round(-it.at[2], 3) for it in round_it} == {10.0, 20.0}
    assert ledger.counts() == {"kept": 2, "approximated": 2, "refused": 0}


def test_circles_of_the_fence_stay_on_the_safe_side():
    circle = {"circle": {"center": [HOME.lat, HOME.lon], "radius": 200}, "inclusion": True}
    hole = {"circle": {"center": [47.3985, 8.5456], "radius": 20}, "inclusion": False}
    text, ledger = imported(
        qgc([UP, way(47.398, 8.5458, 25)], {"circles": [circle, hole], "polygons": []})
    )
    fence = mission_of(text).fence
    reach = [math.hypot(*corner) for corner in fence.outline()]
    assert max(reach) <= 200.02  # home lies 488 m up
    north = (47.3985 - HOME.lat) * 111_194
    kept = [math.dist(corner, (north, 0.0)) for corner in fence.holes[0].polygon]
    assert min(kept) * math.cos(math.pi / len(kept)) > 19.9
    assert [it.unit for it in ledger.entries[2:]] == ["m", "m"]


def test_fences_that_a_mission_cannot_keep_are_refused():
    square = [[47.39, 8.53], [47.41, 8.53], [47.41, 8.56], [47.39, 8.56]]
    far = [[-47.5, 8.53], [-47.51, 8.53], [-47.51, 8.56]]
    polygons = [{"inclusion": True, "polygon": square}, {"inclusion": False, "polygon": far}]
    _, ledger = imported(qgc([UP, way(47.398, 8.5458, 25)], {"polygons": polygons}))
    assert [it.outcome for it in ledger.entries[2:]] == [Outcome.KEPT, Outcome.REFUSED]
    twice = [{"inclusion": True, "polygon": square}] * 2
    text, ledger = imported(qgc([UP, way(47.398, 8.5458, 25)], {"polygons": twice}))
    assert mission_of(text).fence is None
    assert "several" in ledger.entries[-1].note


def test_a_fence_that_is_refused_leaves_its_holes():
    far = [[48.3, 8.53], [48.31, 8.53], [48.31, 8.56]]
    hole = [[47.3985, 8.545], [47.3986, 8.545], [47.3986, 8.5452]]
    polygons = [{"inclusion": True, "polygon": far}, {"inclusion": False, "polygon": hole}]
    text, ledger = imported(qgc([UP, way(47.398, 8.5458, 25)], {"polygons": polygons}))
    fence = mission_of(text).fence
    assert max(math.hypot(*corner) for corner in fence.outline()) < 2_000.0
    assert len(fence.holes) == 1
    assert [it.outcome for it in ledger.entries[2:]] == [Outcome.REFUSED, Outcome.KEPT]


def test_an_item_outside_the_fence_of_its_own_plan_is_refused():
    square = [[47.397, 8.54], [47.399, 8.54], [47.399, 8.55], [47.397, 8.55]]
    fence = {"polygons": [{"inclusion": True, "polygon": square}]}
    _, ledger = imported(qgc([UP, way(47.398, 8.5458, 25), way(47.41, 8.5458, 25)], fence))
    assert "outside the fence" in entry(ledger, 3).note


def test_rally_points_and_home_are_kept():
    text, ledger = imported(qgc([UP, way(47.398, 8.5458, 25)], rally=[[47.398, 8.545, 15], [1]]))
    mission = mission_of(text)
    assert mission.origin.alt == 488.0
    assert mission.targets["rally-1"].position[2] == -15.0
    assert ledger.counts()["refused"] == 1


def test_without_home_and_above_sea_level_it_says_what_is_missing():
    raw = qgc([way(47.398, 8.5458, 25)], plannedHomePosition=None)
    _, ledger = imported(raw, FLAT)
    assert any("--home" in it for it in ledger.added)


@pytest.mark.parametrize(
    "home", [[91.0, 8.5, 488.0], [47.4, 8.5], "here", [0, 0, 0], [47.4, 8.5, 1e400]]
)
def test_a_home_that_is_none_has_its_line_in_the_ledger(home):
    _, ledger = imported(qgc([UP, way(47.398, 8.5458, 25), RTL], plannedHomePosition=home), FLAT)
    (refused,) = (it for it in ledger.entries if it.outcome is Outcome.REFUSED)
    assert refused.item == "plannedHomePosition"
    assert "not [latitude, longitude, altitude]" in refused.note
    assert any("home, at the first place" in it for it in ledger.added)


def test_a_file_that_cannot_be_read_at_all_gets_no_ledger(tmp_path, capsys):
    file = tmp_path / "broken.plan"
    file.write_text('{"fileType": "Plan", "mission": []}')
    options = ImportOptions(file, None, None, None, None, None, "survey", False, False, False)
    with pytest.raises(UsageError, match="'mission' is not a mapping"):
        import_file(options)
    assert capsys.readouterr().err == ""
