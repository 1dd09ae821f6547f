"""From an image to marker poses, on the frames that a precision task sees."""

from __future__ import annotations

from collections import defaultdict
from typing import NamedTuple

import numpy as np

from benchmarks.flights import ready, warm_up
from benchmarks.measure import Table, seconds, spread, timed
from missionkit.messages import Image, Observation, Record
from missionkit.perception.marker_detector import MarkerDetector
from missionkit.perception.opencv_helpers import encode_jpeg
from missionkit.perception.square_pose import solve
from missionkit.rehearsal import Stage, rehearse
from missionkit.sim.camera_renderer import Renderer
from missionkit.sim.ground_truth import TrueState

EVERY = 5  # ticks between two frames kept
DICTIONARY, ID, SIZE = "DICT_6X6_250", 23, 0.40
EXPOSURE = 0.004  # s


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
    return [Table("Perception", ("work", "times", "p50, ms", "p99, ms"), rows, note)]


def _views(at: Stage) -> list[View]:
    views: list[View] = []

    def keep(record: Record, observation: Observation) -> None:
        frame, truth = observation.frame, at.vehicle.truth
        due = round(record.now / at.plan.period) % EVERY == 0
        if due and frame is not None and frame.image is not None and not truth.on_ground:
            views.append(View(frame.image, truth))

    rehearse(at, [keep])
    return views
