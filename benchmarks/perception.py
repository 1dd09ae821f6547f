"""From an image to marker poses, on the frames that a precision task sees."""

from __future__ import annotations

from collections import defaultdict
from statistics import median
from typing import NamedTuple

import numpy as np

from benchmarks.flights import ready, warm_up
from benchmarks.measure import Table, seconds, spread, timed
from missionkit.messages import Frame, Image, Observation, Record
from missionkit.perception.blob import Blob
from missionkit.perception.haar.detector import Haar
from missionkit.perception.marker_detector import MarkerDetector
from missionkit.perception.opencv_helpers import encode_jpeg
from missionkit.perception.square_pose import solve
from missionkit.perception.template.detector import Template
from missionkit.plugin_protocols import Prior
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import Stage
from missionkit.sim.camera_renderer import Renderer
from missionkit.sim.detector_samples import TRAINING
from missionkit.sim.ground_truth import TrueState
from missionkit.sim.robot_views import robot_views

EVERY = 5  # ticks between two frames kept
DICTIONARY, ID, SIZE = "DICT_6X6_250", 23, 0.40
EXPOSURE = 0.004  # s
ROBOT_PICTURES = 100
ROBOT_DETECTORS = {
    "haar": Haar(),
    "haar, every size searched": Haar(gate=False),
    "template": Template(),
    "blob": Blob(),
}
COLUMNS = ("p50, ms", "p99, ms", "times haar")


class View(NamedTuple):
    """A frame, and the truth at the tick when it arrived."""

    image: Image
    truth: TrueState


def tables() -> list[Table]:
    """Time rendering, detection and pose on frames from one flight."""
    warm_up()
    at = ready("rendered")
    views = _views(at)
    camera, detector = at.plan.camera, MarkerDetector(DICTIONARY)
    renderer = Renderer(at.world, camera, np.random.default_rng(0))
    times: defaultdict[str, list[float]] = defaultdict(list)
    for image, truth in views:
        found, took = timed(detector.detect, image, {ID})
        times["detect, marker found" if found else "detect, nothing found"].append(took.cpu)
        for it in found:
            times["pose of a marker"].append(seconds(solve, it.corners, SIZE, camera))
        drawn = seconds(renderer.render, truth.pose, truth.velocity, truth.rates, EXPOSURE)
        times["render (simulator)"].append(drawn)
        times["JPEG (recorder, 5 Hz)"].append(seconds(encode_jpeg, image))
    rows = [(name, str(len(took)), *spread(took, 1e3, 2)) for name, took in times.items()]
    note = (
        f"{len(views)} frames of 640x480 px, one in {EVERY} of a precision task. Where nothing is "
        "found the image is looked at twice. Processor time."
    )
    return [Table("Perception", ("work", "times", "p50, ms", "p99, ms"), rows, note), _robots()]


def _robots() -> Table:
    """Time the detectors of ground robots, from 1.5 to 3 m above four floors."""
    domain = TRAINING._replace(height=(1.5, 3.0), robots=8)
    shown = list(robot_views(domain, ROBOT_PICTURES, 7000))
    times: dict[str, list[float]] = {}
    for name, detector in ROBOT_DETECTORS.items():
        asked = [(Frame(0.0, it.image), it.camera, Prior(it.body, None)) for it in shown]
        detector.boxes(*asked[0])
        times[name] = [timed(detector.boxes, *it)[1].cpu for it in asked]
    first = median(times["haar"])
    rows = [
        (name, *spread(took, 1e3, 2), f"{median(took) / first:.1f}") for name, took in times.items()
    ]
    note = f"{ROBOT_PICTURES} pictures of 320x240 px, up to eight robots each. Processor time."
    return Table("Ground robots in a picture", ("detector", *COLUMNS), rows, note)


def _views(at: Stage) -> list[View]:
    views: list[View] = []

    def keep(record: Record, observation: Observation) -> None:
        frame, truth = observation.frame, at.vehicle.truth
        due = round(record.now / at.plan.period) % EVERY == 0
        if due and frame is not None and frame.image is not None and not truth.on_ground:
            views.append(View(frame.image, truth))

    rehearse(at, [keep])
    return views
