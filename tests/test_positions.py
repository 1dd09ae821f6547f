"""Positions as mission files write them."""

from __future__ import annotations

import pytest
from pydantic import BaseModel, ConfigDict, ValidationError

from missionkit.api.missions import assemble
from missionkit.chart.load import parse
from missionkit.chart.model.validation_problems import plain
from missionkit.errors import FileError
from missionkit.geodesy import Origin
from missionkit.positions import ConversionContext, GroundPosition, Position

ORIGIN = "origin: {lat: 47.397742, lon: 8.545594, alt: 488.0}"
HERE = Origin(47.397742, 8.545594, 488.0)
MISSION = """\
missionkit: 1
mission: places
%s
targets:
  pole: {position: %s}
initial: idle
states:
  idle: {kind: idle, behavior: {use: take_off, height: 5}, transitions: [{to: land, when: done}]}
  land: {kind: land}
"""


class Pattern(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")
    points: tuple[Position, ...]
    corners: tuple[GroundPosition, ...] = ()


def position(written: str, origin: str = ORIGIN) -> tuple[float, float, float]:
    return parse(MISSION % (origin, written), "m.yaml", assemble(())).targets["pole"].position


def refusal(written: str, origin: str = ORIGIN) -> str:
    with pytest.raises(FileError) as refused:
        position(written, origin)
    return str(refused.value)


def test_metres_stay_as_they_are():
    assert position("[1, 2.5, -3]") == (1.0, 2.5, -3.0)
    assert position("[1, 2.5, -3]", "summary: no origin") == (1.0, 2.5, -3.0)


@pytest.mark.parametrize(
    ("height", "down"), [("agl: 3", -3.0), ("above_home: 20", -20.0), ("amsl: 500", -12.0)]
)
def test_degrees_become_metres_of_the_origin(height, down):
    north, east, _ = HERE.local(47.3985, 8.5460, 488.0)
    found = parse(MISSION % (ORIGIN, f"{{lat: 47.3985, lon: 8.5460, {height}}}"), "m", assemble(()))
    assert found.has_amsl == ("amsl" in height)
    written = f"{{lat: 47.3985, lon: 8.5460, {height}}}"
    assert position(written) == pytest.approx((north, east, down), abs=1e-6)


@pytest.mark.parametrize(
    ("written", "says"),
    [
        ("{lat: 91, lon: 8, agl: 5}", "'lat': must be at least -90 and at most 90 deg, got 91"),
        (
            "{lat: 47, lon: 181, agl: 5}",
            "'lon': must be at least -180 and at most 180 deg, got 181",
        ),
        ("{lat: 47, lon: east, agl: 5}", "'lon': expected a number (deg), got 'east'"),
        ("{lat: 47, agl: 5}", "missing key 'lon': a number (deg)"),
        ("{lat: 47.4, lon: 8.5}", "its height is missing: add one of agl, amsl, above_home (m)"),
        ("{lat: 47, lon: 8, alt: 5}", "'alt' does not say what the height is measured from"),
        ("{lat: 47, lon: 8, agl: 5, amsl: 6}", "give one height, not agl and amsl"),
        ("{lat: 47, lon: 8, agl: 5, up: 1}", "unknown key 'up'"),
        ("{lat: 8.5, lon: 47.4, agl: 5}", "it lies 5,664 km from the mission's origin: check"),
        ("[1, x, 3]", "'position', item 2: expected a number (m), got 'x'"),
        (
            "there",
            "expected [north, east, down] (m) or {lat:, lon:, and agl:, amsl: or above_home:}",
        ),
    ],
)
def test_what_is_wrong_is_said(written, says):
    assert says in refusal(written)


def test_degrees_need_an_origin():
    says = refusal("{lat: 47, lon: 8, agl: 5}", "summary: no origin")
    assert "m.yaml:5:20: " in says
    assert "needs the mission's 'origin: {lat:, lon:, alt:}'" in says


def test_a_wrong_origin_is_the_only_thing_said():
    says = refusal("{lat: 47, lon: 8, agl: 5}", "origin: {lat: 120, lon: 8, alt: 0}")
    assert says.count("m.yaml:") == 1
    assert "origin: 'lat': must be at least -90" in says


def test_parameters_of_plugins_take_both_forms():
    data = {
        "points": [[1, 2, -3], {"lat": 47.3985, "lon": 8.546, "above_home": 9}],
        "corners": [{"lat": 47.3985, "lon": 8.546}, [4, 5]],
    }
    made = plain(Pattern, data, ConversionContext(HERE))
    north, east, _ = HERE.local(47.3985, 8.546, 488.0)
    north, east = round(float(north), 6), round(float(east), 6)
    assert made.points == ((1.0, 2.0, -3.0), (north, east, -9.0))
    assert made.corners == ((north, east), (4.0, 5.0))
    with pytest.raises(ValidationError, match="'lon': expected a number"):
        plain(Pattern, {"points": [{"lat": 47, "lon": "east", "agl": 1}]}, ConversionContext(HERE))


def test_corners_of_the_map_take_degrees():
    corner = "{lat: 47.397802, lon: 8.545594}"
    section = f"map: {{north: [-20, 20], east: [-20, 20], polygons: [[[1, 0], [1, 9], {corner}]]}}"
    mission = parse(MISSION % (f"{ORIGIN}\n{section}", "[1, 2, -3]"), "m.yaml", assemble(()))
    assert mission.map is not None
    assert mission.map.polygons[0][2] == pytest.approx((6.671, 0.0), abs=1e-3)
