from __future__ import annotations

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.text import Text
from recorder.made_up import flight as made_up
from recorder.made_up import poles

from missionkit.geometry import vec
from missionkit.messages import Fired, Goal
from missionkit.recorder import flight_track as tracks
from missionkit.recorder.plot import PLOT_STYLE, draw, picture
from missionkit.recorder.plot_close_up import reach, rounded
from missionkit.recorder.plot_ground import Flown, draw_goals
from missionkit.recorder.plot_guards import labels
from missionkit.recorder.plot_list import draw_list
from missionkit.recorder.plot_text import Font, Ruler
from missionkit.recorder.scenery import DrawnArena, RobotPath, Scenery

FONT = Font(10.0)


@pytest.fixture
def flown(flight):
    track = tracks.begin()
    for record, truth in flight():
        tracks.add(track, record, truth)
    return track


@pytest.fixture
def words(monkeypatch):
    """Every text that is drawn inside its panel or page."""
    seen = []
    real = Text.draw

    def spy(self, renderer):
        if self.get_visible() and self.get_text():
            seen.append(self.get_text())
        return real(self, renderer)

    monkeypatch.setattr(Text, "draw", spy)
    return seen


@pytest.fixture(autouse=True)
def style():
    with mpl.rc_context(PLOT_STYLE):
        yield


@pytest.fixture
def ruler():
    figure = Figure(dpi=100)
    FigureCanvasAgg(figure)
    return Ruler(figure)


def panel(figure: Figure, title: str):
    return next(it for it in figure.axes if it.get_title(loc="left").startswith(title))


def test_a_northern_flight_fills_the_page(tmp_path, flown, orchard, words):
    draw(tmp_path / "track.png", flown, orchard, "precision-task: success", "seed 1")
    high, wide = imread(tmp_path / "track.png").shape[:2]
    assert wide == 1400
    assert 1400 <= high <= 1600
    for word in ("precision-task: success", "Map", "Close-up: goal at trunk", "marker 23"):
        assert word in words
    assert {"marker-sure", "gps → visual", "visual"} <= set(words)


def test_the_map_is_undistorted_with_north_up(flown, orchard):
    figure = picture(flown, orchard, "t")
    for title in ("Map", "Close-up"):
        at = panel(figure, title).transData.transform([(10, 80), (10, 81), (11, 80)])
        origin, north, east = at
        assert north[1] - origin[1] == pytest.approx(east[0] - origin[0])
        assert north[1] > origin[1]
        assert east[0] > origin[0]


def test_an_eastern_flight_without_truth_or_guards(tmp_path, flown, words):
    east = flown._replace(
        estimated=[(e, n, d) for n, e, d in flown.estimated], true=[], guards={}, goals=[]
    )
    draw(tmp_path / "track.png", east, Scenery(), "t")
    assert imread(tmp_path / "track.png").shape[1] == 1400
    assert "truth" not in words
    assert not any(word.startswith("Close-up") for word in words)


def test_axes_of_a_flight_over_no_ground_are_those_of_the_mother_ship(tmp_path, flown, words):
    draw(tmp_path / "track.png", flown, Scenery(over_ground=False), "t")
    assert {"x, m", "y, m", "z in the mother-ship's frame"} <= set(words)
    assert not any("north" in word or "Height" in word for word in words)
    assert "H" not in words


def test_a_run_that_never_ticked_still_gives_a_page(tmp_path):
    draw(tmp_path / "track.png", tracks.begin(), Scenery(), "nothing: crash")
    assert imread(tmp_path / "track.png").shape[1] == 1400


def test_names_are_not_rendered_as_mathematics(tmp_path, words):
    scenery = poles(1, 40.0, 40.0)
    track = made_up(3, 2, scenery)
    track.transitions[0] = (1.0, Fired("a_$b", "c^$_{", "when $x and $y", (), ()))
    draw(tmp_path / "track.png", track, scenery, r"costs $5 \alpha$")
    assert {r"costs $5 \alpha$", "a_$b → c^$_{", "when $x and $y"} <= set(words)


@pytest.mark.parametrize(("error", "half"), [(0.05, 0.15), (0.5, 1.5), (0.001, 0.1), (30.0, 4.0)])
def test_the_close_up_is_as_wide_as_the_error_asks_for(flown, error, half):
    track = flown._replace(true=[(83.0 + error, 12.0, -2.0)] * len(flown.times))
    track = track._replace(estimated=track.true, goals=[Goal(vec(83, 12, -2), 0.0, 36.0, "trunk")])
    assert reach(Flown.of(track), track.goals[0]) == pytest.approx(half)
    axes = panel(picture(track, Scenery(), "t"), "Close-up")
    low, high = axes.get_ylim()
    assert high - low == pytest.approx(2.0 * half)
    bar = next(line for line in axes.lines if line.get_linewidth() == 3.0 and not line.get_gid())
    west, east = bar.get_xdata()
    across = axes.get_xlim()
    assert 0.08 <= (east - west) / (across[1] - across[0]) <= 0.3
    said = f"{100 * (east - west):.0f} cm" if east - west < 0.99 else f"{east - west:.0f} m"
    assert said in [it.get_text() for it in axes.texts]


