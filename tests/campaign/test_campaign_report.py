"""Text and plots of the report page."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
import typer
from campaigns import hop, row
from documents import document, table

from missionkit.campaigns import svg_plots
from missionkit.campaigns.analysis import analysed, worst
from missionkit.campaigns.campaign_plan import Campaign, Rule, digest_of
from missionkit.campaigns.campaign_report import page as page_of
from missionkit.campaigns.number_format import number, percent
from missionkit.campaigns.progress_line import CampaignProgress, line, spell
from missionkit.campaigns.report_chart import drawable
from missionkit.campaigns.statistics import wilson
from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import builtin
from missionkit.cli.app import app

PLAN = Campaign(mission="/m.yaml", name="m<1>", runs=20, digest="0" * 64)


GONE = "the file is gone"


def page(said):
    return page_of(said, [GONE] * len(said.variants))


def shapes(svg, tag):
    # the SVG is ours, made a line above
    return [it.attrib for it in ET.fromstring(svg).iter(f"{{http://www.w3.org/2000/svg}}{tag}")]  # noqa: S314


def mixed(count=20):
    return [
        row(n, "crash", visits=(("idle", 4.0), ("out", 2.0)), reason="hit <it>")
        if n % 5 == 4
        else row(n, metrics={"duration": 9.0 + n, "clearance": 1.0 + 0.1 * n})
        for n in range(count)
    ]


def test_the_page_shows_rate_crashes_and_the_likeliest_failure():
    text = page(analysed(PLAN, mixed()))
    assert "80.0 % of 20 flights succeeded, between 58.4 % and 91.9 %" in text
    assert "4 crashes: 20.0 %, between 8.1 % and 41.6 %." in text
    assert "<b>idle → out → crash in out</b>, 20.0 % of all flights by the chain; 4 of 20" in text
    assert "m&lt;1&gt;" in text
    assert "hit &lt;it&gt;" in text
    assert "<it>" not in text


@pytest.mark.parametrize(
    ("require", "count", "said"),
    [
        (0.5, 20, '<b class="good">met</b>, decided after 13 runs'),
        (0.99, 25, '<b class="bad">not met</b>, decided after 25 runs'),
        (0.75, 20, "<b>not decided</b> after 20 runs; fly more"),
    ],
)
def test_the_page_says_what_became_of_a_requirement(require, count, said):
    plan = PLAN.model_copy(update={"rule": Rule(require=require)})
    assert said in page(analysed(plan, mixed(count)))


def test_a_change_beyond_chance_is_bold():
    plan = PLAN.model_copy(update={"vary": (("height", ("2", "3")),), "runs": 30})
    rows = [
        row(n, seed=n // 2, variant=n % 2, metrics={"duration": 9.0 + (n % 2) + 0.01 * (n // 2)})
        for n in range(60)
    ]
    text = page(analysed(plan, rows))
    assert "<b>+1.0, between 1.0 and 1.0</b>" in text
    assert "Compared with height = 2, seed by seed" in text


def test_the_worst_come_first_and_not_all_for_the_same_reason():
    rows = [
        *(row(n, "crash", metrics={"clearance": -0.1 * n}) for n in range(5)),
        row(5, "ended_safely", reason="time ran out"),
        row(6, "hung", reason="no result"),
        *(row(n, metrics={"clearance": float(n)}) for n in range(7, 20)),
    ]
    assert [it.number for it in worst(rows)] == [4, 3, 2, 6, 5, 7, 8, 9]


def test_a_histogram_shows_every_run_once():
    rng = np.random.default_rng(0)
    drawn = svg_plots.histogram(rng.normal(size=80).tolist(), rng.normal(size=20).tolist(), "n")
    bars = shapes(drawn, "rect")
    tall = {fill: sum(float(b["height"]) for b in bars if b["fill"] == fill)
            for fill in (svg_plots.GOOD, svg_plots.BAD)}  # fmt: skip
    assert tall[svg_plots.GOOD] / tall[svg_plots.BAD] == pytest.approx(4.0, rel=0.01)
    assert shapes(svg_plots.histogram([3.0, 3.0], [], "n"), "rect")[0]["fill"] == svg_plots.GOOD


def test_rates_stand_where_they_belong():
    drawn = svg_plots.rates([("a", wilson(10, 20)), ("b", wilson(20, 20))], goal=0.9)
    a, b = (float(it["cx"]) for it in shapes(drawn, "circle"))
    (goal,) = [float(it["x1"]) for it in shapes(drawn, "line") if "stroke-dasharray" in it]
    assert (goal - a) / (b - a) == pytest.approx(0.8, abs=0.01)


def test_the_running_rate_ends_where_the_campaign_does():
    drawn = svg_plots.running([True, False] * 50)
    (curve,) = shapes(drawn, "polyline")
    assert len(curve["points"].split()) == 100
    assert shapes(svg_plots.running([]), "polygon")[0]["points"] == ""


def test_the_report_is_written_without_a_readable_chart():
    text = page(analysed(PLAN, mixed()))
    assert "The chart is not drawn: the file is gone." in text
    assert "How much of the chart was flown is unknown" in text
    assert drawable(PLAN, analysed(PLAN, [row(0, entries={"idle": 1})]).variants[0]) == (
        "it can no longer be read: /m.yaml:1:1: cannot be read: no such file or directory"
    )
    assert "older missionkit" in drawable(PLAN, analysed(PLAN, mixed()).variants[0])


@pytest.mark.parametrize(
    ("outcomes", "require", "colour"),
    [
        (["success"] * 5, None, svg_plots.GOOD),
        (["success"] * 5, 0.5, svg_plots.FAIR),  # not decided yet
        (["success"] * 4 + ["ended_safely"], None, svg_plots.FAIR),
        (["success"] * 2 + ["ended_safely"] * 3, None, svg_plots.BAD),
        (["success"] * 9 + ["crash"], None, svg_plots.BAD),
    ],
)
def test_the_colour_of_the_page_is_its_alarm(outcomes, require, colour):
    plan = PLAN.model_copy(update={"rule": Rule(require=require)})
    text = page(analysed(plan, [row(n, it) for n, it in enumerate(outcomes)]))
    assert f"border-left: 6px solid {colour}" in text


def test_a_page_has_the_chart_of_each_variant_with_its_own_arrows(tmp_path):
    path = Path(hop(tmp_path))
    mission = load(path, builtin())
    vary = (("height", ("2", "3")),)
    digest = digest_of(mission, path)
    plan = PLAN.model_copy(update={"mission": str(path), "vary": vary, "digest": digest})
    ways = {"idle -> land: when done": 1}
    rows = [
        row(n, variant=n % 2, entries={"idle": 1, "land": 1}, ways=ways if n % 2 else {})
        for n in range(6)
    ]
    said = analysed(plan, rows)
    text = page_of(said, [drawable(plan, variant) for variant in said.variants])
    assert "Every state, transition and failsafe of the chart was flown." in text
    assert "Never flown: 1 of 1 transition; these flights say nothing about them." in text
    assert text.count("<td>idle → land, when done</td>") == 1
    assert '<td class="n">3 visits</td><td class="n">56.1 %</td>' in text
    assert {"v0-pale", "v1-heavy"} <= set(re.findall(r"url\(#([\w-]+)\)", text))
    assert "<td>camera</td><td>none</td>" in text
    path.write_text(path.read_text() + "# changed\n")
    assert drawable(plan, said.variants[0]) == (
        f"{path}: it or a file it uses has changed since the campaign was flown"
    )


def test_progress_is_a_line_now_and_then():
    now, stream = [0.0], StringIO()
    progress = CampaignProgress(stream, lambda: now[0], [row(0)], 100)
    for n in range(1, 31):
        now[0] += 1.0
        progress(row(n, "success" if n % 3 else "crash"))
    progress.finish()
    assert [it.split(",")[0] for it in stream.getvalue().splitlines()] == [
        "11 of 100",
        "21 of 100",
        "31 of 100",
        "31 of 100",
    ]
    assert "1.0 runs/s, 1 min 9 s left" in stream.getvalue()
    assert line(0, 5, 0, 0, 0.0) == "0 of 5, success nan % (0.0 to 100.0), 0.0 runs/s"
    assert [spell(42.4), spell(190), spell(7300)] == ["42 s", "3 min 10 s", "2 h 1 min"]


def test_numbers_are_written_with_their_units():
    assert [percent(x) for x in (0.9642, 1.0, 0.9996)] == ["96.4 %", "100 %", "99.96 %"]
    assert number(0.0712, "position_error") == "7.1"
    assert number(0.01, "yaw_error", sign=True) == "+0.57"
    assert number(-0.0001, "duration", sign=True) == "+0.0"
    assert number(float("nan"), "energy") == "—"


def test_every_option_is_documented():
    documented = {
        option.split()[0]
        for cells in table(document("docs/reference/campaign.md"), "Campaigns")
        for option in cells[0].replace("`", "").split(", ")
    }
    command = typer.main.get_command(app).commands["campaign"]
    options = {name for it in command.params for name in it.opts if name.startswith("--")}
    assert documented == options - {"--help"}
