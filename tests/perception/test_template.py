"""Normalised cross-correlation against brute force, and what templates are made of."""

from __future__ import annotations

import json

import numpy as np
import pytest
from perception.test_haar_search import ring, sample
from pydantic import ValidationError

from missionkit.perception.detector_sample import judged
from missionkit.perception.haar.training import positives
from missionkit.perception.score_law import ScoreLaw
from missionkit.perception.template.matching import correlation, objects
from missionkit.perception.template.template_set import TemplateSet, shipped
from missionkit.perception.template.training import SIDE, templates_of, text_of


def test_the_best_correlation_of_all_templates_counts():
    rng = np.random.default_rng(0)
    image = rng.integers(0, 256, (30, 34)).astype(np.uint8)
    image[5:25, 5:25] = 80
    templates = rng.integers(0, 256, (3, 8, 8)).astype(np.float32)
    r = correlation(image, templates)
    assert r.shape == (23, 27)
    for top, left in ((0, 0), (3, 20), (22, 26), (15, 1)):
        window = image[top : top + 8, left : left + 8].astype(float).ravel()
        expected = max(np.corrcoef(window, it.ravel())[0, 1] for it in templates)
        assert r[top, left] == pytest.approx(expected, abs=1e-4)
    assert r[10, 10] == 0.0  # a flat window looks like nothing
    brighter = correlation((image // 2 + 60).astype(np.uint8), templates)
    assert np.abs(brighter - correlation(image // 2 * 2, templates)).max() < 1e-3


def test_templates_are_the_looks_that_objects_have():
    rng = np.random.default_rng(3)
    light = np.array([ring(20.0)[36:60, 36:60] for _ in range(30)]).astype(float)
    dark = 230.0 - light
    patches = np.concatenate([light, dark]) * rng.uniform(0.5, 1.0, (60, 1, 1))
    patches = np.clip(patches + rng.normal(0.0, 8.0, patches.shape), 0, 255).astype(np.uint8)
    first, second = templates_of(patches, 2, np.random.default_rng(1)).astype(float)
    assert first.shape == (SIDE, SIDE)
    assert np.corrcoef(first.ravel(), second.ravel())[0, 1] < -0.95


def test_objects_are_found_by_their_templates_between_pixels():
    rng = np.random.default_rng(1)
    shown = [sample(rng) for _ in range(40)]
    pictures = templates_of(positives(shown, 80, rng), 3, rng).astype(np.float32)
    answers = []
    for n in range(30):
        it = sample(rng, with_ring=n % 2 == 0)
        found = objects(it.image, pictures, 20.0 * SIDE / 24, it.gate, it.spans)
        sure = [one for one in found if one.margin > 0.8]
        answers.append(judged(it, sure))
        if answers[-1].right:
            assert sure[0].centre == pytest.approx(it.places[0], abs=0.8)
    assert sum(len(it.right) for it in answers) == 15
    assert sum(len(it.wrong) for it in answers) == 0


def test_a_file_holds_the_templates():
    pictures = np.random.default_rng(0).integers(0, 256, (2, SIDE, SIDE)).astype(np.uint8)
    law = ScoreLaw(bias=-15.0, margin=20.0, windows=0.0)
    data = json.loads(text_of(pictures, 13.0, 0.34, law, {"seed": "0"}))
    again = TemplateSet.model_validate(data)
    np.testing.assert_array_equal(again.arrays, pictures)
    assert again.score == law
    assert shipped().side == SIDE
    data["pictures"][1] = data["pictures"][1][:-1]
    with pytest.raises(ValidationError, match="picture 2 is not 16 x 16 px"):
        TemplateSet.model_validate(data)
    data["pictures"][1] = [[7] * SIDE] * SIDE
    with pytest.raises(ValidationError, match="picture 2 is of one grey level"):
        TemplateSet.model_validate(data)
