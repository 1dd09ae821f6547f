"""Layouts inside layouts: nothing covers anything, and every arrow gets where it leads."""

from __future__ import annotations

from itertools import combinations

from hypothesis import given, settings
from hypothesis import strategies as st

from missionkit.chart.drawing.layered_layout import LayoutBox
from missionkit.chart.drawing.nested_layout import (
    Arrow,
    Drawing,
    Rectangle,
    nested,
)

BOX = LayoutBox(80, 40)
LABEL = LayoutBox(60, 20)
Parents = dict[str, str | None]


@st.composite
def charts(draw: st.DrawFn) -> tuple[Parents, list[Arrow]]:
    parents: Parents = {"s0": None}
    for number in range(1, draw(st.integers(1, 9))):
        parents[f"s{number}"] = draw(st.sampled_from([None, *parents]))
    names = st.sampled_from(list(parents))
    arrows = draw(st.lists(st.builds(Arrow, names, names, st.just(LABEL)), max_size=12))
    begins = {parent: name for name, parent in reversed(parents.items())}
    arrows += [Arrow(None, name, LayoutBox(8, 0), parent) for parent, name in begins.items()]
    return ordered(parents), arrows


def ordered(parents: Parents) -> Parents:
    """Return the states with those around them first, as a document has them."""

    def below(parent: str | None) -> Parents:
        inside: Parents = {}
        for name in [name for name, around in parents.items() if around == parent]:
            inside |= {name: parent, **below(name)}
        return inside

    return below(None)


def around(parents: Parents, name: str) -> list[str]:
    parent = parents[name]
    return [] if parent is None else [parent, *around(parents, parent)]


def edges(it: Rectangle) -> tuple[float, float, float, float]:
    (x, y, box) = it
    return x - box.width / 2, y - box.height / 2, x + box.width / 2, y + box.height / 2


def apart(a: Rectangle, b: Rectangle) -> bool:
    (l, t, r, d), (u, v, w, z) = edges(a), edges(b)  # noqa: E741
    return r <= u + 1e-6 or w <= l + 1e-6 or d <= v + 1e-6 or z <= t + 1e-6


def within(inner: Rectangle, outer: Rectangle) -> bool:
    (l, t, r, d), (u, v, w, z) = edges(inner), edges(outer)  # noqa: E741
    return u < l + 1e-6 and v < t + 1e-6 and r < w + 1e-6 and d < z + 1e-6


def drawn(parents: Parents, arrows: list[Arrow]) -> Drawing:
    return nested(dict.fromkeys(parents, BOX), parents, arrows)


@settings(deadline=None, max_examples=80, derandomize=True, database=None)
@given(charts())
def test_states_stand_inside_those_around_them_and_beside_all_others(chart):
    parents, arrows = chart
    states = drawn(parents, arrows).states
    assert set(states) == set(parents)
    for name, parent in parents.items():
        if parent is not None:
            assert within(states[name], states[parent])
            assert edges(states[name])[1] - edges(states[parent])[1] >= BOX.height  # its heading
    for one, other in combinations(parents, 2):
        related = one in around(parents, other) or other in around(parents, one)
        assert related or apart(states[one], states[other])


@settings(deadline=None, max_examples=80, derandomize=True, database=None)
@given(charts())
def test_labels_cover_no_state_and_no_label(chart):
    parents, arrows = chart
    picture = drawn(parents, arrows)
    leaves = [picture.states[name] for name in parents if name not in parents.values()]
    labels = [
        Rectangle(x, y, arrow.label)
        for (x, y), arrow in zip(picture.labels, arrows, strict=True)
        if arrow.source is not None
    ]
    for a, b in combinations(labels + leaves, 2):
        assert apart(a, b)


@settings(deadline=None, max_examples=80, derandomize=True, database=None)
@given(charts())
def test_arrows_run_from_border_to_border(chart):
    parents, arrows = chart
    picture = drawn(parents, arrows)
    for arrow, route in zip(arrows, picture.routes, strict=True):
        ends = [(arrow.target, route[-1])]
        if arrow.source is not None:
            ends.append((arrow.source, route[0]))
        for name, (x, y) in ends:
            left, top, right, bottom = edges(picture.states[name])
            assert left - 1e-6 <= x <= right + 1e-6
            assert min(abs(y - top), abs(y - bottom)) < 1e-6


def test_a_state_has_room_for_its_own_heading():
    parents: Parents = {"a": None, "b": "a", "c": "b"}
    sizes = {"a": LayoutBox(80, 40), "b": LayoutBox(300, 110), "c": BOX}
    states = nested(sizes, parents, []).states
    for outer, inner in (("a", "b"), ("b", "c")):
        assert within(states[inner], states[outer])
        room = edges(states[inner])[1] - edges(states[outer])[1]
        assert sizes[outer].height <= room < sizes[outer].height + 10
    assert states["b"].box.width == 300


def test_an_arrow_out_of_a_state_crosses_its_border():
    parents: Parents = {"a": None, "b": "a", "c": "b", "d": None}
    picture = drawn(parents, [Arrow("c", "d", LABEL), Arrow("d", "c", LABEL)])
    (out, back), states = picture.routes, picture.states
    for name in ("a", "b"):
        _, top, _, bottom = edges(states[name])
        for route in (out, back):
            assert any(min(abs(y - top), abs(y - bottom)) < 1e-6 for _, y in route), name
    assert (out[0], back[-1]) != (out[-1], back[0])
