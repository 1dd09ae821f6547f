from __future__ import annotations

import math
import pickle

import numpy as np
import pytest
from scenes import (
    CAMERA,
    DICTIONARY,
    LEVEL,
    corners_of,
    marker_at,
    noisy,
    priors,
    render,
    seen_from,
    target,
    with_corners,
    with_image,
)

from missionkit.geometry import Transform, from_euler, rotate, vec
from missionkit.messages import Detection, Frame, Look, Observation
from missionkit.perception.aruco import Aruco
from missionkit.perception.marker_search import Priors
from missionkit.perception.square_pose import angle_between
from missionkit.perception.target_sighting import sight
from missionkit.perception.vision_pipeline import VisionMemory, VisionPipeline

TRUNK = Aruco(target="trunk", id=23, size=0.4)
GATE = Aruco(target="gate", id=62, size=0.25)
SPOT = marker_at(6.0, 0.5, 0.2)
PERIOD = CAMERA.period


def corners(marker, size=0.4, seed=0, body=LEVEL):
    return noisy(corners_of(seen_from(body, marker), size), np.random.default_rng(seed))


def look(eye, observation, *targets, memory=None, **more):
    return eye.look(memory or eye.begin(), observation, priors(*targets, **more))[:3]


@pytest.mark.parametrize("rendered", [True, False], ids=["image", "corners"])
def test_a_frame_contains_its_target_poses(rendered):
    eye = VisionPipeline(CAMERA, [TRUNK, GATE])
    gate = marker_at(3.0, -0.8, 0.3, yaw=math.radians(165))
    found = [(23, corners(SPOT)), (62, corners(gate, 0.25))]
    image = render(found, np.random.default_rng(1))
    observation = with_image(2.0, image) if rendered else with_corners(2.0, *found)
    _, looks, sightings = look(eye, observation)
    assert looks == (Look(2.0, frozenset({"trunk", "gate"})),)
    assert [(s.target, s.id) for s in sightings] == [("gate", 62), ("trunk", 23)]
    for sighting, truth in zip(sightings, (gate, SPOT), strict=True):
        place = seen_from(LEVEL, truth)
        assert np.linalg.norm(sighting.pose.translation - place.translation) < 0.15
        assert sighting.position_sd < 0.1
        assert sighting.at == 2.0


def test_of_a_marker_with_known_orientation_the_pose_is_true_to_its_deviation():
    eye, turned = VisionPipeline(CAMERA, [TRUNK]), marker_at(3.0, 0.0, 0.0, yaw=math.radians(150))
    truth = seen_from(LEVEL, turned)
    misses = []
    for seed in range(40):
        *_, (s,) = look(eye, with_corners(1.0, (23, corners(turned, seed=seed))))
        assert not s.ambiguous
        along = (s.pose.translation - truth.translation)[2] / s.position_sd
        misses.append((along, angle_between(s.pose.rotation, truth.rotation) / s.angle_sd))
    spread = np.sqrt(np.mean(np.square(misses), axis=0))
    assert 0.6 < spread[0] < 1.5
    assert 0.6 < spread[1] < 2.0  # three axes against the worst one


def test_only_the_markers_looked_for_are_seen():
    eye = VisionPipeline(CAMERA, [TRUNK])
    _, looks, sightings = look(eye, with_corners(1.0, (24, corners(SPOT))))
    assert (looks, sightings) == ((Look(1.0, frozenset()),), ())
    wrong = Frame(1.0, None, (("DICT_4X4_50", 23, corners(SPOT)),))
    assert look(eye, Observation(1.0, frame=wrong))[2] == ()


@pytest.mark.parametrize("limits", [{"min_area": 2000.0}, {"max_area": 500.0}])
def test_markers_too_small_or_too_large_do_not_count(limits):
    found = with_corners(1.0, (23, corners(SPOT)))  # about 1400 px²
    assert look(VisionPipeline(CAMERA, [TRUNK]), found)[1][0].seen == {"trunk"}
    fussy = VisionPipeline(CAMERA, [TRUNK.model_copy(update=limits)])
    assert look(fussy, found)[1:] == ((Look(1.0, frozenset()),), ())


