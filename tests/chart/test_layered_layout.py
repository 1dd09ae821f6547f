from __future__ import annotations

from itertools import combinations

from hypothesis import given, settings
from hypothesis import strategies as st

from missionkit.chart.drawing.layered_layout import LayoutBox, LayoutLink, layout

SIZES = st.builds(LayoutBox, st.floats(20, 200), st.floats(10, 60))


@st.composite
def charts(draw: st.DrawFn) -> tuple[list[LayoutBox], list[LayoutLink]]:
    states = draw(st.lists(SIZES, min_size=1, max_size=9))
    number = st.integers(0, len(states) - 1)
    return states, draw(st.lists(st.builds(LayoutLink, number, number, SIZES), max_size=14))


@settings(deadline=None, max_examples=60, derandomize=True, database=None)
@given(charts())
def test_nothing_covers_anything_and_all_is_inside(chart: tuple[list[LayoutBox], list[LayoutLink]]):
    states, links = chart
    placed = layout(states, links, 0)
    boxes = [
        (x - box.width / 2, y - box.height / 2, x + box.width / 2, y + box.height / 2)
        for (x, y), box in zip(
            placed.states + placed.labels, states + [link.label for link in links], strict=True
        )
    ]
    for a, b in combinations(boxes, 2):
        assert a[2] <= b[0] + 1e-6 or b[2] <= a[0] + 1e-6 or a[3] <= b[1] or b[3] <= a[1]
    assert all(box[0] >= -1e-6 and box[1] >= -1e-6 for box in boxes)
    assert all(box[2] <= placed.width + 1e-6 and box[3] <= placed.height + 1e-6 for box in boxes)


@settings(deadline=None, max_examples=60, derandomize=True, database=None)
@given(charts())
def test_arrows_run_from_their_source_to_their_target(
    chart: tuple[list[LayoutBox], list[LayoutLink]],
):
    states, links = chart
    placed = layout(states, links, 0)
    for link, label, route in zip(links, placed.labels, placed.routes, strict=True):
        for state, (x, y) in ((link.source, route[0]), (link.target, route[-1])):
            (cx, cy), box = placed.states[state], states[state]
            assert abs(x - cx) <= box.width / 2
            assert abs(abs(y - cy) - box.height / 2) < 1e-6
        assert any(x == label[0] for x, _ in route)


def test_the_initial_state_stands_on_top():
    box = LayoutBox(50, 20)
    placed = layout(
        [box] * 3, [LayoutLink(0, 1, box), LayoutLink(2, 0, box), LayoutLink(1, 2, box)], 2
    )
    heights = [y for _, y in placed.states]
    assert heights[2] < heights[0] < heights[1]


def test_the_ends_of_a_loop_do_not_cross():
    links = [
        LayoutLink(0, 1, LayoutBox(90, 20)),
        LayoutLink(0, 0, LayoutBox(50, 20)),
        LayoutLink(0, 2, LayoutBox(60, 20)),
    ]
    begin, down, _, up, end = layout([LayoutBox(120, 48)] * 3, links, 0).routes[1]
    assert begin[0] < end[0]
    assert down[0] < up[0]
