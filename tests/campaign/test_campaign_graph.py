"""`missionkit graph --campaign`: the flights of a folder over the chart of a mission."""

from __future__ import annotations

import json
import re

import pytest
from campaigns import bombed, hop
from typer.testing import CliRunner

from missionkit.campaigns.run_journal import JOURNAL_FILE
from missionkit.cli.app import app

FOLDER = "runs/hop-campaign-seed0"


def call(*arguments):
    result = CliRunner().invoke(app, arguments)
    assert result.exception is None or isinstance(result.exception, SystemExit)
    return result


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    return tmp_path_factory.mktemp("graph")


@pytest.fixture(scope="module")
def flown(home):
    """Two variants, two flights each."""
    vary = ("--vary", "height=2,3", "--runs", "2", "--workers", "1")
    result = call("campaign", hop(home), *vary, "--out", str(home / "runs"))
    assert result.exit_code == 0
    return home / FOLDER


@pytest.fixture(autouse=True)
def _inside(home, flown, monkeypatch):
    monkeypatch.chdir(home)
    hop(home)


def test_the_flights_of_a_campaign_are_drawn():
    assert call("graph", "hop.yaml", "--campaign", FOLDER, "--out", "hop.svg").exit_code == 0
    with open("hop.svg", encoding="utf-8") as drawn:  # noqa: PTH123
        words = re.findall(r">([^<]+)</text>", drawn.read())
    assert {"2 times, 100 %", "2 flights, 100 %", "2 simulated flights, height = 2."} <= set(words)


def test_set_chooses_the_variant():
    chosen = call("graph", "hop.yaml", "--campaign", FOLDER, "--set", "height=3").stdout
    first = call("graph", "hop.yaml", "--campaign", FOLDER).stdout
    assert "s0_idle --> s1_land : done#59; 2 times, 100 %" in first
    seconds = [re.search(r"s0_idle : (\S+) s a visit", it)[1] for it in (first, chosen)]
    assert float(seconds[0]) < float(seconds[1])  # 3 m take longer than 2 m


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--campaign", "nowhere"], "nowhere: holds no campaign.json: not a campaign folder"),
        (["--campaign", FOLDER, "--set", "height=9"], "it was flown with: height = 2; height = 3"),
        (["--campaign", FOLDER, "--set", "heigth=2"], "not flown with heigth = 2"),
    ],
)
def test_misfits_are_reported(arguments, said):
    result = call("graph", "hop.yaml", *arguments)
    assert result.exit_code == 2
    assert said in result.stderr


@pytest.mark.parametrize("change", [("2.0}", "2.5}"), ("height: 2.0", "other: 2.0")])
def test_flights_of_another_chart_are_not_drawn_over_this_one(home, change):
    text = (home / "hop.yaml").read_text().replace(*change).replace("$height", "2.0")
    (home / "hop.yaml").write_text(text)
    result = call("graph", "hop.yaml", "--campaign", FOLDER)
    assert result.exit_code == 2
    assert "another mission, or it or a file it uses has changed since" in result.stderr


def test_a_plug_in_of_the_campaign_is_found_and_must_be_the_same(home):
    mission, plugin = bombed(home)
    one = ("--runs", "1", "--workers", "1", "--out", str(home / "bombed"))
    assert call("campaign", mission, "--plugin", plugin, *one).exit_code == 0
    folder = next((home / "bombed").iterdir())
    assert "1 time, 100 %" in call("graph", mission, "--campaign", str(folder)).stdout
    with open(plugin, "a", encoding="utf-8") as text:  # noqa: PTH123
        text.write("# changed\n")
    assert call("graph", mission, "--campaign", str(folder)).exit_code == 2


def test_a_journal_that_kept_too_little_is_refused(home, flown):
    old = home / "old"
    old.mkdir(exist_ok=True)
    for name in ("campaign.json", "mission.yaml"):
        (old / name).write_bytes((flown / name).read_bytes())
    rows = [json.loads(line) for line in (flown / JOURNAL_FILE).read_text().splitlines()]
    older = [{key: it[key] for key in it if key not in {"ways", "entries"}} for it in rows]
    (old / JOURNAL_FILE).write_text("".join(f"{json.dumps(it)}\n" for it in older))
    result = call("graph", "hop.yaml", "--campaign", "old")
    assert result.exit_code == 2
    assert "flown by an older missionkit that recorded too little; fly it again" in result.stderr
    (old / JOURNAL_FILE).write_text("")
    assert (
        "no run has produced a flight yet" in call("graph", "hop.yaml", "--campaign", "old").stderr
    )
