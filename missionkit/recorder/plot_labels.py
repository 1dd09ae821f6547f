"""Where labels go: beside their anchors, none over another, all the same every time.

Source: J. Christensen, J. Marks, S. Shieber, "An empirical study of algorithms for point-feature
label placement", 1995: a fixed set of candidate places, the cheapest free one first.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Pixels = npt.NDArray[np.float64]  # (N, 2), px, to the right and up
Boxes = npt.NDArray[np.float64]  # (N, 4), px: left, bottom, right, top

GAPS = (5.0, 14.0, 28.0, 46.0, 70.0, 100.0, 140.0)  # px between anchor and label, nearest first
ASIDE = ((1, 0), (-1, 0), (1, 1), (-1, 1), (1, -1), (-1, -1), (0, 1), (0, -1))
FAR_COST = 4.0  # points of the path that one step further away is worth
LABEL_PADDING = 3.0  # px kept free around a label
TO = "\N{EN DASH}"  # between the ends of a range


class Wanted(NamedTuple):
    """A label: its anchor (px), its size (px)."""

    anchor: tuple[float, float]
    width: float
    height: float
    needed: bool = True  # else it is left out where nothing is free beside its anchor


class Room(NamedTuple):
    """Where labels may go and what they keep off."""

    panel: tuple[float, float, float, float]  # px: left, bottom, right, top
    taken: Boxes  # that nothing may cover
    path: Pixels  # that is covered only where nothing better is free


def placed(labels: Sequence[Wanted], room: Room) -> list[tuple[float, float] | None]:
    """Return the centre (px) of each label; `None` where there is no room for it.

    Args:
        labels: the most important first.
        room: of the panel.
    """
    taken = [tuple(box) for box in room.taken.tolist()]
    found: list[tuple[float, float] | None] = []
    for label in labels:
        centre = _best(label, room, np.array(taken).reshape(-1, 4))
        found.append(centre)
        if centre is not None:
            taken.append(tuple(boxes(np.array([centre]), label.width, label.height)[0].tolist()))
    return found


def boxes(centres: Pixels, width: float, height: float) -> Boxes:
    """Return the boxes (N, 4) of a size around centres (N, 2).

    Args:
        centres: px.
        width: px.
        height: px.

    Returns:
        px: left, bottom, right, top.
    """
    half = np.array([0.5 * width, 0.5 * height])
    return np.hstack([centres - half, centres + half])


def overlapping(some: Boxes, others: Boxes) -> npt.NDArray[np.bool_]:
    """Return (N, M): which of N boxes cover a part of which of M others."""
    a, b = some[:, None, :], others[None, :, :]
    low, high = np.maximum(a[..., :2], b[..., :2]), np.minimum(a[..., 2:], b[..., 2:])
    return np.asarray((low < high).all(axis=-1))


def grouped(anchors: Pixels, apart: float) -> list[list[int]]:
    """Return which anchors (N, 2) lie within `apart` px of the first of their group, in order."""
    groups: list[list[int]] = []
    for number, anchor in enumerate(anchors):
        near = (it for it in groups if np.hypot(*(anchors[it[0]] - anchor)) <= apart)
        group = next(near, None)
        if group is None:
            groups.append([number])
        else:
            group.append(number)
    return groups


def numbers_text(numbers: Iterable[int], most: int = 3) -> str:
    """Return numbers in few letters.

    >>> numbers_text([3]), numbers_text([1, 2, 3, 7]), numbers_text([2, 4, 6, 8, 10])
    ('3', '1–3, 7', '2, 4 … 10')
    """
    runs: list[list[int]] = []
    for number in numbers:
        if runs and runs[-1][-1] == number - 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    texts = [f"{run[0]}{TO}{run[-1]}" if len(run) > 1 else str(run[0]) for run in runs]
    if len(texts) <= most:
        return ", ".join(texts)
    return f"{', '.join(texts[: most - 1])} … {texts[-1]}"


def _best(label: Wanted, room: Room, taken: Boxes) -> tuple[float, float] | None:
    centres, steps = _beside(label)
    place = _cheapest(label, centres, FAR_COST * steps, room, taken)
    if place is None and label.needed:
        centres = _everywhere(label, room)
        away = np.hypot(*(centres - np.array(label.anchor)).T)
        place = _cheapest(label, centres, away, room, taken)
    return place


def _cheapest(
    label: Wanted, centres: Pixels, costs: npt.NDArray[np.float64], room: Room, taken: Boxes
) -> tuple[float, float] | None:
    candidates = boxes(
        centres, label.width + 2.0 * LABEL_PADDING, label.height + 2.0 * LABEL_PADDING
    )
    left, bottom, right, top = room.panel
    inside = (candidates[:, 0] >= left) & (candidates[:, 1] >= bottom)
    inside &= (candidates[:, 2] <= right) & (candidates[:, 3] <= top)
    free = inside & ~overlapping(candidates, taken).any(axis=1)
    if not free.any():
        return None
    within = (room.path[None] >= candidates[:, None, :2]) & (
        room.path[None] <= candidates[:, None, 2:]
    )
    costs = costs + within.all(axis=-1).sum(axis=1)
    x, y = centres[int(np.argmin(np.where(free, costs, np.inf)))].tolist()
    return x, y


def _beside(label: Wanted) -> tuple[Pixels, npt.NDArray[np.float64]]:
    """Return the centres (N, 2) around the anchor, and how many steps away each is."""
    x, y = label.anchor
    places = [
        (x + u * (0.5 * label.width + gap), y + v * (0.5 * label.height + gap))
        for gap, (u, v) in itertools.product(GAPS, ASIDE)
    ]
    return np.array(places), np.repeat(np.arange(len(GAPS), dtype=float), len(ASIDE))


def _everywhere(label: Wanted, room: Room) -> Pixels:
    """Return a grid of centres (N, 2) over the whole panel."""
    left, bottom, right, top = room.panel
    across = np.arange(left, right, max(0.25 * label.width, 6.0))
    along = np.arange(bottom, top, 0.5 * label.height + LABEL_PADDING)
    return np.stack(np.meshgrid(across, along), axis=-1).reshape(-1, 2)
