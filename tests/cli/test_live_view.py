from __future__ import annotations

import io

import numpy as np
import pytest
from rich.console import Console

from missionkit.cli.live_page import bar, page
from missionkit.cli.live_view import (
    LineView,
    PageView,
    live_view,
    status_line,
    transition_line,
)
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
from missionkit.recorder.problem_log import Noted

SURE = ("marker-sure", Verdict.at_least(0.8, 0.7))
UNSURE = ("marker-sure", Verdict.unknown("no frame for 0.4 s"))
LOCKED = Fired("gps", "visual", "when marker-sure", (SURE,), ("mode visual",))


def tick(
    now=0.0,
    state="gps",
    fired=(),
    problems=(),
    verdicts=(),
    cycle=0.004,
    seen_at=None,
    entered_at=0.0,
):
    seen = Estimate(
        now=now,
        position=vec(12.34, -5.67, -6.0),
        velocity=vec(3.0, 4.0, 0.0),
        attitude=IDENTITY,
        rates=vec(0.0, 0.0, 0.0),
        health=Health(True, False, now, None, 0.4, 0),
        battery=Battery(now, 0.81, 15.0),
        targets={"trunk": Target("trunk", vec(12.34, -5.67, -2.0), 0.3, None, None, seen_at)},
        entered_at=entered_at,
    )
    timing = Cycle(sense=cycle, overruns=2)
    note = "nearing"
    flown = Record(now, state, (state,), Mode.GPS, verdicts, fired, Command(), note, problems, seen)
    return flown._replace(cycle=timing)


def shown(record, events=(), width=120, height=40):
    console = Console(record=True, width=width, file=io.StringIO())
    console.print(page(record, events, "precision-task", width=width, height=height))
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
            fired = (LOCKED,) if k == 150 else ()
            view.update(tick(now, "visual" if k >= 150 else "gps", fired, trouble * (k > 200)))
    assert out.getvalue().splitlines() == [
        "    0.0 s  gps (nearing): 12.3 m north, -5.7 m east, 6.0 m high, 5.0 m/s, battery 81 %",
        "    5.0 s  gps (nearing): 12.3 m north, -5.7 m east, 6.0 m high, 5.0 m/s, battery 81 %",
        "    7.5 s  gps -> visual: when marker-sure (marker-sure 0.8, limit 0.7)",
        "   10.0 s  visual (nearing): 12.3 m north, -5.7 m east, 6.0 m high, 5.0 m/s, battery 81 %",
        "   10.1 s  problem: gps: height is not kept",
    ]


LOGGED = LOCKED._replace(outputs=("mode visual", "log marker found", "raise go", "log \x1b[2J"))


@pytest.mark.parametrize("logs_only", [False, True])
def test_logs_of_a_mission_are_listed_below_their_transition(logs_only):
    out = io.StringIO()
    LineView(out, logs_only=logs_only).update(tick(7.5, fired=(LOGGED,), problems=("drifting",)))
    lines = out.getvalue().splitlines()
    logged = ["    7.5 s  log: marker found", "    7.5 s  log: \ufffd[2J"]
    assert lines[-len(logged) :] == logged if logs_only else lines[1:3] == logged
    assert len(lines) == (2 if logs_only else 5)


def test_the_page_shows_what_a_mission_logs_among_the_last_events():
    events = [(float(k), LOCKED._replace(reason=f"reason {k}")) for k in range(9)]
    text = shown(tick(9.0), [*events, (9.0, LOGGED)])
    assert "9.0 s log: marker found" in text
    assert "9.0 s log: \ufffd[2J" in text
    assert "reason 7" in text
    assert "reason 6" not in text


def test_a_closed_reader_does_not_end_the_flight():
    class Gone(io.StringIO):
        def write(self, _):
            raise BrokenPipeError

    with LineView(Gone()) as view:
        view.update(tick(0.0, fired=(LOCKED,)))


def test_a_guard_without_numbers_is_left_out_of_the_line():
    fired = LOCKED._replace(verdicts=(UNSURE,))
    assert transition_line(7.5, fired) == "    7.5 s  gps -> visual: when marker-sure"


def test_a_vehicle_on_the_ground_is_not_minus_zero_high():
    record = tick()
    ground = record.estimate._replace(position=vec(0.0, 0.0, 0.0))
    assert ": 0.0 m north, 0.0 m east, 0.0 m high" in status_line(record._replace(estimate=ground))


