"""Detectors of ground robots on rendered pictures: what they find, and how long it takes."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from missionkit.estimation.target_tracking.association import fused, usable
from missionkit.geometry import Mat
from missionkit.messages import BoxDetection, Frame, GroundDetection
from missionkit.perception.detector_sample import Sample, judged
from missionkit.perception.ground_plane import ViewNoise, on_ground
from missionkit.perception.haar.detector import Haar
from missionkit.perception.size_pyramid import Found
from missionkit.perception.square_pose import project
from missionkit.perception.template.detector import Template
from missionkit.plugin import BoxDetector
from missionkit.plugin_protocols import Prior
from missionkit.sim.detector_samples import TRAINING, sample_of, variations_of
from missionkit.sim.robot_look import ROBOT
from missionkit.sim.robot_views import Domain, RobotView, robot_views

ANY = 0.01  # score; nearly everything, so that curves reach far
DOMAIN = TRAINING._replace(height=(1.5, 3.0), robots=8)
GROUPS: Mapping[str, Domain] = variations_of(DOMAIN)
DETECTORS: Mapping[str, BoxDetector] = {
    "haar": Haar(least_score=ANY),
    "template": Template(least_score=ANY),
    "haar, no gate": Haar(least_score=ANY, gate=False),
}
FUSED = ("haar", "template")


class Answers(NamedTuple):
    """What one detector found in the pictures of a group."""

    right: Mat  # scores of robots found
    wrong: Mat  # scores of false detections
    robots: int
    pictures: int
    times: Mat  # s of processor time, of each picture; none for a fusion
    errors: Mat  # m, of the places of the robots found

    def recall(self, least: float) -> float:
        """Return the share of robots that are found with at least that score."""
        return float((self.right >= least).sum()) / max(self.robots, 1)

    def false(self, least: float) -> float:
        """Return false detections a picture."""
        return float((self.wrong >= least).sum()) / self.pictures

    def precision(self, least: float) -> float:
        """Return the share of what is found that is a robot."""
        right, wrong = (self.right >= least).sum(), (self.wrong >= least).sum()
        return float(right / max(right + wrong, 1))

    def least_for(self, false: float) -> float:
        """Return the least score with at most that many false a picture."""
        allowed = int(false * self.pictures)
        if len(self.wrong) <= allowed:
            return 0.0
        return float(np.sort(self.wrong)[::-1][allowed]) + 1e-9


Finder = Callable[[RobotView], Sequence[GroundDetection]]


def group(name: str, pictures: int, seed: int, *, ablation: bool) -> dict[str, Answers]:
    """Return what each detector, and two of them fused, find in the pictures of a group.

    Args:
        name: of the group.
        pictures: number.
        seed: of all chance.
        ablation: search without the gate too.
    """
    names = [it for it in DETECTORS if ablation or it in FUSED]
    tallies = {it: _Tally() for it in (*names, "fused")}
    for view in robot_views(GROUPS[name], pictures, seed):
        sample = sample_of(view)
        if sample is None:
            continue
        places: dict[str, list[GroundDetection]] = {}
        for it in names:
            start = time.process_time()
            boxes = DETECTORS[it].boxes(Frame(0.0, view.image), view.camera, Prior(view.body, None))
            tallies[it].times.append(time.process_time() - start)
            places[it] = _on_ground(boxes, view)
        both = usable([place for it in FUSED for place in places[it]])
        places["fused"] = fused(both, 0.5 * ROBOT.diameter)
        for it, found in places.items():
            tallies[it].add(view, sample, found)
    return {it: tally.answers() for it, tally in tallies.items()}


def _on_ground(boxes: Sequence[BoxDetection], view: RobotView) -> list[GroundDetection]:
    noise = ViewNoise()
    found = (
        on_ground(box, view.camera, view.body, 0.0, noise, ROBOT.diameter, ROBOT.height)
        for box in boxes
    )
    return [it for it in found if it is not None]


class _Tally:
    def __init__(self) -> None:
        self.right: list[float] = []
        self.wrong: list[float] = []
        self.times: list[float] = []
        self.errors: list[float] = []
        self.robots = self.pictures = 0

    def add(self, view: RobotView, sample: Sample, found: Sequence[GroundDetection]) -> None:
        """Judge what was found in one picture."""
        eye = (view.body @ view.camera.mount).inverse()
        tops = [np.array((*it.position, -ROBOT.height)) for it in found]
        pixels = [project(it[None], eye, view.camera)[0] for it in tops]
        as_found = [
            Found(pixel, max(sample.gate.width(*pixel.tolist()), 1.0), it.score, 1)
            for pixel, it in sorted(zip(pixels, found, strict=True), key=lambda it: -it[1].score)
        ]
        answer = judged(sample, as_found)
        self.right += [score for score, _ in answer.right]
        self.wrong += [score for score, _ in answer.wrong]
        self.robots += len(sample.places)
        self.pictures += 1
        spots = np.array([robot[:2] for robot in view.robots]).reshape(-1, 2)
        for it in found:
            off = np.hypot(*(spots - it.position).T).min(initial=9.0)
            self.errors += [float(off)] if off < 0.5 * ROBOT.diameter else []

    def answers(self) -> Answers:
        """Return the sums."""
        scores = (np.array(self.right), np.array(self.wrong))
        return Answers(
            *scores, self.robots, self.pictures, np.array(self.times), np.array(self.errors)
        )
