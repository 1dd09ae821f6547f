"""Searching images with a cascade: every window by hand, sizes, files, and a cascade trained."""

from __future__ import annotations

import json
import math

import cv2
import numpy as np
import pytest
from perception.test_haar_kernels import POOL, by_hand, image
from pydantic import ValidationError

from missionkit.geometry import IDENTITY, Transform, vec
from missionkit.messages import Frame
from missionkit.perception.apparent_size import SizeGate
from missionkit.perception.camera_section import Camera, Mount
from missionkit.perception.detector_sample import Sample, judged
from missionkit.perception.haar.cascade import HaarCascade, shipped
from missionkit.perception.haar.cascade_file import cascade_of, text_of
from missionkit.perception.haar.detector import Haar
from missionkit.perception.haar.features import SIDE
from missionkit.perception.haar.gentle_boost import Stage, StageGoal, Stump
from missionkit.perception.haar.training import TrainedStage, TrainingPlan, arrays_of, trained
from missionkit.perception.haar.window_search import objects, passing
from missionkit.perception.score_law import ScoreLaw, fitted
from missionkit.perception.size_pyramid import grouped, level_of
from missionkit.plugin_protocols import Prior

FLAT = SizeGate(np.array([0.0, 0.0, 20.0]), 1.0, 3.0)


def stages(seed=0):
    """Return two stages of chance, of which about half and a third of all windows pass."""
    rng = np.random.default_rng(seed)
    for count, limit in ((3, -0.5), (4, -0.5)):
        which = rng.permutation(len(POOL.weights))[:count]
        stumps = tuple(Stump(i, rng.normal(0.0, 0.01), -1.0 - 0.1 * i, 1.0) for i in range(count))
        yield TrainedStage(Stage(stumps, limit), POOL.only(which))


def passes(window, cascade):
    """Return the sum over the limits, None if a stage refuses."""
    over = 0.0
    for stage in cascade:
        answers = (
            it.low if by_hand(window, rectangles, weights) < it.threshold else it.high
            for it, rectangles, weights in zip(stage.stage.stumps, *stage.features, strict=True)
        )
        answer = sum(answers)
        if answer < stage.stage.limit:
            return None
        over += answer - stage.stage.limit
    return over


def test_the_search_passes_the_windows_that_pass_by_hand():
    cascade = list(stages())
    level = level_of(image(shape=(44, 50)), 20.0, 1.0, 20.0, SIDE)
    assert level.image.shape == (44 + 2 * level.pad, 50 + 2 * level.pad)
    found = passing(level, arrays_of(cascade), SIDE, FLAT, 3)
    expected = {}
    for top in range(0, level.image.shape[0] - SIDE + 1, 3):
        for left in range(0, level.image.shape[1] - SIDE + 1, 3):
            over = passes(level.image[top : top + SIDE, left : left + SIDE], cascade)
            if over is not None:
                middle = (left - level.pad + 11.5, top - level.pad + 11.5)
                expected[middle] = pytest.approx(over, abs=1e-9)
    assert 5 < len(expected) < 150  # of 210 windows
    assert {(u, v): over for u, v, over in found.tolist()} == expected


def test_only_places_where_objects_of_that_size_are_expected_are_searched():
    level = level_of(image(shape=(100, 100)), 20.0, 1.0, 20.0, SIDE)
    everything = arrays_of([])
    sloped = SizeGate(np.array([0.2, 0.0, 10.0]), 1.0, 3.0)  # 20 px wide at column 50
    columns = passing(level, everything, SIDE, sloped, 2)[:, 0]
    assert columns.min() == pytest.approx(35.0, abs=2.0)
    assert columns.max() == pytest.approx(65.0, abs=2.0)


def ring(width, blur=0.8):
    """Return a picture (96, 96) of a ring `width` across, at its middle (47.5, 47.5)."""
    fine = np.full((960, 960), 100, np.uint8)
    cv2.circle(fine, (480, 480), round(5 * width), 190, -1)
    cv2.circle(fine, (480, 480), round(2.5 * width), 50, -1)
    small = cv2.resize(fine, (96, 96), interpolation=cv2.INTER_AREA)
    return cv2.GaussianBlur(small, (0, 0), blur)


def sample(rng, *, with_ring=True):
    """Return a picture with a ring of about 20 px, noise, blocks and a slope of light."""
    width = rng.uniform(19.0, 21.0)
    picture = ring(width).astype(float) if with_ring else np.full((96, 96), 100.0)
    shift = rng.uniform(-25.0, 25.0, 2) if with_ring else np.zeros(2)
    moved = cv2.warpAffine(
        picture, np.array([[1, 0, shift[0]], [0, 1, shift[1]]]), (96, 96), borderValue=100
    )
    place = 47.5 + shift
    for _ in range(3):
        x, y = rng.integers(0, 80, 2)
        if math.dist((x + 7, y + 7), place) > 26:
            moved[y : y + 14, x : x + 14] = rng.integers(30, 220)
    moved = moved * np.linspace(*rng.uniform(0.6, 1.3, 2), 96) + rng.normal(0.0, 4.0, (96, 96))
    gate = SizeGate(np.array([0.0, 0.0, width]), 1.0, 3.0)
    places = place[None] if with_ring else np.empty((0, 2))
    return Sample(
        np.clip(moved, 0, 255).astype(np.uint8),
        gate,
        (width - 3.0, width + 3.0),
        places,
        np.empty((0, 3)),
    )


