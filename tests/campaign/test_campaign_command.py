"""`missionkit campaign` and `missionkit report`, from the command line to the files."""

from __future__ import annotations

import csv
import json
import signal
import subprocess
import sys
from html.parser import HTMLParser

import pytest
from campaigns import bombed, hop
from typer.testing import CliRunner

from missionkit import __version__
from missionkit.campaigns.campaign_loop import conduct
from missionkit.campaigns.campaign_plan import found
from missionkit.campaigns.run_journal import JOURNAL_FILE, read
from missionkit.campaigns.run_row import Row
from missionkit.cli.app import app


@pytest.fixture
def call(tmp_path, monkeypatch):
    """Call `missionkit`; whatever goes wrong must not be a traceback."""
    monkeypatch.chdir(tmp_path)
    hop(tmp_path)

    def call(*arguments):
        result = CliRunner().invoke(app, [str(it) for it in arguments])
        assert result.exception is None or isinstance(result.exception, SystemExit)
        return result

    return call


def table(folder):
    with (folder / "runs.csv").open() as stream:
        return list(csv.DictReader(stream))


def test_a_campaign_leaves_table_summary_and_report(call, tmp_path):
    options = ["--runs", 3, "--seed", 4, "--vary", "height=2,3", "--fault", "gnss_drift=0.3@2"]
    result = call("campaign", "hop.yaml", *options)
    assert result.exit_code == 0
    last = result.stderr.splitlines()[-1]
    assert last.startswith("6 of 6, success 100.0 % (61.0 to 100.0), ")
    *lines, page = result.stdout.splitlines()
    assert lines[0] == "height = 2: success 100 %, between 43.9 % and 100 % (3 success)"
    folder = tmp_path / "runs/hop-campaign-seed4"
    assert page == "runs/hop-campaign-seed4/report.html"
    rows = table(folder)
    assert [(it["seed"], it["param:height"]) for it in rows] == [
        (seed, height) for seed in "456" for height in "23"
    ]
    summary = json.loads((folder / "summary.json").read_text())
    high = summary["comparisons"][0]
    assert (high["variant"], high["pairs"]) == ("height = 3", 3)
    assert high["median_changes"]["distance"][0] == pytest.approx(2.0, abs=0.6)
    assert summary["variants"][0]["chain"]["idle"]["ends"] == {"success in land": 1.0}
    assert summary["worst"][0]["command"].startswith(f"missionkit run {tmp_path}/hop.yaml --seed ")


def test_the_report_needs_nothing_beside_itself(call, tmp_path):
    call("campaign", "hop.yaml", "--runs", 2, "--workers", 1, "--set", "height=2.5")
    page = (tmp_path / "runs/hop-campaign-seed0/report.html").read_text()
    open_tags, void = [], {"meta", "br", "line", "circle", "rect", "path", "polygon", "polyline"}

    class Check(HTMLParser):
        def handle_starttag(self, tag, attrs):
            assert tag not in {"script", "link", "img"}
            assert not {"src", "href"} & {name for name, _ in attrs}
            if tag not in void:
                open_tags.append(tag)

        def handle_endtag(self, tag):
            if tag not in void:
                assert open_tags.pop() == tag

    Check().feed(page)
    assert open_tags == []
    assert "100 % of 2 flights succeeded, between 34.2 % and 100 %" in page
    assert f"missionkit run {tmp_path}/hop.yaml --seed 0 --set height=2.5" in page
    assert "idle" in page
    assert "nan" not in page


def test_a_run_that_kills_its_worker_is_a_row_and_not_the_end(call, tmp_path):
    mission, plugin = bombed(tmp_path)
    harm = ["--vary", "how=no,die", "--runs", 2, "--workers", 2]
    result = call("campaign", mission, "--plugin", plugin, *harm)
    assert result.exit_code == 0
    folder = tmp_path / "runs/hop-campaign-seed0"
    assert [it["outcome"] for it in table(folder)] == ["success", "lost"] * 2
    assert "2 runs produced no flight." in (folder / "report.html").read_text()


@pytest.mark.parametrize(
    ("options", "wrong"),
    [
        ([], "name the mission file to fly, or --resume FOLDER"),
        (["hop.yaml", "--vary", "height"], "--vary height: expected NAME=VALUE"),
        (["hop.yaml", "--vary", "hight=1,2"], "hight"),
        (["hop.yaml", "--vary", "height=2,low"], "height"),
        (["hop.yaml", "--fault", "gnss_lsot"], "did you mean 'gnss_lost'?"),
        (["hop.yaml", "--fault", "gnss_lost@idel"], "did you mean 'idle'?"),
        (["hop.yaml", "--fault", "uwb_lost@3"], "a multicopter has no fault 'uwb_lost'"),
        (["hop.yaml", "--require", "0.99", "--better", "0.98"], "below --better"),
        (["hop.yaml", "--require", "1.0"], "below --better"),
        (["--resume", "nowhere"], "not a campaign folder"),
    ],
)
def test_what_makes_no_sense_is_refused_before_anything_is_flown(call, tmp_path, options, wrong):
    result = call("campaign", *options)
    assert result.exit_code == 2
    assert wrong in result.stderr
    assert not (tmp_path / "runs").exists()