def test_corners_without_a_pose_are_not_a_sighting():
    found = with_corners(1.0, (23, np.full((4, 2), np.nan)))
    assert look(VisionPipeline(CAMERA, [TRUNK]), found)[1:] == ((Look(1.0, frozenset()),), ())
    flat = np.array([[100.0, 100.0], [140.0, 100.0], [180.0, 100.0], [140.0, 160.0]])
    assert look(VisionPipeline(CAMERA, [TRUNK]), with_corners(1.0, (23, flat)))[2] == ()


def test_a_far_decoy_with_the_same_id_is_refused():
    decoy = with_corners(1.0, (23, corners(marker_at(4.0, -1.5, 0.0))))
    away = target(position=(12.0, 3.0, 0.0), sd=0.3)
    assert look(VisionPipeline(CAMERA, [TRUNK]), decoy, away)[1:] == ((Look(1.0, frozenset()),), ())
    assert look(VisionPipeline(CAMERA, [TRUNK]), decoy, away, body=None)[1][0].seen == {"trunk"}


def test_markers_of_one_target_agree_on_its_centre_and_the_largest_is_used():
    big = TRUNK.model_copy(update={"id": 1, "offset": (0.0, 0.5, 0.0)})
    small = TRUNK.model_copy(update={"id": 2, "size": 0.2, "offset": (0.3, -0.2, 0.0)})
    eye, turned = VisionPipeline(CAMERA, [big, small]), math.radians(150)
    centre = marker_at(4.0, 0.0, 0.0, yaw=turned)
    places = {
        m.id: Transform(centre.rotation, centre.apply(np.array(m.offset))) for m in (big, small)
    }
    one, two = ((m.id, corners_of(seen_from(LEVEL, places[m.id]), m.size)) for m in (big, small))
    truth = seen_from(LEVEL, centre)
    for found, speaks in (([one], 1), ([two], 2), ([two, one], 1)):
        *_, (sighting,) = look(eye, with_corners(1.0, *found), target(position=(4, 0, 0)))
        assert sighting.id == speaks
        np.testing.assert_allclose(sighting.pose.translation, truth.translation, atol=1e-3)


def test_a_late_frame_is_used_with_the_pose_of_its_own_time():
    """The vehicle has turned since: with the pose of now the marker would be metres away."""
    then = LEVEL
    now = Transform(from_euler(0.0, 0.0, math.radians(90)), vec(0, 0, 0))
    poses = Priors(lambda at: then if at < 1.0 else now, {"trunk": target(sd=0.2)}, None)
    eye = VisionPipeline(CAMERA, [TRUNK])
    observation = with_corners(0.9, (23, corners(SPOT)), now=1.1)
    _, looks, sightings, _ = eye.look(eye.begin(), observation, poses)
    assert looks == (Look(0.9, frozenset({"trunk"})),)
    assert sightings[0].at == 0.9


def test_a_frozen_camera_is_silent_even_while_it_shows_the_marker():
    eye = VisionPipeline(CAMERA, [TRUNK])
    image = render([(23, corners(SPOT))], np.random.default_rng(0))
    memory, first, _ = look(eye, with_image(1.0, image))
    assert first[0].seen == {"trunk"}
    for at in (1.05, 1.10):
        memory, looks, sightings = look(eye, with_image(at, image.copy()), memory=memory)
        assert looks == (Look(at, frozenset(), silent=True),)
        assert sightings == ()
    fresh = render([(23, corners(SPOT))], np.random.default_rng(1))
    memory, looks, _ = look(eye, with_image(1.15, fresh), memory=memory)
    assert looks == (Look(1.15, frozenset({"trunk"})),)


def test_frozen_corners_are_silent_but_an_empty_scene_may_stay_empty():
    eye, same = VisionPipeline(CAMERA, [TRUNK]), corners(SPOT)
    memory, *_ = look(eye, with_corners(1.0, (23, same)))
    _, looks, _ = look(eye, with_corners(1.05, (23, same.copy())), memory=memory)
    assert looks[0].silent
    memory, *_ = look(eye, with_corners(1.0))
    _, looks, _ = look(eye, with_corners(1.05), memory=memory)
    assert looks == (Look(1.05, frozenset()),)


