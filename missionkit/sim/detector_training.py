"""Training detectors of ground robots on rendered pictures, and testing them on others."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np

from missionkit.perception import score_law
from missionkit.perception.detector_sample import Judged, Sample, judged
from missionkit.perception.haar import features, training, window_search
from missionkit.perception.haar.cascade import HaarCascade
from missionkit.perception.haar.cascade_file import cascade_of
from missionkit.perception.haar.cascade_file import text_of as cascade_text
from missionkit.perception.haar.features import SIDE
from missionkit.perception.haar.training import INNER, TrainingPlan
from missionkit.perception.score_law import ScoreLaw
from missionkit.perception.size_pyramid import Found
from missionkit.perception.template import matching
from missionkit.perception.template import training as template_training
from missionkit.perception.template.template_set import TemplateSet
from missionkit.perception.template.training import templates_of
from missionkit.perception.template.training import text_of as template_text
from missionkit.sim.detector_samples import samples, variations_of
from missionkit.sim.robot_look import ROBOT
from missionkit.sim.robot_views import Domain

CALIBRATION, TESTS = 1, 2  # added to the seed: pictures of their own
TEMPLATES: Final = 20

Report = Callable[[str], None]
Find = Callable[[Sample], Sequence[Found]]


class Order(NamedTuple):
    """What to train."""

    domain: Domain
    pictures: int
    plan: TrainingPlan
    seed: int

    @property
    def words(self) -> dict[str, str]:
        """The same for the reader of the file."""
        return {
            "pictures": str(self.pictures),
            "positives": str(self.plan.positives),
            "negatives": str(self.plan.negatives),
            "floors": ", ".join(it.world for it in self.domain.worlds),
            "seed": str(self.seed),
        }


class DetectionRow(NamedTuple):
    """How a detector did on pictures of one kind."""

    name: str
    pictures: int
    robots: int
    found: int
    false: int


def haar_cascade(order: Order, report: Report) -> str:
    """Return a trained cascade as the text of its file.

    Args:
        order: what to train.
        report: receives progress, a line at a time.

    Raises:
        ValueError: the pictures show no robot, or nothing that could be taken for one.
    """
    shown = list(samples(order.domain, order.pictures, order.seed))
    stages = training.trained(shown, features.pool(), order.plan, order.seed, report)
    if not stages:
        raise ValueError("nothing in the pictures could be taken for a robot: show more floor")
    cascade = cascade_of(stages, ROBOT.diameter, order.words)
    find = haar_finder(cascade)
    return cascade_text(cascade, _law([judged(it, find(it)) for it in _fresh(order)]))


def robot_templates(order: Order, report: Report) -> str:
    """Return trained templates as the text of their file.

    Args:
        order: what to train.
        report: receives progress, a line at a time.

    Raises:
        ValueError: the pictures show no robot.
    """
    shown = list(samples(order.domain, order.pictures, order.seed))
    rng = np.random.default_rng(order.seed)
    patches = training.positives(shown, order.plan.positives, rng)
    pictures = templates_of(patches, TEMPLATES, rng)
    report(f"{len(pictures)} templates from {len(patches)} objects")
    inner = INNER * template_training.SIDE / SIDE
    found = template_text(pictures, inner, ROBOT.diameter, ScoreLaw(), order.words)
    find = template_finder(TemplateSet.model_validate(json.loads(found)))
    law = _law([judged(it, find(it)) for it in _fresh(order)])
    return template_text(pictures, inner, ROBOT.diameter, law, order.words)


KINDS: Final[Mapping[str, Callable[[Order, Report], str]]] = {
    "haar": haar_cascade,
    "template": robot_templates,
}
"""What can be trained: kind of detector -> the text of its file."""


def haar_finder(cascade: HaarCascade) -> Find:
    """Return what finds objects in a sample by a cascade."""
    side, inner, arrays = cascade.side, cascade.width, cascade.arrays
    return lambda it: window_search.objects(it.image, arrays, side, inner, it.gate, it.spans)


def template_finder(templates: TemplateSet) -> Find:
    """Return what finds objects in a sample by templates."""
    pictures, inner = templates.arrays, templates.width
    return lambda it: matching.objects(it.image, pictures, inner, it.gate, it.spans)


def finder(kind: str, text: str) -> tuple[Find, ScoreLaw]:
    """Return what finds objects by a trained file, and the law of its scores."""
    if kind == "haar":
        cascade = HaarCascade.model_validate(json.loads(text))
        return haar_finder(cascade), cascade.score
    templates = TemplateSet.model_validate(json.loads(text))
    return template_finder(templates), templates.score


def _fresh(order: Order) -> Iterator[Sample]:
    """Yield the pictures that the scores are calibrated with."""
    return samples(order.domain, max(order.pictures // 2, 1), order.seed + CALIBRATION)


def _law(answers: Sequence[Judged]) -> ScoreLaw:
    return score_law.fitted(
        [it for answer in answers for it in answer.right],
        [it for answer in answers for it in answer.wrong],
    )


def tested(
    kind: str, text: str, domain: Domain, pictures: int, seed: int, least: float
) -> Iterator[DetectionRow]:
    """Yield how a trained file does on worlds that differ from those it was trained on.

    Args:
        kind: of detector.
        text: of its file.
        domain: what it was trained on.
        pictures: of each kind.
        seed: of the training; the tests have pictures of their own.
        least: score of what counts.
    """
    find, law = finder(kind, text)
    for name, other in variations_of(domain).items():
        fresh = samples(other, pictures, seed + TESTS)
        yield row(name, [counted(judged(it, find(it)), law, least) for it in fresh])


def counted(answer: Judged, law: ScoreLaw, least: float) -> Judged:
    """Return what counts of what was found.

    Args:
        answer: all that was found.
        law: of its scores.
        least: score.
    """

    def sure(found: Sequence[tuple[float, int]]) -> list[tuple[float, int]]:
        return [it for it in found if law.score(*it) >= least]

    right = sure(answer.right)
    missed = answer.missed + len(answer.right) - len(right)
    return Judged(right, sure(answer.wrong), missed)


def row(name: str, answers: Sequence[Judged]) -> DetectionRow:
    """Return the sums over pictures."""
    found = sum(len(it.right) for it in answers)
    missed = sum(it.missed for it in answers)
    false = sum(len(it.wrong) for it in answers)
    return DetectionRow(name, len(answers), found + missed, found, false)
