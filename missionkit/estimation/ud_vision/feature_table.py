"""What is kept of each feature beside its state: its patch, and how often it was seen.

Values; a change makes a new table.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from missionkit.geometry import Mat
from missionkit.messages.image_features import PATCH, Patches

LOST_AFTER = 10
"""A feature that was in view in so many frames in a row, and not found or refused, is dropped."""
CROWDED = 0.5
"""Of two features nearer to each other than this share of the spacing the younger is dropped."""
LEAST_SCALE, MOST_SCALE = 0.6, 1.6
"""Seen smaller or larger than this, a patch is taken again."""
_CORNERS = np.array([[1.0, 0.0], [0.0, 1.0]])

Flags = npt.NDArray[np.bool_]
Slots = npt.NDArray[np.int64]


class FeatureTable(NamedTuple):
    """One row for each of N slots."""

    alive: Flags  # (N,)
    patches: Patches  # (N, 31, 31)
    turns: Mat  # (N, 3, 3), camera to world when the patch was taken
    arms: Mat  # (N, 3), m, NED, from the camera to the feature then
    missed: Slots  # (N,), frames in a row
    sightings: Slots  # (N,)
    seen_at: Mat  # (N,), s


def begin(count: int) -> FeatureTable:
    """Return an empty table."""
    return FeatureTable(
        alive=np.zeros(count, np.bool_),
        patches=np.zeros((count, PATCH, PATCH), np.uint8),
        turns=np.tile(np.eye(3), (count, 1, 1)),
        arms=np.zeros((count, 3)),
        missed=np.zeros(count, np.int64),
        sightings=np.zeros(count, np.int64),
        seen_at=np.full(count, -np.inf),
    )


def warps(table: FeatureTable, slots: Slots, turn: Mat, arms: Mat, focal: Mat) -> Mat:
    """Return (k, 2, 2): px of the patch for one px of the image, of features on level ground.

    Args:
        table: of the features.
        slots: (k,) which.
        turn: (3, 3), camera to world now.
        arms: (k, 3), m, NED, from the camera to them now.
        focal: (2,), px.
    """
    turns, before = table.turns[slots], table.arms[slots]
    now = arms @ turn  # in the camera's axes
    corners = now[:, :2] / now[:, 2:] + _CORNERS[:, None] / focal
    rays = np.concatenate((corners, np.ones((2, len(slots), 1))), axis=2) @ turn.T
    moved = before + arms[:, 2:] / rays[..., 2:] * rays - arms  # along the ground
    c = (np.concatenate((before[None], moved))[..., None, :] @ turns)[..., 0, :]
    seen = c[..., :2] / c[..., 2:]
    out: Mat = (focal * (seen[1:] - seen[0])).transpose(1, 2, 0)
    return out


def marked(
    table: FeatureTable, slots: Slots, used: Flags, in_view: Flags, at: float
) -> FeatureTable:
    """Return the table after a frame.

    Args:
        table: before it.
        slots: (k,) which were looked for.
        used: (k,) found and taken in.
        in_view: (k,) their place was in the image.
        at: s, of the frame.
    """
    alive, missed = table.alive.copy(), table.missed.copy()
    sightings, seen_at = table.sightings.copy(), table.seen_at.copy()
    missed[slots[in_view & ~used]] += 1
    missed[slots[used]] = 0
    sightings[slots[used]] += 1
    seen_at[slots[used]] = at
    alive &= missed < LOST_AFTER
    return table._replace(alive=alive, missed=missed, sightings=sightings, seen_at=seen_at)


def thinned(table: FeatureTable, slots: Slots, places: Mat, spacing: float) -> FeatureTable:
    """Return the table without features that crowd together in the image.

    Args:
        table: of the features.
        slots: (k,) those in view.
        places: (k, 2), px.
        spacing: px.
    """
    near = np.hypot(*(places[:, None] - places).T) < CROWDED * spacing
    if near.sum() == len(places):  # each with itself
        return table
    alive, kept = table.alive.copy(), np.zeros(len(places), np.bool_)
    for n in np.argsort(-table.sightings[slots], kind="stable").tolist():
        kept[n] = not (near[n] & kept).any()
    alive[slots[~kept]] = False
    return table._replace(alive=alive)


def with_patches(
    table: FeatureTable, slots: Slots, patches: Patches, turn: Mat, arms: Mat
) -> FeatureTable:
    """Return the table with the patches of some features taken now.

    Args:
        table: before.
        slots: (k,) which.
        patches: (k, 31, 31).
        turn: (3, 3), camera to world now.
        arms: (k, 3), m, NED, from the camera to them.
    """
    kept, turns, before = table.patches.copy(), table.turns.copy(), table.arms.copy()
    kept[slots], turns[slots], before[slots] = patches, turn, arms
    return table._replace(patches=kept, turns=turns, arms=before)


def begun(table: FeatureTable, slots: Slots, at: float) -> FeatureTable:
    """Return the table with new features.

    Args:
        table: before.
        slots: (k,) where they begin.
        at: s.
    """
    alive, missed = table.alive.copy(), table.missed.copy()
    sightings, seen_at = table.sightings.copy(), table.seen_at.copy()
    alive[slots], missed[slots], sightings[slots], seen_at[slots] = True, 0, 1, at
    return table._replace(alive=alive, missed=missed, sightings=sightings, seen_at=seen_at)


def vacant(table: FeatureTable, in_view: Flags) -> Slots:
    """Return the slots for new features: the empty ones, then those longest out of view.

    Args:
        table: of the features.
        in_view: (N,) whose place is in the image.
    """
    order = np.argsort(np.where(table.alive, table.seen_at, -np.inf), kind="stable")
    return order[~(table.alive & in_view)[order]]
