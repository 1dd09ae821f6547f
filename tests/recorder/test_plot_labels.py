from __future__ import annotations

import numpy as np
import pytest

from missionkit.recorder.plot_labels import (
    Room,
    Wanted,
    boxes,
    grouped,
    numbers_text,
    overlapping,
    placed,
)

PANEL = (0.0, 0.0, 400.0, 300.0)
NOTHING = np.empty((0, 4))


def room(taken=NOTHING, path=()):
    return Room(PANEL, np.asarray(taken, dtype=float), np.array(path, dtype=float).reshape(-1, 2))


def laid(labels, where):
    centres = placed(labels, where)
    found = [
        boxes(np.array([centre]), label.width, label.height)[0]
        for label, centre in zip(labels, centres, strict=True)
        if centre is not None
    ]
    return centres, np.array(found)


@pytest.mark.parametrize("seed", range(20))
def test_labels_at_one_place_or_many_never_overlap_and_stay_in_the_panel(seed):
    rng = np.random.default_rng(seed)
    anchors = np.where(rng.random() < 0.3, 200.0, rng.uniform((0, 0), (400, 300), (40, 2)))
    labels = [
        Wanted((x, y), float(wide), 14.0)
        for (x, y), wide in zip(anchors, rng.uniform(15, 80, 40), strict=True)
    ]
    icons = boxes(anchors[:5], 10.0, 10.0)
    centres, found = laid(labels, room(icons))
    assert None not in centres
    over = overlapping(found, found)
    assert not over[~np.eye(len(found), dtype=bool)].any()
    assert not overlapping(found, icons).any()
    assert found.min() >= 0.0
    assert found[:, 2].max() <= 400.0
    assert found[:, 3].max() <= 300.0
    assert placed(labels, room(icons)) == centres


def test_a_label_stands_beside_its_anchor_and_keeps_off_the_path():
    path = [(x, 150.0) for x in range(200, 300)]  # to the right, where a label would go first
    (free,), (barred,) = (
        placed([Wanted((200.0, 150.0), 40.0, 14.0)], room(path=it)) for it in ((), path)
    )
    assert free == (225.0, 150.0)
    assert barred == (175.0, 150.0)


def test_a_label_that_is_not_needed_is_left_out_where_nothing_beside_it_is_free():
    full = [(0.0, 0.0, 400.0, 290.0)]
    needed, other = (Wanted((200.0, 20.0), 40.0, 8.0, needed=it) for it in (True, False))
    assert placed([other], room(full)) == [None]
    assert placed([needed], room([(0.0, 0.0, 400.0, 270.0)]))[0] is not None
    assert placed([needed], room([PANEL])) == [None]


def test_numbers_of_nearby_places_share_a_label():
    anchors = np.array([(0.0, 0.0), (50.0, 0.0), (3.0, 0.0), (52.0, 1.0), (4.0, 4.0)])
    assert grouped(anchors, 15.0) == [[0, 2, 4], [1, 3]]
    assert numbers_text([1, 3, 5]) == "1, 3, 5"
    assert numbers_text([1, 2, 3, 5, 8, 9]) == "1\N{EN DASH}3, 5, 8\N{EN DASH}9"
    assert numbers_text(range(1, 41, 2)) == "1, 3 … 39"
