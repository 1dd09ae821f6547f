"""A picture is readable: nothing written over anything else, nothing cut without a word."""

from __future__ import annotations

from itertools import combinations, pairwise

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.text import Text
from recorder.made_up import flight, poles

from missionkit.recorder import plot_guards, plot_list, plot_states
from missionkit.recorder.palette import MOST_STYLES, OTHER_STYLE, styles
from missionkit.recorder.plot import PLOT_STYLE, picture
from missionkit.recorder.plot_labels import overlapping
from missionkit.recorder.scenery import Fence

SIZES = {  # states: transitions, poles, north, east (m)
    3: (2, 1, 60.0, 60.0),
    12: (26, 4, 200.0, 80.0),
    26: (60, 8, 80.0, 120.0),
    60: (130, 20, 150.0, 150.0),
}


@pytest.fixture(scope="module", params=SIZES)
def page(request):
    states = request.param
    transitions, count, north, east = SIZES[states]
    scenery = poles(count, north, east)
    track = flight(states, transitions, scenery)
    with mpl.rc_context(PLOT_STYLE):
        figure = picture(track, scenery, "orchard: success", "flown as planned, " * 20)
        figure.draw_without_rendering()
        yield figure, track, scenery


def written(figure: Figure) -> list[Text]:
    """Every text that is seen."""
    found = [it for it in figure.findobj(Text) if it.get_text().strip() and it.get_visible()]
    hidden = [axes for axes in figure.axes if not axes.axison]
    off = {
        id(it) for axes in hidden for axis in (axes.xaxis, axes.yaxis) for it in axis.findobj(Text)
    }
    ticks = {id(it) for axes in figure.axes for it in outside_ticks(axes)}
    return [it for it in found if id(it) not in off | ticks]


def outside_ticks(axes):
    """Labels of ticks beyond the limits: matplotlib keeps them and does not draw them."""
    for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        for tick in axis.get_major_ticks():
            if not min(low, high) - 1e-9 <= tick.get_loc() <= max(low, high) + 1e-9:
                yield from (tick.label1, tick.label2)


def texts(figure: Figure) -> set[str]:
    return {it.get_text() for it in written(figure)}


def panel(figure: Figure, title: str):
    return next(it for it in figure.axes if it.get_title(loc="left").startswith(title))


def test_no_text_covers_another_and_all_are_on_the_page(page):
    figure, _, _ = page
    shown = written(figure)
    boxes = np.array([it.get_window_extent().extents for it in shown])
    inner = boxes + np.array([1.0, 1.0, -1.0, -1.0])
    over = overlapping(inner, inner)
    pairs = [(a, b) for a, b in combinations(range(len(shown)), 2) if over[a, b]]
    assert [(shown[a].get_text(), shown[b].get_text()) for a, b in pairs] == []
    assert boxes[:, :2].min() >= 0.0
    assert boxes[:, 2].max() <= figure.bbox.width
    assert boxes[:, 3].max() <= figure.bbox.height


def test_every_target_is_named_and_the_fence_is_drawn(page):
    figure, _, scenery = page
    ground = panel(figure, "Map")
    named = {it.get_text() for it in ground.texts}
    assert {it.name for it in scenery.targets} <= named
    outlines = [it.get_xy()[:4] for it in ground.patches if not it.get_fill()]
    np.testing.assert_allclose(outlines[0], scenery.fences[0].outline()[:, ::-1])
    labelled = any("fence: north" in it for it in named)
    (south, west), (north, east) = scenery.fences[0].corners[::2]
    seen = ground.get_ylim()[0] <= south and north <= ground.get_ylim()[1]
    seen = seen and ground.get_xlim()[0] <= west and east <= ground.get_xlim()[1]
    assert seen is not labelled


def test_every_transition_is_numbered_on_the_map(page):
    figure, track, _ = page
    shown = [it.get_text() for it in panel(figure, "Map").texts if it.get_bbox_patch()]
    ends = {
        int(word)
        for it in shown
        for word in it.replace("\N{EN DASH}", " ").split()
        if word.isdigit()
    }
    assert len(track.transitions) in ends
    assert 1 in ends


def test_the_line_of_each_state_is_like_no_other_and_is_the_key_of_its_row(page):
    figure, track, _ = page
    names = {it.state for it in track.visits}
    lines = {it.get_gid(): it for axes in figure.axes for it in axes.lines if it.get_gid()}
    looks = {
        name: (line.get_color(), str(line._dash_pattern), line.get_marker())
        for name in names
        for line in [lines[f"path of {name}"]]
    }
    assert len(set(looks.values())) == len(names)
    for name, (colour, _, marker) in looks.items():
        key = lines[f"key of {name}"]
        assert (key.get_color(), key.get_marker()) == (colour, marker)
    assert names <= texts(figure)


def test_lists_that_are_cut_say_in_their_last_line_what_is_left_out_and_where_it_is(page):
    figure, track, _ = page
    count = len(track.transitions)
    last = max(panel(figure, "Transitions").texts, key=lambda it: it.get_position()[1]).get_text()
    if count > plot_list.MOST_LISTED + 2:
        first, end = (
            plot_list.MOST_LISTED - plot_list.LAST_LISTED + 1,
            count - plot_list.LAST_LISTED,
        )
        assert last == (
            f"{count - plot_list.MOST_LISTED} of {count} are left out, {first} to {end}: "
            "see transitions in summary.json"
        )
    else:
        assert "left out" not in last
    more = len(track.guards) - plot_guards.MOST_GUARDS
    said = f"and {more} more, which changed least: see /guards in flight.mcap"
    assert (said in texts(figure)) is (more > 0)


def test_more_states_than_rows_are_counted():
    scenery = poles(30, 100.0, 100.0)
    states = plot_states.MOST_STATE_ROWS + 6
    track = flight(states, states + 3, scenery)
    with mpl.rc_context(PLOT_STYLE):
        shown = texts(picture(track, scenery, "t"))
    said = "and 6 more states, visited more briefly: see states in summary.json"
    assert said in shown


def test_a_far_fence_is_written_where_it_is_not_seen_whole():
    scenery = poles(2, 50.0, 20.0)._replace(fences=(Fence.box((-500.0, 500.0), (-400.0, 400.0)),))
    with mpl.rc_context(PLOT_STYLE):
        figure = picture(flight(6, 8, scenery), scenery, "t")
    ground = panel(figure, "Map")
    assert ground.get_ylim()[1] < 200.0
    said = "fence: north -500 to 500 m, east -400 to 400 m"
    assert said in {it.get_text() for it in ground.texts}


def test_styles_stay_apart_and_neighbours_differ_in_colour():
    looks = list(styles(map(str, range(MOST_STYLES + 2))).values())
    assert len({str(it) for it in looks[:MOST_STYLES]}) == MOST_STYLES
    assert all(a.colour != b.colour for a, b in pairwise(looks[:MOST_STYLES]))
    assert looks[MOST_STYLES:] == [OTHER_STYLE, OTHER_STYLE]
