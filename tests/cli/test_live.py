from __future__ import annotations

import io
from dataclasses import replace

import numpy as np
import pytest
from rich.console import Console

from missionkit.cli.live import LineView, PageView, live_view, status_line, transition_line
from missionkit.cli.live_page import bar, page
from missionkit.geometry import IDENTITY, vec
from missionkit.messages import (
    Battery,
    Command,
    Cycle,
    Estimate,
    Fired,
    Health,
    Mode,
    Record,
    Target,
    Verdict,
)

SURE = ("marker-sure", Verdict.at_least(0.8, 0.7))
UNSURE = ("marker-sure", Verdict.unknown("no frame for 0.4 s"))
LOCKED = Fired("gps", "visual", "when marker-sure", (SURE,), ("mode visual",))


def tick(now=0.0, state="gps", fired=None, problems=(), verdicts=(), cycle=0.004, seen_at=None):
    seen = Estimate(
        now=now,
        position=vec(12.34, -5.67, -6.0),
        velocity=vec(3.0, 4.0, 0.0),
        attitude=IDENTITY,
        rates=vec(0.0, 0.0, 0.0),
        health=Health(True, False, now, None, 0.4, 0),
        battery=Battery(now, 0.81, 15.0),
        targets={"trunk": Target("trunk", vec(12.34, -5.67, -2.0), 0.3, None, None, seen_at)},
    )
    timing = Cycle(sense=cycle, overruns=2)
    note = "on the way"
    return Record(now, state, Mode.GPS, verdicts, fired, Command(), note, problems, seen, timing)


def shown(record, history=(), width=120):
    console = Console(record=True, width=width, file=io.StringIO())
    console.print(page(record, history, "precision-task"))
    return console.export_text()


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_lines_are_exactly_these():
    out = io.StringIO()
    trouble = ("gps: height is not kept",)
    with LineView(out) as view:
        for k in range(241):
            now = 0.05 * k
            fired = LOCKED if k == 150 else None
            view.update(tick(now, "visual" if k >= 150 else "gps", fired, trouble * (k > 200)))
    assert out.getvalue().splitlines() == [
        "    0.0 s  gps: 12.3 m north, -5.7 m east, 6.0 m high, 5.0 m/s, battery 81 %",
        "    5.0 s  gps: 12.3 m north, -5.7 m east, 6.0 m high, 5.0 m/s, battery 81 %",
        "    7.5 s  gps -> visual: when marker-sure (marker-sure 0.8 against 0.7)",
        "   10.0 s  visual: 12.3 m north, -5.7 m east, 6.0 m high, 5.0 m/s, battery 81 %",
        "   10.1 s  problem: gps: height is not kept",
    ]


def test_a_guard_without_numbers_is_left_out_of_the_line():
    fired = LOCKED._replace(verdicts=(UNSURE,))
    assert transition_line(7.5, fired) == "    7.5 s  gps -> visual: when marker-sure"


def test_a_vehicle_on_the_ground_is_not_minus_zero_high():
    record = tick()
    ground = replace(record.estimate, position=vec(0.0, 0.0, 0.0))
    assert ": 0.0 m north, 0.0 m east, 0.0 m high" in status_line(record._replace(estimate=ground))


def test_the_page_says_where_the_chart_and_the_vehicle_are():
    text = shown(tick(9.5, "visual", verdicts=(SURE, UNSURE)), [(7.5, LOCKED)])
    for part in (
        "precision-task",
        "visual for 2.0 s",
        "before: gps",
        "on the way",
        "height   6.00 m",
        "speed  5.00 m/s",
        "battery 81 %",
        "trunk 4.00 m ± 0.30 m, not seen yet",
        "cycle 4.0 of 50 ms",
        "2 overruns",
        "gps → visual  when marker-sure",
    ):
        assert part in text, text
    sure = next(line for line in text.splitlines() if "0.8" in line)
    assert sure.split()[1:6] == ["●", "marker-sure", "0.8", "0.7", "0.1"]
    assert "no frame for 0.4 s" in next(line for line in text.splitlines() if "?" in line)


def test_a_target_says_how_long_ago_it_was_seen():
    assert "trunk 4.00 m ± 0.30 m, 1.5 s ago" in shown(tick(9.5, seen_at=8.0))


def test_problems_and_only_the_last_transitions_are_on_the_page():
    history = [(float(k), LOCKED._replace(reason=f"reason {k}")) for k in range(9)]
    text = shown(tick(9.0, problems=("gps: height is not kept",)), history)
    assert "! gps: height is not kept" in text
    assert "reason 8" in text
    assert "reason 3" not in text


@pytest.mark.parametrize(
    ("value", "threshold", "drawn"),
    [
        (0.0, 2.0, "──────┃──────"),
        (1.0, 2.0, "━━━───┃──────"),
        (2.0, 2.0, "━━━━━━┃──────"),
        (9.0, 2.0, "━━━━━━┃━━━━━━"),
        (-1.0, -2.0, "━━━━━━┃━━━───"),
        (-4.0, -2.0, "──────┃──────"),
        (0.5, 0.0, "━━━━━━┃━━━───"),
        (-1.0, 0.0, "──────┃──────"),
        (float("inf"), 1.0, "━━━━━━┃━━━━━━"),
    ],
)
def test_a_bar_fills_past_the_middle_once_the_value_exceeds_the_threshold(value, threshold, drawn):
    assert bar(Verdict(np.True_, value=value, threshold=threshold)).plain == drawn


def test_a_guard_without_numbers_has_no_bar():
    assert bar(Verdict.unknown("why")).plain == ""


def test_the_page_is_drawn_ten_times_a_second_and_once_at_the_end(monkeypatch):
    out, wall, drawn = Terminal(), [0.0], []
    console = Console(file=out, force_terminal=True, width=100)
    with PageView(console, lambda: wall[0], "m") as view:
        monkeypatch.setattr(view._live, "update", lambda shown, refresh: drawn.append(wall[0]))
        for k in range(100):
            wall[0] = 0.01 * k
            view.update(tick(0.05 * k))
    assert len(drawn) == 11
    assert min(np.diff(drawn[:-1])) >= 0.1 - 1e-9


def test_the_view_suits_where_it_is_shown(monkeypatch):
    monkeypatch.setenv("TERM", "xterm-256color")
    assert isinstance(live_view(io.StringIO(), lambda: 0.0), LineView)
    assert isinstance(live_view(Terminal(), lambda: 0.0), PageView)


@pytest.mark.parametrize(("no_color", "colours"), [("1", False), (None, True)])
def test_no_color_is_respected(monkeypatch, no_color, colours):
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.delenv("NO_COLOR", raising=False)
    if no_color is not None:
        monkeypatch.setenv("NO_COLOR", no_color)
    out = Terminal()
    with live_view(out, lambda: 0.0) as view:
        view.update(tick(verdicts=(SURE,)))
    assert ("\x1b[32m" in out.getvalue()) is colours