@pytest.fixture(scope="module")
def taught():
    rng = np.random.default_rng(1)
    shown = [sample(rng, with_ring=n % 3 > 0) for n in range(120)]
    plan = TrainingPlan(200, 300, 150, 6, StageGoal(most_stumps=12))
    return trained(shown, POOL, plan, seed=2)


def test_a_cascade_learns_to_find_what_it_was_shown(taught):
    rng = np.random.default_rng(7)
    arrays = arrays_of(taught)
    answers = []
    for n in range(40):
        it = sample(rng, with_ring=n % 2 == 0)
        found = objects(it.image, arrays, SIDE, 20.0, it.gate, it.spans)
        answers.append(judged(it, found))
        if answers[-1].right:
            assert found[0].centre == pytest.approx(it.places[0], abs=2.0)
            assert found[0].width == pytest.approx(20.0, abs=3.0)
    assert sum(len(it.right) for it in answers) >= 19
    assert sum(len(it.wrong) for it in answers) <= 2


def test_training_is_a_function_of_the_seed():
    def first_stage():
        rng = np.random.default_rng(1)
        shown = [sample(rng, with_ring=n % 3 > 0) for n in range(20)]
        return trained(shown, POOL, TrainingPlan(30, 50, 40, 1), seed=2)[0].stage

    assert first_stage() == first_stage()


def test_a_file_holds_the_cascade_that_was_trained(taught):
    cascade = cascade_of(taught, 0.34, {"seed": "2"})
    law = ScoreLaw(bias=-2.0, margin=0.5, windows=1.0)
    text = text_of(cascade, law)
    again = HaarCascade.model_validate(json.loads(text))
    assert again == cascade.model_copy(update={"score": law})
    exact, rounded = arrays_of(taught), again.arrays
    np.testing.assert_array_equal(rounded.rectangles, exact.rectangles)
    np.testing.assert_array_equal(rounded.ends, exact.ends)
    np.testing.assert_allclose(rounded.stumps, exact.stumps, rtol=1e-5)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"width": 30.0}, "an object of 30 px does not fit into 24 px"),
        ({"part": [20, 0, 5, 5, 1.0]}, r"a part at \[20, 0\] reaches outside the window"),
        ({"stages": []}, "at least 1"),
    ],
)
def test_a_cascade_that_cannot_be_is_refused(change, says):
    part = change.pop("part", [0, 0, 4, 4, 1.0])
    stump = {"threshold": 0.0, "low": -1.0, "high": 1.0, "parts": [part]}
    data = {
        "haar_cascade": 1, "side": 24, "width": 20.0, "diameter": 0.34,
        "stages": [{"limit": 0.0, "stumps": [stump]}],
    }  # fmt: skip
    with pytest.raises(ValidationError, match=says):
        HaarCascade.model_validate({**data, **change})


def test_windows_near_each_other_are_one_object():
    windows = np.array([[50, 50, 20, 1.0], [54, 50, 20, 3.0], [52, 50, 23, 0.5], [80, 50, 20, 1.0]])
    first, second = grouped(windows)
    assert (first.windows, first.margin) == (3, 3.0)
    assert first.centre == pytest.approx([52.9, 50.0], abs=0.1)
    assert second.centre.tolist() == [80.0, 50.0]


def test_scores_are_how_often_such_a_finding_is_right():
    rng = np.random.default_rng(0)
    margins = rng.uniform(0.0, 4.0, 3000)
    right = rng.random(3000) < 1.0 / (1.0 + np.exp(-(2.0 * margins - 3.0)))
    law = fitted([(m, 1) for m in margins[right]], [(m, 1) for m in margins[~right]])
    assert law.bias == pytest.approx(-3.0, abs=0.3)
    assert law.margin == pytest.approx(2.0, abs=0.2)
    assert law.score(1.5, 1) == pytest.approx(0.5, abs=0.05)
    assert fitted([], []) == ScoreLaw()


def test_without_the_gate_every_size_is_searched():
    camera = Camera(
        width=320, height=240, focal=277.0, mount=Mount(position=(0, 0, 0), tilt_deg=90.0)
    ).model()
    picture = np.random.default_rng(0).integers(90, 110, (240, 320)).astype(np.uint8)
    at = Prior(Transform(IDENTITY, vec(0.0, 0.0, -2.5)), None, 0.0)
    boxes = Haar(gate=False).boxes(Frame(0.0, picture), camera, at)
    assert boxes == ()
    assert Haar().boxes(Frame(0.0, picture), camera, at) == ()
    assert shipped().diameter == 0.34