@pytest.mark.parametrize(
    ("length", "expected"), [(0.34, 0.2), (0.5, 0.5), (7.0, 5.0), (0.019, 0.01)]
)
def test_a_scale_bar_has_a_round_length(length, expected):
    assert rounded(length) == pytest.approx(expected)


def test_a_goal_that_was_never_reached_is_drawn_apart(flown):
    goals = [Goal(vec(82.0, 12.0, -2.5), None, 30.0), Goal(vec(40.0, 60.0, -2.5), None, 30.0)]
    track = flown._replace(goals=goals, estimated=flown.true)
    found = draw_goals(Figure().add_subplot(), Flown.of(track))
    assert [len(it) for it in found] == [1, 1]
    assert found.left == [(60.0, 40.0)]


def test_a_goal_is_drawn_at_the_true_position(flown):
    drifted = [(north + 2.0, east - 1.0, down) for north, east, down in flown.true]
    track = flown._replace(estimated=drifted)
    goal = Goal(vec(83.0, 12.0, -2.5), None, 30.0)
    assert Flown.of(track).goal(goal) == pytest.approx((13.0, 81.0))


def test_a_list_has_reasons_no_wider_than_the_page_and_cuts_with_an_ellipsis():
    track = tracks.begin()
    track.transitions.extend((k, Fired("a", "b", "why " * 80, (), ())) for k in range(9))
    figure = Figure(figsize=(8.0, 5.0), dpi=100)
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 0.9))
    draw_list(axes, Ruler(figure), track, {}, 2)
    expected = [it for it in axes.texts if it.get_text().startswith("why")]
    assert len(expected) == 9
    assert all(it.get_text().count("\n") == 1 and it.get_text().endswith(" …") for it in expected)
    assert max(it.get_window_extent().x1 for it in expected) <= 800.0


def test_a_text_is_cut_to_the_width_and_wrapped_by_it(ruler):
    text = "when marker-sure and trunk-in-range and near-goal"
    whole = ruler.width(text, FONT)
    assert ruler.cut(text, FONT, whole) == text
    cut = ruler.cut(text, FONT, 0.5 * whole)
    assert cut.endswith(" …")
    assert 0.4 * whole < ruler.width(cut, FONT) <= 0.5 * whole
    lines = ruler.lines(text, FONT, 0.6 * whole, 2)
    assert " ".join(lines) == text
    assert ruler.lines(text, FONT, 0.2 * whole, 2)[1].endswith(" …")


def test_names_of_guards_fit_beside_their_timeline_and_differ(ruler):
    names = ["marker-sure", "target lost (target trunk of the third row, longer_than 2)"]
    names += ["target lost (target trunk of the third row, longer_than 5)"]
    expected = labels(ruler, names)
    assert expected[0] == "marker-sure"
    assert expected[1].endswith(" …")
    assert expected[2] == f"{expected[1]} 2"


def test_home_gets_no_close_up(flown):
    nowhere = flown._replace(goals=[Goal(vec(83, 12, -2), 0.0, 36.0, "home")])
    assert len(picture(nowhere, Scenery(), "t").axes) == 5


def test_a_page_is_the_same_every_time(tmp_path, flown, orchard):
    for name in ("a.png", "b.png"):
        draw(tmp_path / name, flown, orchard, "t", "s")
    assert np.array_equal(imread(tmp_path / "a.png"), imread(tmp_path / "b.png"))


def test_an_arena_has_its_goal_its_robots_paths_and_their_ends(flown):
    outline = np.array([(-5.0, -5.0), (5.0, -5.0), (5.0, 5.0), (-5.0, 5.0)])
    there = np.array([(0.0, 1.0), (5.0, 1.5)])
    paths = (
        RobotPath(there, "target", "home"),
        RobotPath(-there, "target", "lost"),
        RobotPath(0.5 * there, "target"),
        RobotPath(0.2 * there, "obstacle"),
    )
    arena = DrawnArena(outline, outline[2:])
    axes = panel(picture(flown, Scenery(arena=arena, paths=paths), "t"), "Map")
    drawn = [line.get_xydata().tolist() for line in axes.lines]
    assert [[5.0, 5.0], [5.0, -5.0]] in drawn  # the goal, east and north
    assert [[1.0, 0.0], [1.5, 5.0]] in drawn
    labels = [text.get_text() for text in axes.get_legend().get_texts()]
    assert labels[-3:] == ["1 in play", "1 home", "1 lost"]
