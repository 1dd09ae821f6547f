"""Training a cascade: positives, negatives that the stages so far pass, and one stage more."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

import numpy as np

from missionkit.messages import Image
from missionkit.perception.detector_sample import Sample, shows
from missionkit.perception.haar.cascade import CascadeArrays
from missionkit.perception.haar.features import SIDE, Features, Patches
from missionkit.perception.haar.gentle_boost import Stage, StageGoal, boosted
from missionkit.perception.haar.window_search import STRIDE, passing
from missionkit.perception.size_pyramid import LEAST_SD, level_of, widths

INNER: Final = 20.0  # px, of the object in the window
SIZE_SD: Final = 0.05  # of positives, relative
PER_IMAGE: Final = 12  # negatives at most, of one image in one stage


class TrainingPlan(NamedTuple):
    """How much is trained with."""

    positives: int = 2000
    negatives: int = 3000
    features: int = 2500  # tried in each stage, drawn from all
    stages: int = 16  # at most
    goal: StageGoal = StageGoal()


class TrainedStage(NamedTuple):
    """A stage, and the features that its stumps use."""

    stage: Stage
    features: Features


def positives(samples: Sequence[Sample], count: int, rng: np.random.Generator) -> Patches:
    """Return windows around objects, (n, SIDE, SIDE): about in the middle, about of that size.

    Args:
        samples: pictures.
        count: of windows; an object may give several.
        rng: shifts and scales them a little.

    Raises:
        ValueError: no picture shows a whole object.
    """
    patches: list[Image] = []
    while len(patches) < count:
        before = len(patches)
        for sample in samples:
            for place in sample.places:
                width = sample.gate.width(*place.tolist()) * np.exp(rng.normal(0.0, SIZE_SD))
                level = level_of(sample.image, width, sample.gate.aspect, INNER, SIDE)
                left, top = level.windows_at(place, SIDE)
                left, top = left + int(rng.integers(-1, 2)), top + int(rng.integers(-1, 2))
                patch = level.image[max(top, 0) : top + SIDE, max(left, 0) : left + SIDE]
                if patch.shape == (SIDE, SIDE):
                    patches.append(patch)
        if len(patches) == before:
            raise ValueError("no picture shows a whole object")
    return np.array(patches[:count])


def negatives(
    samples: Sequence[Sample],
    stages: Sequence[TrainedStage],
    count: int,
    rng: np.random.Generator,
) -> Patches:
    """Return windows away from objects that all stages so far pass.

    Args:
        samples: pictures, looked at in this order.
        stages: so far.
        count: at most.
        rng: chooses among the windows of a picture.
    """
    arrays = arrays_of(stages)
    patches: list[Image] = []
    for sample in samples:
        spread = [*widths(0.75 * sample.spans[0], 1.3 * sample.spans[1])]
        level = level_of(
            sample.image, spread[int(rng.integers(len(spread)))], sample.gate.aspect, INNER, SIDE
        )
        free = sample.gate._replace(margin=np.inf)
        found = passing(level, arrays, SIDE, free, STRIDE)
        away = [it for it in found if not shows(sample, it[:2], level.width)]
        chosen = rng.permutation(len(away))[:PER_IMAGE]
        for i in chosen.tolist():
            left, top = level.windows_at(away[i][:2], SIDE)
            patches.append(level.image[top : top + SIDE, left : left + SIDE])
        if len(patches) >= count:
            break
    return np.array(patches[:count], np.uint8).reshape(-1, SIDE, SIDE)


def trained(
    samples: Sequence[Sample],
    pool: Features,
    plan: TrainingPlan,
    seed: int,
    report: Callable[[str], None] = lambda _: None,
) -> list[TrainedStage]:
    """Return the stages of a cascade.

    It ends when the pictures hold too few windows that are wrongly passed for another stage.

    Args:
        samples: pictures with and without objects.
        pool: features to choose from.
        plan: how much is trained with.
        seed: of all chance.
        report: receives a line for each stage.
    """
    from missionkit.perception.haar.kernels import values  # noqa: PLC0415 compiles

    rng = np.random.default_rng(seed)
    good = positives(samples, plan.positives, rng)
    stages: list[TrainedStage] = []
    bad = np.empty((0, SIDE, SIDE), np.uint8)
    while len(stages) < plan.stages:
        order = [samples[i] for i in rng.permutation(len(samples)).tolist()]
        more = negatives(order, stages, plan.negatives - len(bad), rng)
        bad = np.concatenate([bad, more])
        if len(bad) < max(50, plan.negatives // 20):
            break
        drawn = pool.only(rng.permutation(len(pool.weights))[: plan.features])
        patches = np.concatenate([good, bad])
        y = np.concatenate([np.ones(len(good)), -np.ones(len(bad))])
        V = values(patches, *drawn, LEAST_SD)
        stage = boosted(V, y, plan.goal)
        used = np.array([it.feature for it in stage.stumps])
        F = np.sum([it.answers(V[it.feature]) for it in stage.stumps], axis=0)
        stages.append(TrainedStage(stage, drawn.only(used)))
        report(
            f"stage {len(stages)}: {len(stage.stumps)} features; of {len(good)} objects "
            f"{(F[y > 0] >= stage.limit).mean():.2%} pass, of {len(bad)} others "
            f"{(F[y < 0] >= stage.limit).mean():.2%}"
        )
        good, bad = good[F[y > 0] >= stage.limit], bad[F[y < 0] >= stage.limit]
    return stages


def arrays_of(stages: Sequence[TrainedStage]) -> CascadeArrays:
    """Return stages for `kernels.search`; none pass everything."""
    stumps = [it for trained in stages for it in trained.stage.stumps]
    return CascadeArrays(
        np.concatenate([np.zeros((0, 3, 4), np.int32), *(it.features.rectangles for it in stages)]),
        np.concatenate([np.zeros((0, 3)), *(it.features.weights for it in stages)]),
        np.array([it[1:] for it in stumps]).reshape(-1, 3),
        np.cumsum([len(it.stage.stumps) for it in stages]).astype(np.int32),
        np.array([it.stage.limit for it in stages]),
    )
