"""Detectors of other packages: any feeds the eye, and none that misbehaves ends a flight."""

import math

import numpy as np
import pytest
from perception.scenes import (
    CAMERA,
    LEVEL,
    corners_of,
    marker_at,
    noisy,
    priors,
    seen_from,
    with_corners,
)
from rehearsed import MISSIONS

from missionkit import Detector, Prior, Sighting
from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import builtin
from missionkit.engine.prepared_mission import begin, prepare
from missionkit.engine.tick import tick
from missionkit.errors import UsageError
from missionkit.geometry import Transform, vec
from missionkit.messages import Frame, Observation
from missionkit.perception.aruco import Aruco
from missionkit.perception.marker_search import MarkerSearch, Priors
from missionkit.perception.vision_pipeline import VisionPipeline
from missionkit.plugin import Plugin
from missionkit.plugin_containment import Containment

SPOT = marker_at(6.0, 0.5, 0.2)


class Foreign(Detector):
    """Finds a marker by its own means, and misbehaves on request."""

    kind = "foreign"
    how: str = "well"

    def detect(self, frame: Frame, camera, prior: Prior) -> tuple[Sighting, ...]:
        own = Aruco(target=self.target, id=23, size=0.4)
        targets = {} if prior.target is None else {self.target: prior.target}
        found = tuple(
            MarkerSearch(camera, [own]).find(frame, Priors(lambda _: prior.body, targets, None))
        )
        (first,) = found
        if self.how == "raise":
            raise ValueError("no idea")
        nowhere = Transform(first.pose.rotation, vec(math.nan, 0.0, 0.0))
        return {
            "well": found,
            "list": list(found),
            "text": ("there",),
            "nan": (first._replace(pose=nowhere),),
            "sure": (first._replace(position_sd=0.0),),
            "other": (first._replace(target="gate"),),
            "late": (first._replace(at=first.at - 1.0),),
        }[self.how]


def frame():
    corners = corners_of(seen_from(LEVEL, SPOT), 0.4)
    return with_corners(2.0, (23, noisy(corners, np.random.default_rng(0))))


def seen_by(detector, contain=None):
    eye = VisionPipeline(CAMERA, [detector])
    return eye.look(eye.begin(), frame(), priors(), contain)[:3]


def test_the_eye_sees_by_any_detector_what_it_sees_by_its_own():
    _, looks, (theirs,) = seen_by(Foreign(target="trunk"))
    _, same, (ours,) = seen_by(Aruco(target="trunk", id=23, size=0.4))
    assert looks == same
    assert theirs.pose.translation.tolist() == ours.pose.translation.tolist()
    assert theirs._replace(pose=None, detection=None) == ours._replace(pose=None, detection=None)


@pytest.mark.parametrize(
    ("how", "why"),
    [
        ("raise", "raised ValueError: no idea"),
        ("list", "returned list, expected a tuple of Sightings"),
        ("text", "returned a tuple with str, expected a Sighting"),
        ("nan", "returned a sighting with pose of a wrong type or not finite"),
        ("sure", "returned a sighting with position_sd of a wrong type or not finite"),
        ("other", "returned a sighting of 'gate', but it looks for 'trunk'"),
        ("late", "returned a sighting at another time than the frame's"),
    ],
)
def test_what_a_detector_does_wrong_is_noted_and_nothing_is_seen(how, why):
    contain = Containment()
    _, looks, sightings = seen_by(Foreign(target="trunk", how=how), contain)
    assert contain.take() == (f"foreign {why}",)
    assert sightings == ()
    assert [look.seen for look in looks] == [frozenset()]


def catalogue():
    return builtin().with_class(Foreign)


def test_a_mission_names_it_and_a_tick_contains_it(tmp_path):
    text = (MISSIONS / "precision_task.yaml").read_text()
    start = text.index("perception:")
    end = text.index("\n\n", start)
    (tmp_path / "worlds").mkdir()
    (tmp_path / "worlds" / "orchard.yaml").write_text(
        (MISSIONS / "worlds" / "orchard.yaml").read_text()
    )
    path = tmp_path / "mission.yaml"
    use = "perception: [{use: foreign, target: trunk, how: raise}]"
    path.write_text(text[:start] + use + text[end:])
    plan = prepare(load(path, catalogue()), catalogue())
    assert plan.law.brake is plan.law.field
    contain = Containment()
    seen = Observation(0.05, frame=frame().frame)
    done = tick(plan, begin(plan), seen, contain)
    assert "foreign raised ValueError: no idea" in done.record.problems


class Blind(Plugin):
    """Is no detector."""

    kind = "blind"


def test_a_class_without_its_methods_is_refused():
    with pytest.raises(UsageError, match="Blind has no method of a plug-in"):
        builtin().with_class(Blind)
