"""Waypoints, KML, GeoJSON, GPX and WPML as other programs write them."""

from __future__ import annotations

import json

import pytest
from plans import FLAT, imported, mission_of

from missionkit.interchange.bounded_input import ForeignFileError
from missionkit.interchange.kml_writer import archive
from missionkit.interchange.ledger import Outcome
from missionkit.interchange.plan import Home
from missionkit.interchange.plan_fitting import FitOptions

WPL = """QGC WPL 110
0\t1\t0\t16\t0\t0\t0\t0\t47.397700\t8.545600\t488.000000\t1
1\t0\t3\t22\t0\t0\t0\t0\t0\t0\t20\t1
2\t0\t3\t16\t5\t0\t0\t0\t47.398000\t8.545700\t25\t1
3\t0\t10\t16\t0\t0\t0\t0\t47.398200\t8.545700\t25\t1
4\t0\t3\t16\t0\t0\t0\tnan\tbroken
5\t0\t0\t16\t0\t0\t0\tnan\t47.398400\t8.545700\t520\t0
6\t0\t3\t20\t0\t0\t0\t0\t0\t0\t0\t1
"""
KML = """<?xml version="1.0" encoding="UTF-8"?>
<kml xmlns="http://www.opengis.net/kml/2.2"><Document><Folder>
<Placemark><name>west</name><Polygon><outerBoundaryIs><LinearRing><coordinates>
8.5440,47.3975,0 8.5450,47.3975,0 8.5450,47.3982,0 8.5440,47.3982,0 8.5440,47.3975,0
</coordinates></LinearRing></outerBoundaryIs>
<innerBoundaryIs><LinearRing><coordinates>8.5443,47.3977 8.5445,47.3977 8.5445,47.3979
</coordinates></LinearRing></innerBoundaryIs></Polygon></Placemark>
<Placemark><name>east</name><Polygon><outerBoundaryIs><LinearRing><coordinates>
8.5460,47.3975 8.5470,47.3975 8.5470,47.3982</coordinates></LinearRing></outerBoundaryIs>
</Polygon></Placemark>
<Placemark><Point><altitudeMode>absolute</altitudeMode><coordinates>8.5457,47.3980,520
</coordinates></Point></Placemark>
<Placemark><LineString><altitudeMode>relativeToGround</altitudeMode>
<coordinates>8.5457,47.3981,30 8.5459,47.3982,30</coordinates></LineString></Placemark>
<Placemark><name>nothing</name></Placemark>
<NetworkLink><Link><href>file:///etc/passwd</href></Link></NetworkLink>
</Folder></Document></kml>"""
GPX = """<gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1">
<wpt lat="47.398" lon="8.5457"><ele>510</ele><name>mast</name></wpt>
<wpt lat="147.398" lon="8.5457"><ele>510</ele></wpt>
<rte><rtept lat="47.3981" lon="8.5457"><ele>511</ele></rtept>
<rtept lat="47.3982" lon="8.5457"/></rte>
<trk><trkseg><trkpt lat="47.3983" lon="8.5457"><ele>512</ele></trkpt>
<trkpt lat="47.3984" lon="8.5457"><ele>512</ele></trkpt></trkseg></trk></gpx>"""
WAYLINES = """<kml xmlns="http://www.opengis.net/kml/2.2" xmlns:wpml="http://www.dji.com/wpmz/1.0.2">
<Document><wpml:missionConfig><wpml:finishAction>goHome</wpml:finishAction>
<wpml:takeOffSecurityHeight>20</wpml:takeOffSecurityHeight>
<wpml:takeOffRefPoint>47.3977,8.5456,488</wpml:takeOffRefPoint></wpml:missionConfig>
<Folder><wpml:executeHeightMode>MODE</wpml:executeHeightMode>
<wpml:autoFlightSpeed>6</wpml:autoFlightSpeed>
<Placemark><Point><coordinates>8.5457,47.3980</coordinates></Point><wpml:index>0</wpml:index>
<wpml:executeHeight>30</wpml:executeHeight><wpml:waypointSpeed>4</wpml:waypointSpeed>
<wpml:waypointHeadingParam><wpml:waypointHeadingMode>smoothTransition</wpml:waypointHeadingMode>
<wpml:waypointHeadingAngle>-90</wpml:waypointHeadingAngle></wpml:waypointHeadingParam>
<wpml:actionGroup><wpml:action><wpml:actionActuatorFunc>hover</wpml:actionActuatorFunc>
<wpml:actionActuatorFuncParam><wpml:hoverTime>3</wpml:hoverTime></wpml:actionActuatorFuncParam>
</wpml:action><wpml:action><wpml:actionActuatorFunc>gimbalRotate</wpml:actionActuatorFunc>
</wpml:action></wpml:actionGroup></Placemark>
<Placemark><Point><coordinates>8.5459,47.3982</coordinates></Point><wpml:index>1</wpml:index>
<wpml:executeHeight>40</wpml:executeHeight></Placemark></Folder></Document></kml>"""


