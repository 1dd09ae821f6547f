"""Which features are kept, which patches are taken again, and where new features begin."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from missionkit.estimation.error_state_ekf.state_layout import LANDMARKS
from missionkit.estimation.ud_vision import feature_steps, feature_table
from missionkit.estimation.ud_vision.feature_table import FeatureTable, Flags, Slots
from missionkit.geometry import Mat, Vec3, to_matrix
from missionkit.messages import CameraModel, FeatureMatches, FeatureSearch


class Lens(NamedTuple):
    """The camera as the kernels have it."""

    eye: Mat  # (4, 3), camera to body: its axes as columns of the first three rows, then t (m)
    focal: Vec3  # (2,), px


def lens(camera: CameraModel) -> Lens:
    """Return mount and focal length of a camera."""
    mount = camera.mount
    eye = np.vstack((to_matrix(mount.rotation), mount.translation))
    return Lens(eye, camera.matrix.diagonal()[:2].copy())


def camera(x: Vec3, slots: Slots, through: Lens) -> tuple[Mat, Mat]:
    """Return camera to world (3, 3), and from the camera to features (k, 3), m, NED.

    Args:
        x: (16 + 3 N,) state.
        slots: (k,) which features.
        through: the camera.
    """
    R = to_matrix(x[6:10])
    places = x[LANDMARKS:].reshape(-1, 3)[slots]
    return R @ through.eye[:3], places - (x[:3] + R @ through.eye[3])


def renewed(
    table: FeatureTable,
    x: Vec3,
    search: FeatureSearch,
    matches: FeatureMatches,
    used: Flags,
    through: Lens,
) -> FeatureTable:
    """Return the table with outgrown patches taken again, and without crowds.

    Args:
        table: of the features.
        x: (16 + 3 N,) state.
        search: what was looked for.
        matches: what was found.
        used: (n,) of those looked for, taken in.
        through: the camera.
    """
    (a, b), (c, d) = search.warps.transpose(1, 2, 0)
    scale = np.sqrt(np.abs(a * d - b * c))
    fits = (scale > feature_table.LEAST_SCALE) & (scale < feature_table.MOST_SCALE)
    again = np.flatnonzero(used & ~fits)
    if len(again):
        turn, arms = camera(x, search.slots[again], through)
        table = feature_table.with_patches(
            table, search.slots[again], matches.patches[again], turn, arms
        )
    near = matches.in_view & table.alive[search.slots]
    places = matches.points[near] * through.focal
    return feature_table.thinned(table, search.slots[near], places, search.spacing)


def begun(
    table: FeatureTable,
    state: tuple[Vec3, Mat, Vec3],
    search: FeatureSearch,
    matches: FeatureMatches,
    variances: Vec3,
    through: Lens,
) -> FeatureTable:
    """Return the table with new features, and begin them in the state, in place.

    Args:
        table: of the features.
        state: x, U and D, changed.
        search: what was looked for.
        matches: what was found.
        variances: (3,) of `feature_steps.begin`.
        through: the camera.
    """
    in_view = np.zeros(len(table.alive), np.bool_)
    in_view[search.slots[matches.in_view]] = True
    slots, rows = [], []
    corners = matches.corners * through.focal
    vacant = feature_table.vacant(table, in_view).tolist() if len(corners) else []
    for row, slot in zip(range(len(corners)), vacant, strict=False):
        if feature_steps.begin(*state, slot, corners[row], *through, variances):
            slots.append(slot)
            rows.append(row)
    if not slots:
        return table
    taken = np.array(slots, np.int64)
    turn, arms = camera(state[0], taken, through)
    patches = matches.corner_patches[rows]
    table = feature_table.with_patches(table, taken, patches, turn, arms)
    return feature_table.begun(table, taken, matches.at)