def test_a_requirement_ends_the_campaign_and_decides_the_exit_code(call, tmp_path):
    options = ["hop.yaml", "--runs", 60, "--require", 0.3, "--workers", 1]
    met = call("campaign", *options)
    assert met.exit_code == 0
    assert met.stdout.splitlines()[0].endswith("(4 success); required: met")
    refuted = call("campaign", *options, "--fault", "battery_sag=1@4")
    assert refuted.exit_code == 1
    assert "crash); required: not met" in refuted.stdout
    assert len(table(tmp_path / "runs/hop-campaign-seed0-2")) < 20


@pytest.fixture
def whole(call, tmp_path):
    """A campaign that nothing happened to: its folder."""
    call("campaign", "hop.yaml", "--runs", 8, "--out", "whole")
    return tmp_path / "whole/hop-campaign-seed0"


def test_kill_9_and_resume_repeats_no_finished_run_and_loses_none(call, tmp_path):
    call("campaign", "hop.yaml", "--runs", 14, "--out", "whole")
    whole = tmp_path / "whole/hop-campaign-seed0"
    line = [sys.executable, "-m", "missionkit", "campaign", "hop.yaml", "--runs", "14"]
    folder = tmp_path / "runs/hop-campaign-seed0"
    line += ["--workers", "1"]
    with subprocess.Popen(line, cwd=tmp_path, stdout=-1, stderr=-1) as process:
        while len(read(folder)) < 2:
            with pytest.raises(subprocess.TimeoutExpired):  # it has not ended
                process.wait(0.03)
        process.send_signal(signal.SIGKILL)
    before = (folder / JOURNAL_FILE).read_bytes()
    done = before.count(b"\n")
    assert 2 <= done < 14
    assert not (folder / "runs.csv").exists()
    (folder / JOURNAL_FILE).write_bytes(before + b'{"number": 13, "seed"')  # killed while writing
    assert call("campaign", "--resume", folder).exit_code == 0
    after = (folder / JOURNAL_FILE).read_bytes()
    assert after.startswith(before)
    assert after.count(b"\n") == 14
    for name in ("runs.csv", "summary.json"):
        assert (folder / name).read_bytes() == (whole / name).read_bytes()


def test_resuming_flies_only_the_missing_runs(whole):
    rows = (whole / JOURNAL_FILE).read_bytes().splitlines(keepends=True)
    (whole / JOURNAL_FILE).write_bytes(b"".join(rows[:2] + rows[5:]))
    missing = [Row.model_validate_json(line) for line in rows[2:5]]
    asked = []

    def crew(cases):
        for case in cases:
            asked.append(case.number)
            yield next(row for row in missing if row.number == case.number)

    conduct(found(whole), whole, crew, lambda _: None)
    assert sorted(asked) == sorted(row.number for row in missing)
    assert len(read(whole)) == 8


def test_a_campaign_can_be_made_longer_but_not_changed(call, whole, tmp_path):
    assert call("campaign", "--resume", whole, "--runs", 10).exit_code == 0
    assert [it["seed"] for it in table(whole)] == [str(n) for n in range(10)]
    assert "leave out --set" in call("campaign", "--resume", whole, "--set", "height=3").stderr
    mission = tmp_path / "hop.yaml"
    mission.write_text(mission.read_text().replace("2.0", "2.1"))
    assert "have changed since" in call("campaign", "--resume", whole).stderr
    assert call("report", whole).exit_code == 0
    plan = whole / "campaign.json"
    plan.write_text(plan.read_text().replace(__version__, "0.0.9"))
    assert "started with missionkit 0.0.9" in call("campaign", "--resume", whole).stderr


def test_a_report_covers_the_runs_flown_so_far(call, whole):
    rows = (whole / JOURNAL_FILE).read_bytes().splitlines(keepends=True)
    (whole / JOURNAL_FILE).write_bytes(b"".join(rows[:3]))
    summary = json.loads(call("report", whole, "--json").stdout)
    assert summary["runs"] == 3
    (whole / JOURNAL_FILE).unlink()
    assert "no run has finished yet" in call("report", whole).stderr