def test_a_free_flyer_is_in_the_mother_ships_frame():
    record = tick()
    out = Terminal()
    place = record.estimate._replace(position=vec(0.125, 1.0, -0.3), velocity=vec(0.0139, 0.0, 0.0))
    record = record._replace(estimate=place)
    line = status_line(record, over_ground=False)
    assert "x 0.125 m, y 1.000 m, z -0.300 m, 13.9 mm/s" in line
    with live_view(out, lambda: 0.0, over_ground=False) as view:
        view.update(record)
    assert "z -0.300 m" in out.getvalue()
    assert "height" not in out.getvalue()


def test_the_page_says_where_the_chart_and_the_vehicle_are():
    record = tick(9.5, "visual", verdicts=(SURE, UNSURE), entered_at=7.5)
    text = shown(record, [(7.5, LOCKED)])
    for part in (
        "precision-task",
        "visual (nearing) for 2.0 s",
        " 12.34 N   -5.67 E",
        "height  6.00 m",
        "speed  5.0 m/s",
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


def test_problems_stand_among_the_last_transitions():
    events = [(float(k), LOCKED._replace(reason=f"reason {k}")) for k in range(9)]
    text = shown(tick(9.0), [*events, (9.0, Noted(9.0, "gps: height is not kept", 9.0))])
    assert "9.0 s ! gps: height is not kept" in text
    assert "reason 8" in text
    assert "reason 4" not in text


@pytest.mark.parametrize(("width", "height"), [(80, 24), (120, 40), (60, 16)])
def test_the_page_fits_the_terminal_and_keeps_the_numbers(width, height):
    many = tuple((f"guard {k} of many with long names (radius 9)", SURE[1]) for k in range(30))
    events = [(float(k), LOCKED._replace(reason="because " * 30)) for k in range(9)]
    lines = shown(tick(9.0, verdicts=many), events, width, height).splitlines()
    assert len(lines) < height
    assert max(map(len, lines)) == width - len("^C")
    guards = [line for line in lines if "guard " in line and "value" not in line]
    assert len(guards) >= 5
    assert all(line.split("guard")[1].count("0.") >= 2 for line in guards)
    assert any("gps → visual" in line for line in lines)


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


def test_a_lasting_problem_is_reported_once(monkeypatch):
    out, wall = Terminal(), [0.0]
    console = Console(file=out, force_terminal=True, width=100)
    with PageView(console, lambda: wall[0], "m") as view:
        for k in range(10):
            wall[0] += 0.01
            view.update(tick(0.05 * k, problems=("drifting",) * (2 < k < 7)))
    assert out.getvalue().rpartition("gps")[2].count("drifting") == 1


def late(k):
    """A problem with a new figure at every tick, three times for 0.2 s."""
    return (f"state 'low': pad was last seen {0.5 + 0.05 * (k % 10):.2f} s ago",) * (k % 10 > 5)


def test_a_problem_repeated_with_other_numbers_is_one_line_with_a_count():
    out = io.StringIO()
    with LineView(out) as view:
        for k in range(30):
            view.update(tick(0.05 * k, problems=late(k)))
    assert [line for line in out.getvalue().splitlines() if "problem" in line] == [
        "    0.3 s  problem: state 'low': pad was last seen 0.80 s ago",
        "    1.5 s  problem, 3 times so far: state 'low': pad was last seen 0.80 s ago",
    ]


def test_the_page_counts_a_problem_that_comes_again():
    out = Terminal()
    with PageView(Console(file=out, force_terminal=True, width=100), lambda: 0.0, "m") as view:
        for k in range(30):
            view.update(tick(0.05 * k, problems=late(k)))
    last = out.getvalue().rpartition("battery")[2]
    assert last.count("pad was last seen") == 1
    assert "0.80 s ago (3 times)" in last


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


def test_neither_view_passes_on_what_moves_a_cursor_or_turns_the_text():
    evil = "\x1b[2J\u202egone"
    record = tick(problems=(evil,))._replace(step_note=evil)
    out = io.StringIO()
    LineView(out).update(record)
    console = Console(file=io.StringIO(), force_terminal=False, width=120)
    console.print(page(record, [(1.0, Noted(1.0, evil, 1.0))], f"{evil} [/b]"))
    for said in (out.getvalue(), console.file.getvalue()):
        assert "\ufffd[2J\ufffdgone" in said
        assert not {"\x1b", "\u202e"} & set(said)
