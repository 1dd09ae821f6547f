"""`missionkit fence`: what the autopilot keeps to is the mission's fence, a little wider."""

import asyncio
import json

import pytest
from samples import HOP
from typer.testing import CliRunner
from vehicle.flying import flying, sitl

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.cli.app import app
from missionkit.cli.autopilot_fence import fence_of
from missionkit.errors import UsageError
from missionkit.geodesy import Origin

FENCE = "{{use: inside_fence, north: [{}, {}], east: [-40, 60], height: {}}}"
INNER, OUTER = FENCE.format(-20, 100, 20), FENCE.format(-30, 90, 30)


def fenced(*guards):
    rows = "".join(
        f"  - {{name: fence{n}, when: {{not: {guard}}}, to: land}}\n"
        for n, guard in enumerate(guards)
    )
    return f"{HOP.rstrip()}\nfailsafes:\n{rows}" if guards else HOP


def asked(tmp_path, monkeypatch, *words, text=None):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    path = tmp_path / "hop.yaml"
    path.write_text(fenced(INNER) if text is None else text)
    return CliRunner().invoke(app, ["fence", words[0], str(path), *words[1:]])


def test_the_box_is_round_all_fences_and_wider():
    mission = parse(fenced(INNER, OUTER), "hop", builtin())
    around = fence_of(mission, 2.0)
    assert around.corners == ((-32.0, -42.0), (102.0, -42.0), (102.0, 62.0), (-32.0, 62.0))
    assert around.height == 32.0


def test_a_mission_without_a_fence_gets_an_example_of_one():
    with pytest.raises(UsageError, match="no failsafe has a fence; add one such as"):
        fence_of(parse(HOP, "hop", builtin()), 5.0)


@pytest.mark.parametrize(
    ("dialect", "height", "said"),
    [
        ("px4", "GF_MAX_VER_DIST", "GF_MAX_VER_DIST is 0, set 25"),
        ("ardupilot", "FENCE_ALT_MAX", "FENCE_ALT_MAX is 100, set 25"),
    ],
)
def test_fence_and_rally_points_reach_the_autopilot(dialect, height, said, tmp_path, monkeypatch):
    with sitl(dialect) as autopilot:
        given = asked(tmp_path, monkeypatch, autopilot.url, "--rally", "10,-5,20")
        assert given.exit_code == 0, given.output
        assert "north  -25 to 105 m" in given.stdout
        assert "rally 1  10 m north, -5 m east, 20 m above home" in given.stdout
        assert said in given.stdout
        assert given_to(autopilot, tmp_path) == (4, 1)
        autopilot.ask(parameter=height, value=24.0)
        assert "height 24 m" in asked(tmp_path, monkeypatch, autopilot.url).stdout


FIELD = """\
origin: {lat: 47.397742, lon: 8.545594, alt: 488}
fence:
  polygon: [[-20, -20], [90, -20], [90, 40], [40, 60], [-20, 40]]
  holes:
    - [[30, 0], [34, 0], [34, 1], [30, 1]]
    - {polygon: [[60, 10], [70, 10], [70, 25], [60, 25]], height: 8}
    - [[-10, 20], [10, 20], [10, 40], [-10, 40]]
  height: 30
"""


def field():
    return f"{fenced('inside_fence').rstrip()}\n{FIELD}"


def test_a_polygon_with_holes_reaches_the_autopilot(tmp_path, monkeypatch):
    with sitl("px4") as autopilot:
        given = asked(tmp_path, monkeypatch, autopilot.url, "--margin", "2", text=field())
        assert given.exit_code == 0, given.output
        assert "5 corners, 1 hole" in given.stdout
        assert "not in it: hole 1, which is too narrow" in given.stdout
        assert "not in it: hole 2, since it may be flown over" in given.stdout
        assert given_to(autopilot, tmp_path) == (9, 0)


def test_a_polygon_is_exported_for_the_ground_station(tmp_path):
    mission, plan = tmp_path / "hop.yaml", tmp_path / "hop.plan"
    mission.write_text(field())
    words = ["fence", str(mission), "--export", str(plan), "--margin", "0", "--rally", "10,-5,20"]
    given = CliRunner().invoke(app, words)
    assert given.exit_code == 0, given.output
    written = json.loads(plan.read_text())
    shapes = written["geoFence"]["polygons"]
    assert [it["inclusion"] for it in shapes] == [True, False, False]
    origin = Origin(47.397742, 8.545594, 488.0)
    corner = origin.local(*shapes[0]["polygon"][3], 488.0)
    assert corner[:2] == pytest.approx((40.0, 60.0), abs=1e-3)
    assert written["rallyPoints"]["points"][0][2] == 20.0


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["hop.yaml"], "usage: missionkit fence ADDRESS MISSION.yaml"),
        (["hop.yaml", "udpin://127.0.0.1:9"], "is not a mission file"),
        (["a", "b", "hop.yaml"], "usage: missionkit fence ADDRESS MISSION.yaml"),
    ],
)
def test_what_is_missing_on_the_command_line_is_said(words, says):
    given = CliRunner().invoke(app, ["fence", *words])
    assert given.exit_code == 2
    assert says in given.output


def test_a_file_needs_an_origin(tmp_path):
    mission = tmp_path / "hop.yaml"
    mission.write_text(fenced(INNER))
    given = CliRunner().invoke(app, ["fence", str(mission), "--export", str(tmp_path / "x.plan")])
    assert given.exit_code == 2
    assert "has no 'origin'" in given.output
    assert not (tmp_path / "x.plan").exists()


def given_to(autopilot, tmp_path):
    """Return how many corners and rally points the autopilot has."""

    async def read():
        async with flying(autopilot, tmp_path) as flight:
            call, link = flight.vehicle.call, flight.vehicle.link
            fence, rally = await call(link.download_fence), await call(link.download_rally)
            return len(fence), len(rally)

    return asyncio.run(read())


def test_an_armed_vehicle_is_left_alone(tmp_path, monkeypatch):
    async def arm(autopilot):
        async with flying(autopilot, tmp_path) as flight:
            await flight.arm()

    with sitl("px4") as autopilot:
        autopilot.ask(parameter="COM_DISARM_PRFLT", value=0.0)
        asyncio.run(arm(autopilot))
        given = asked(tmp_path, monkeypatch, autopilot.url)
        assert given_to(autopilot, tmp_path) == (0, 0)
    assert given.exit_code == 3
    assert "is armed" in given.stderr


@pytest.mark.parametrize("point", ["10,-5", "a,b,c", "1,2,nan", "1,2,3,4", ""])
def test_an_invalid_rally_point_is_refused_before_connecting(point, tmp_path, monkeypatch):
    given = asked(tmp_path, monkeypatch, "udpin://127.0.0.1:9", "--rally", point)
    assert given.exit_code == 2
    assert "NORTH,EAST,HEIGHT" in given.stderr
