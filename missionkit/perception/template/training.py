"""Templates from windows around objects: the means of groups that look alike."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Final

import cv2
import numpy as np
import numpy.typing as npt

from missionkit.perception.haar.features import Patches
from missionkit.perception.score_law import ScoreLaw
from missionkit.perception.template.template_set import TemplateSet

SIDE: Final = 16  # px
ROUNDS: Final = 30


def templates_of(patches: Patches, count: int, rng: np.random.Generator) -> Patches:
    """Return `count` templates (count, SIDE, SIDE), by k-means on the sphere of correlations.

    Source: I. Dhillon, D. Modha, "Concept Decompositions for Large Sparse Text Data Using
    Clustering", 2001.

    Args:
        patches: (n, any, any), windows around objects.
        count: of templates.
        rng: chooses where the groups begin.
    """
    small = np.array([cv2.resize(it, (SIDE, SIDE), interpolation=cv2.INTER_AREA) for it in patches])
    x = _unit(small.reshape(len(small), -1).astype(np.float64))
    middles = x[rng.permutation(len(x))[:count]]
    for _ in range(ROUNDS):
        nearest = np.argmax(x @ middles.T, axis=1)
        sums = np.array(
            [
                x[nearest == k].sum(axis=0) if (nearest == k).any() else middles[k]
                for k in range(count)
            ]
        )
        middles = _unit(sums)
    largest = np.abs(middles).max(axis=1, keepdims=True)
    levels = np.clip(np.rint(128.0 + 120.0 * middles / largest), 0, 255)
    return np.asarray(levels.reshape(count, SIDE, SIDE), np.uint8)


def _unit(x: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    x = x - x.mean(axis=1, keepdims=True)
    return np.asarray(x / np.maximum(np.linalg.norm(x, axis=1, keepdims=True), 1e-9))


def text_of(
    pictures: Patches, inner: float, diameter: float, score: ScoreLaw, trained: Mapping[str, str]
) -> str:
    """Return templates as the text of their file: YAML that is JSON as well.

    Args:
        pictures: (n, side, side).
        inner: px, of the object in a picture.
        diameter: m, of the object.
        score: the law of its scores.
        trained: from what, for the reader.
    """
    data = TemplateSet.model_validate(
        {
            "templates": 1,
            "side": pictures.shape[1],
            "width": inner,
            "diameter": diameter,
            "pictures": pictures.tolist(),
            "score": score.model_dump(),
            "trained": dict(trained),
        }
    ).model_dump()
    shown = ",\n".join("    " + json.dumps(it) for it in data.pop("pictures"))
    lines = [f"  {json.dumps(key)}: {json.dumps(value)}," for key, value in data.items()]
    return "{\n" + "\n".join(lines) + f'\n  "pictures": [\n{shown}\n  ]\n}}\n'
