from __future__ import annotations

import itertools

import pytest
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.text import Text

from missionkit.messages import Fired
from missionkit.recorder import track as tracks
from missionkit.recorder.palette import STATES, colours
from missionkit.recorder.plot import draw
from missionkit.recorder.plot_guards import labels
from missionkit.recorder.plot_list import MOST, draw_list
from missionkit.recorder.scenery import Scenery


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


def test_a_northern_flight_fills_the_page(tmp_path, flown, orchard, words):
    draw(tmp_path / "track.png", flown, orchard, "precision-task: success", "seed 1")
    picture = imread(tmp_path / "track.png")
    assert picture.shape[:2] == (1600, 1400)
    for word in ("precision-task: success", "Map", "Close-up of trunk", "marker 23", "marker-sure"):
        assert word in words
    assert "gps → visual" in words
    assert "visual" in words


def test_the_map_is_undistorted_with_north_up(tmp_path, flown, orchard, monkeypatch):
    figures = []
    monkeypatch.setattr(Figure, "savefig", lambda self, *a, **k: figures.append(self), raising=True)
    draw(tmp_path / "track.png", flown, orchard, "t")
    (figure,) = figures
    ground = [it for it in figure.axes if it.get_title(loc="left").startswith(("Map", "Close"))]
    assert len(ground) == 2
    for axes in ground:
        origin, north, east = axes.transData.transform([(10, 80), (10, 81), (11, 80)])
        assert north[1] - origin[1] == pytest.approx(east[0] - origin[0])
        assert north[1] > origin[1]
        assert east[0] > origin[0]


def test_an_eastern_flight_without_truth_or_guards(tmp_path, flown, words):
    east = flown._replace(
        estimated=[(e, n, d) for n, e, d in flown.estimated], true=[], guards={}, goals=[]
    )
    draw(tmp_path / "track.png", east, Scenery(), "t")
    assert imread(tmp_path / "track.png").shape[:2] == (1600, 1400)
    assert "truth" not in words
    assert not any(word.startswith("Close-up") for word in words)


def test_a_run_that_never_ticked_still_gives_a_page(tmp_path):
    draw(tmp_path / "track.png", tracks.begin(), Scenery(), "nothing: crash")
    assert imread(tmp_path / "track.png").shape[:2] == (1600, 1400)


def test_a_long_list_of_transitions_says_how_many_more():
    track = tracks.begin()
    track.transitions.extend((k, Fired("a", "b", "x " * 80, (), ())) for k in range(MOST + 3))
    axes = Figure().add_subplot()
    draw_list(axes, track, {}, letters=40)
    told = [it.get_text() for it in axes.texts]
    assert told[-1] == "and 3 more"
    assert all(len(line) <= 40 for it in told for line in it.splitlines())


@pytest.mark.parametrize(("height", "lines"), [(5.0, 2), (2.5, 1)])
def test_a_long_reason_takes_two_lines_where_rows_are_high(height, lines):
    track = tracks.begin()
    reason = "when marker-sure and trunk-in-range and near-goal"
    track.transitions.extend((k, Fired("a", "b", reason, (), ())) for k in range(MOST))
    axes = Figure(figsize=(8.0, height), dpi=100).add_subplot()
    draw_list(axes, track, {}, letters=40)
    told = next(it.get_text() for it in axes.texts if it.get_text().startswith("when"))
    assert len(told.splitlines()) == lines
    assert told.endswith("near-goal" if lines == 2 else " …")


def test_names_of_guards_fit_beside_their_timeline_and_differ():
    names = ["marker-sure", "target lost (target trunk, longer_than 2)", "x" * 40]
    names += ["target lost (target trunk, longer_than 5)"]
    told = labels(names)
    assert told == ["marker-sure", "target lost …", "x" * 22 + " …", "target lost … 2"]


def test_states_keep_their_colour_and_neighbours_differ():
    shades = colours(["idle", "gps", "visual", "gps", *map(str, range(9))])
    assert shades["gps"] == STATES[1]
    assert all(a != b for a, b in itertools.pairwise(shades.values()))
