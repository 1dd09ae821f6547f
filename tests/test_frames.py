"""The tree of timed transforms, against scipy and against itself."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp

from missionkit.frames import FrameError, FrameTree, Timed, held, interpolate
from missionkit.geometry import IDENTITY, Transform, from_euler, vec


def pose(yaw, *place):
    return Transform(from_euler(0.1, -0.2, yaw), vec(*place))


def shift(x):
    return Transform(IDENTITY, vec(x, 0, 0))


TRACK = (
    Timed(1.0, pose(0.0, 0, 0, 0)),
    Timed(1.1, pose(0.5, 1, 2, 3)),
    Timed(1.3, pose(-1, 3, 2, 1)),
)
MOUNT = pose(0.3, 0.1, 0, 0.05)
TREE = (
    FrameTree()
    .stepping("odom", "world", (Timed(0.0, shift(0)), Timed(1.2, shift(8))))
    .moving("base", "odom", TRACK)
    .fixed("camera", "base", MOUNT)
    .fixed("trunk", "world", pose(2.0, 9, 1, -2))
)


@pytest.mark.parametrize("at", [1.0, 1.03, 1.1, 1.25, 1.3])
def test_interpolation_is_slerp(at):
    times = [p.at for p in TRACK]
    turns = Rotation.from_quat([p.transform.rotation for p in TRACK], scalar_first=True)
    found = interpolate(TRACK, at)
    expected = Slerp(times, turns)(at)
    gap = (Rotation.from_quat(found.rotation, scalar_first=True).inv() * expected).magnitude()
    assert gap == pytest.approx(0, abs=1e-9)
    places = np.array([p.transform.translation for p in TRACK])
    for axis in range(3):
        assert found.translation[axis] == pytest.approx(np.interp(at, times, places[:, axis]))


def test_outside_its_times_a_pose_is_unknown():
    assert interpolate(TRACK, 0.99) is None
    assert interpolate(TRACK, 1.31) is None
    assert interpolate((), 1.0) is None
    assert held(TRACK, 0.5) is None
    assert held(TRACK, 9.0) is TRACK[-1].transform


def test_chain_is_the_product_of_its_links():
    found = TREE.lookup("world", "camera", 1.25)
    expected = shift(8) @ interpolate(TRACK, 1.25) @ MOUNT
    np.testing.assert_allclose(found.translation, expected.translation, atol=1e-12)
    np.testing.assert_allclose(found.rotation, expected.rotation, atol=1e-12)


def test_a_reset_moves_the_world_but_not_odom():
    before, after = TREE.lookup("world", "base", 1.19), TREE.lookup("world", "base", 1.21)
    assert after.translation[0] - before.translation[0] > 7
    smooth = (
        TREE.lookup("odom", "base", 1.21).translation
        - TREE.lookup("odom", "base", 1.19).translation
    )
    assert np.linalg.norm(smooth) < 0.5


def test_lookups_invert_each_other_across_branches():
    point = vec(1, 2, 3)
    there = TREE.lookup("camera", "trunk", 1.2)
    back = TREE.lookup("trunk", "camera", 1.2)
    np.testing.assert_allclose(back.apply(there.apply(point)), point, atol=1e-12)


def test_links_that_are_not_on_the_way_need_no_pose():
    assert TREE.lookup("base", "camera", 99.0).translation[0] == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("target", "source", "at", "words"),
    [
        ("world", "bace", 1.1, "did you mean 'base'"),
        ("map", "base", 1.1, "no frame 'map'"),
        ("world", "base", 2.0, "only from 1.000 s to 1.300 s"),
    ],
)
def test_errors_list_the_known_names(target, source, at, words):
    with pytest.raises(FrameError, match=words):
        TREE.lookup(target, source, at)


def test_a_tree_is_built_downwards_and_once():
    with pytest.raises(FrameError, match="no frame 'arm'"):
        FrameTree().fixed("hand", "arm", shift(1))
    with pytest.raises(FrameError, match="already"):
        TREE.fixed("base", "world", shift(1))
    with pytest.raises(FrameError, match="nor at any time"):
        FrameTree().moving("base", "world", ()).lookup("world", "base", 0.0)
