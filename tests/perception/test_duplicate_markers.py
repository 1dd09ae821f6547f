"""More markers of one id in view than the mission has."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import CAMERA, LEVEL, corners_of, marker_at, seen_from, target, with_corners
from scenes import priors as believed

from missionkit.perception.aruco import Aruco
from missionkit.perception.vision_pipeline import VisionPipeline
from missionkit.perception.vision_warning import EPISODE_ENDS, begun

TRUNK = Aruco(target="trunk", id=23, size=0.4)
SMALL = TRUNK.model_copy(update={"id": 62, "size": 0.2})
NEAR, FAR = marker_at(4.0, -1.0, 0.0), marker_at(6.0, 0.5, 0.0)


def at(marker, number=23, size=0.4):
    return number, corners_of(seen_from(LEVEL, marker), size)


BOTH = (at(NEAR), at(FAR))


def tree(*position, sd, seen_at=None, name="trunk"):
    return target(name, position, sd=sd)._replace(seen_at=seen_at)


def look(eye, frame, *targets, memory=None):
    """Return the memory, and by target how far (m) ahead the marker is that was taken."""
    memory, _, sightings, _ = eye.look(memory or eye.begin(), frame, believed(*targets))
    taken = {s.target: round(float((CAMERA.mount.apply(s.pose.translation))[0])) for s in sightings}
    return memory, taken


def messages(memory):
    return [it.message for it in memory.warnings]


@pytest.mark.parametrize("order", [1, -1])
def test_of_two_equal_markers_the_one_where_the_target_was_seen_is_taken_and_both_are_reported(
    order,
):
    eye, seen = VisionPipeline(CAMERA, [TRUNK]), tree(6.1, 0.5, 0.0, sd=0.1, seen_at=0.9)
    memory, taken = look(eye, with_corners(1.0, *BOTH[::order]), seen)
    assert taken == {"trunk": 6}
    assert messages(memory) == [
        "2 markers with id 23 (DICT_6X6_250) are in view, but the mission has 1: the one where "
        "trunk is expected is used; remove or cover the others"
    ]


@pytest.mark.parametrize(
    "target",
    [tree(6.1, 0.5, 0.0, sd=1.0), tree(5.5, 0.0, 0.0, sd=1.0, seen_at=0.9)],
    ids=["never seen", "seen, but both lie within 5 sigma"],
)
def test_of_two_equal_markers_that_cannot_be_without_duplicates_none_is_taken(target):
    memory, taken = look(VisionPipeline(CAMERA, [TRUNK]), with_corners(1.0, *BOTH), target)
    assert taken == {}
    (message,) = messages(memory)
    assert "none is used, because it is not clear which belongs to trunk" in message


def test_a_target_nothing_is_known_of_is_not_guessed_by_size():
    assert look(VisionPipeline(CAMERA, [TRUNK]), with_corners(1.0, *BOTH))[1] == {}


def test_a_duplicate_too_far_to_be_the_target_is_reported_and_no_hindrance():
    memory, taken = look(
        VisionPipeline(CAMERA, [TRUNK]),
        with_corners(1.0, *BOTH, at(marker_at(9.0, -1.5, -1.0))),
        tree(9.0, -1.5, -1.0, sd=0.2),
    )
    assert taken == {"trunk": 9}
    assert messages(memory)[0].startswith("3 markers with id 23")


def test_another_marker_of_the_target_still_speaks():
    eye = VisionPipeline(CAMERA, [TRUNK, SMALL])
    memory, taken = look(eye, with_corners(1.0, *BOTH, at(FAR, 62, 0.2)), tree(6, 0.5, 0, sd=1.0))
    assert taken == {"trunk": 6}
    assert [it.about[-1] for it in memory.warnings] == ["unused"]


def test_two_targets_may_carry_the_same_id_on_purpose():
    eye = VisionPipeline(CAMERA, [TRUNK, TRUNK.model_copy(update={"target": "post"})])
    beliefs = tree(4.2, -1, 0, sd=0.5), tree(6.2, 0.5, 0, sd=0.5, name="post")
    memory, taken = look(eye, with_corners(1.0, *BOTH), *beliefs)
    assert (taken, memory.warnings) == ({"trunk": 4, "post": 6}, ())
    memory, taken = look(eye, with_corners(1.0, *BOTH, at(marker_at(5, 3.0, 0))), *beliefs)
    assert taken == {}
    assert [it.about[0] for it in memory.warnings] == ["post", "trunk"]


def test_one_marker_that_is_read_twice_is_one_marker():
    inner = at(FAR, size=0.36)
    memory, taken = look(VisionPipeline(CAMERA, [TRUNK]), with_corners(1.0, at(FAR), inner))
    assert (taken, memory.warnings) == ({"trunk": 6}, ())


def test_an_episode_is_reported_once_and_another_one_again():
    eye, memory = VisionPipeline(CAMERA, [TRUNK]), None
    rng, reported = np.random.default_rng(0), []
    pause = EPISODE_ENDS + 1.0
    for time, found in [(1.0, BOTH), (1.1, BOTH), (1.2, BOTH[:1]), (1.3, BOTH), (pause + 2, BOTH)]:
        noisy = [(number, corners + rng.normal(0, 0.05, (4, 2))) for number, corners in found]
        before = () if memory is None else memory.warnings
        memory, _ = look(eye, with_corners(time, *noisy), memory=memory)
        reported.append(len(begun(memory.warnings, before)))
    assert reported == [1, 0, 0, 0, 1]