def places_of(text, state="route-1"):
    return mission_of(text).by_name()[state].state.behavior.plugin.places


def outcomes(ledger):
    return [str(it.outcome)[0] for it in ledger.entries]  # k, a, r


def test_waypoints():
    text, ledger = imported(WPL.encode())
    assert [round(-it.at[2], 3) for it in places_of(text)] == [25.0, 25.0, 32.0]
    assert outcomes(ledger) == ["k", "k", "k", "a", "r", "a", "k"]
    assert "12 columns" in ledger.entries[4].note


def test_waypoints_of_another_version_are_refused():
    with pytest.raises(ForeignFileError, match="QGC WPL 120"):
        imported(WPL.replace("110", "120").encode())


def test_several_polygons_become_several_surveys():
    options = FLAT._replace(height=40.0, spacing=15.0, home=Home(47.3977, 8.5456, 488.0))
    text, ledger = imported(KML.encode(), options)
    surveys = [it for it in mission_of(text).by_name() if it.startswith("survey")]
    assert len(surveys) == 2
    assert outcomes(ledger) == ["a", "k", "k", "a", "r", "r"]
    hole = ledger.entries[0]
    assert hole.unit == "m²"
    assert hole.figure == pytest.approx(0.5 * 15.1 * 22.2, rel=0.02)
    text, ledger = imported(KML.encode(), options, "fence")
    assert "several" in ledger.entries[0].note  # two areas, and a mission has one fence


def test_polygons_without_a_height_say_what_is_missing():
    home = Home(47.3977, 8.5456, 488.0)
    _, ledger = imported(KML.encode(), FitOptions(home=home))
    assert "--height" in ledger.entries[0].note
    assert "--flat-ground" in ledger.entries[3].note


def test_heights_above_the_sea_need_a_home():
    with pytest.raises(ForeignFileError, match="--home"):
        imported(KML.encode(), FLAT)


def test_an_archive_is_read_like_its_document():
    options = FLAT._replace(height=40.0, home=Home(47.3977, 8.5456, 488.0))
    assert (
        imported(archive([("doc.kml", KML.encode())]), options)[0]
        == imported(KML.encode(), options)[0]
    )


def test_gpx():
    text, ledger = imported(GPX.encode(), FLAT._replace(home=Home(47.3977, 8.5456, 488.0)))
    assert [round(-it.at[2], 3) for it in places_of(text)] == [22.0, 23.0, 24.0, 24.0]
    assert outcomes(ledger) == ["k", "r", "k", "r", "k"]


def test_geojson_says_what_its_heights_mean():
    point = {"type": "Point", "coordinates": [8.5457, 47.398, 30]}
    lines = {"type": "MultiLineString", "coordinates": [[[8.5457, 47.398], [8.5458, 47.399]]]}
    rows = [{"type": "Feature", "geometry": it, "properties": None} for it in (point, lines, None)]
    raw = json.dumps({"type": "FeatureCollection", "features": rows}).encode()
    _, ledger = imported(raw, FLAT._replace(height=20.0))
    assert outcomes(ledger) == ["r", "k", "r"]
    assert "--heights" in ledger.entries[0].note
    text, ledger = imported(raw, FLAT._replace(height=20.0, heights="above_home"))
    assert [-it.at[2] for it in places_of(text)] == [30.0, 20.0, 20.0]


def test_waylines():
    raw = archive(
        [("wpmz/waylines.wpml", WAYLINES.replace("MODE", "relativeToStartPoint").encode())]
    )
    text, ledger = imported(raw)
    first, second = places_of(text)
    assert (first.speed or 4.0, first.heading_deg, first.wait) == (4.0, 270.0, 3.0)
    assert (second.speed, -second.at[2]) == (6.0, 40.0)
    assert [it.what for it in ledger.entries if it.outcome is Outcome.REFUSED] == ["gimbalRotate"]
    assert len(ledger.entries) == 7


def test_waylines_above_the_ellipsoid_need_the_geoid():
    waylines = ("wpmz/waylines.wpml", WAYLINES.replace("MODE", "WGS84").encode())
    with pytest.raises(ForeignFileError, match="none of its places"):
        imported(archive([waylines]))
    template = WAYLINES.replace("executeHeight>", "height>").replace("executeHeightMode", "x")
    system = "<wpml:waylineCoordinateSysParam><wpml:heightMode>EGM96</wpml:heightMode>"
    system += "</wpml:waylineCoordinateSysParam>"
    template = template.replace("<Folder>", f"<Folder>{system}")
    above = "<wpml:ellipsoidHeight>77</wpml:ellipsoidHeight><wpml:height>30"
    template = template.replace("<wpml:height>30", above)
    high = waylines[1].replace(b">30<", b">555<").replace(b">40<", b">565<")
    raw = archive([(waylines[0], high), ("wpmz/template.kml", template.encode())])
    first, second = places_of(imported(raw)[0])
    # 47 m of geoid under the ellipsoid's heights, and home's own is one of those
    assert (-first.at[2], -second.at[2]) == (555 - 47 - (488 - 47), 565 - 47 - (488 - 47))