def run(eye, ticks):
    """Return the looks of each tick; `ticks` holds (now, whether a frame came)."""
    memory, silences = eye.begin(), []
    for i, (now, came) in enumerate(ticks):
        found = with_corners(now - 0.06, (23, corners(SPOT, seed=i)), now=now)
        memory, looks, _ = look(eye, found if came else Observation(now), memory=memory)
        silences.append([look.silent for look in looks])
    return silences


def test_a_camera_that_falls_silent_gives_one_silent_look_a_period():
    pattern = [True, True, False, False, False, False, True, True]
    silences = run(
        VisionPipeline(CAMERA, [TRUNK]), [(i * PERIOD, came) for i, came in enumerate(pattern)]
    )
    assert silences == [[False], [False], [], [True], [True], [True], [True, False], [False]]
    assert sum(map(len, silences)) == len(pattern)


def test_a_camera_that_never_sends_an_image_is_silent_from_the_start():
    silences = run(VisionPipeline(CAMERA, [TRUNK]), [(i * PERIOD, False) for i in range(6)])
    assert silences == [[], [], [True], [True], [True], [True]]


def test_every_other_frame_lost_is_half_the_frames_seen():
    silences = run(VisionPipeline(CAMERA, [TRUNK]), [(i * PERIOD, i % 2 == 0) for i in range(40)])
    silent = [s for looks in silences for s in looks]
    assert silent.count(True) / len(silent) == pytest.approx(0.5, abs=0.03)


@pytest.mark.parametrize(
    "ticks",
    [
        [(i * 2 * PERIOD, True) for i in range(20)],  # two frames a tick, the last one is seen
        [(i * 0.02, i % 5 in {0, 3}) for i in range(50)],  # frames every 2 or 3 ticks
    ],
    ids=["slow tick", "fast tick"],
)
def test_a_camera_out_of_step_with_the_tick_is_not_called_silent(ticks):
    assert not any(
        silent for looks in run(VisionPipeline(CAMERA, [TRUNK]), ticks) for silent in looks
    )


def test_the_memory_can_be_saved_and_the_eye_is_pure():
    eye = VisionPipeline(CAMERA, [TRUNK])
    memory, *_ = look(eye, with_corners(1.0, (23, corners(SPOT))))
    assert pickle.loads(pickle.dumps(memory)) == memory  # noqa: S301
    assert eye.begin() == VisionMemory()
    again = with_corners(1.05, (23, corners(SPOT, seed=1)))
    first, second = (look(eye, again, memory=memory) for _ in range(2))
    assert first[0] == second[0]
    np.testing.assert_array_equal(first[2][0].pose.rotation, second[2][0].pose.rotation)


def test_a_candidate_has_a_world_position_only_if_the_vehicle_has_one():
    found = Detection(DICTIONARY, 23, corners_of(seen_from(LEVEL, SPOT), 0.4), 1400.0)
    placed = sight(found, TRUNK, CAMERA, at=1.0, body=LEVEL, prior=None)
    np.testing.assert_allclose(placed.position, SPOT.translation, atol=1e-3)
    lost = sight(found, TRUNK, CAMERA, at=1.0, body=None, prior=None)
    assert lost.position is None


def test_the_marker_faces_out_of_the_wall_in_the_world():
    *_, (s,) = look(
        VisionPipeline(CAMERA, [TRUNK]), with_corners(1.0, (23, corners(SPOT))), target()
    )
    attitude = (LEVEL @ CAMERA.mount @ s.pose).rotation
    np.testing.assert_allclose(rotate(attitude, vec(0, 0, 1)), [-1, 0, 0], atol=0.35)
    np.testing.assert_allclose(rotate(attitude, vec(0, 1, 0)), [0, 0, -1], atol=0.35)


def test_a_pose_that_faces_away_is_turned_by_the_papers_guard():
    mirrored = corners_of(seen_from(LEVEL, SPOT), 0.4)[::-1].copy()
    loose = TRUNK.model_copy(update={"upright": False})
    *_, (s,) = look(VisionPipeline(CAMERA, [loose]), with_corners(1.0, (23, mirrored)))
    assert rotate(s.pose.rotation, vec(0, 0, 1)) @ s.pose.translation < 0
