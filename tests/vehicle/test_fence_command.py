"""`missionkit fence`: what the autopilot keeps to is the mission's fence, a little wider."""

import asyncio

import pytest
from samples import HOP
from typer.testing import CliRunner
from vehicle.flying import flying, sitl

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.cli.app import app
from missionkit.cli.fence_command import FenceBox, box_of
from missionkit.errors import UsageError

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
    assert box_of(mission, 2.0) == FenceBox((-32.0, 102.0), (-42.0, 62.0), 32.0)


def test_a_mission_without_a_fence_gets_an_example_of_one():
    with pytest.raises(UsageError, match="no failsafe has a fence; add one such as"):
        box_of(parse(HOP, "hop", builtin()), 5.0)


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
