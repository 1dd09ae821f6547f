"""Tracked targets in the tick: who `tracked` is, what looks say, and unsound answers."""

from __future__ import annotations

import math

import numpy as np
import pytest
from samples import calm

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.control.controller import Control
from missionkit.engine import target_tracks
from missionkit.engine.flight_state import BehaviorState
from missionkit.engine.prepared_mission import begin, prepare
from missionkit.engine.resume.checkpoint_policy import keepable
from missionkit.engine.sense import sense
from missionkit.engine.target_tracks import TrackingMemory, chosen, fault_of, with_chosen
from missionkit.engine.velocity_law import VelocityLaw
from missionkit.estimation.navigator import NavState
from missionkit.estimation.target_tracking.tracker import MultiTargetTracker
from missionkit.geometry import IDENTITY, Transform, vec
from missionkit.messages import (
    BoxDetection,
    Frame,
    GroundDetection,
    GroundFrame,
    Health,
    Look,
    Mode,
    Observation,
    Step,
    Target,
)
from missionkit.plugin import BoxDetector
from missionkit.plugin_containment import Containment
from missionkit.recorder import message_encoding, value_codec

HERE = np.zeros(3)
DT = 0.05


def robot(number: int, north: float, obstacle: float = 0.1, **other) -> Target:
    name = f"robot_{number}"
    found = Target(name, np.array([north, 0.0, 0.0]), 0.05, None, None, 1.0)
    return found._replace(classes={"target": 1.0 - obstacle, "obstacle": obstacle}, **other)


def named(*robots: Target) -> dict[str, Target]:
    return {it.name: it for it in robots}


NONE = TrackingMemory(None)
NEAR_AND_FAR = named(robot(1, 3.0), robot(2, 2.0), robot(3, 1.0, obstacle=0.9))


def test_the_nearest_that_is_no_obstacle_robot_is_tracked():
    known = chosen(NONE, None, NEAR_AND_FAR, HERE)
    assert with_chosen(NEAR_AND_FAR, known)["tracked"].name == "robot_2"


def test_the_choice_is_kept_while_its_track_lives_and_made_again_afterwards():
    known = chosen(NONE, None, NEAR_AND_FAR, HERE)
    nearer = named(robot(1, 0.5), robot(2, 9.0))
    assert chosen(known, None, nearer, HERE).chosen == "robot_2"
    assert chosen(known, None, named(robot(1, 0.5)), HERE).chosen == "robot_1"


def test_what_a_behaviour_chooses_is_tracked_even_an_obstacle_robot():
    known = chosen(NONE, None, NEAR_AND_FAR, HERE)
    assert chosen(known, "robot_3", NEAR_AND_FAR, HERE).chosen == "robot_3"
    assert chosen(known, "robot_7", NEAR_AND_FAR, HERE).chosen == "robot_2"  # there is none


def test_nothing_is_tracked_once_the_track_is_gone():
    known = chosen(NONE, None, NEAR_AND_FAR, HERE)
    assert with_chosen({}, chosen(known, None, {}, HERE)) == {}


def test_a_look_names_the_robots_that_its_frame_shows():
    targets = with_chosen(NEAR_AND_FAR, TrackingMemory(None, "robot_2"))
    targets["robot_1"] = targets["robot_1"]._replace(seen_at=0.9)
    look = target_tracks.with_detected(Look(1.0, frozenset({"pole"})), targets)
    assert look.seen == {"pole", "robot_2", "robot_3", "tracked"}
    assert target_tracks.with_detected(Look(1.1, frozenset()), targets) == Look(1.1, frozenset())


@pytest.mark.parametrize(
    ("answer", "says"),
    [
        (3, "int"),
        ({"tracked": robot(1, 1.0)}, "'tracked'"),
        ({"robot_2": robot(1, 1.0)}, "'robot_2'"),
        (named(robot(1, math.nan)), "not finite"),
        (named(robot(1, 1.0, heading=math.inf)), "not finite"),
        (named(robot(1, 1.0, velocity=np.zeros(2))), "not finite"),
        (named(robot(1, 1.0, position_sd="wide")), "not finite"),
        (named(robot(1, 1.0)._replace(classes={"target": math.nan})), "not finite"),
    ],
)
def test_an_unsound_answer_is_noted_and_not_used(answer, says):
    assert says in fault_of(answer)

    class Lying:
        kind = "lying"

        def targets(self, memory, now):
            return answer

    contain = Containment()
    assert target_tracks.targets_at(Lying(), NONE, 0.0, contain) == {}
    assert contain.take()[0].startswith("lying returned ")


def test_a_tracker_that_raises_keeps_its_last_memory():
    class Raising:
        kind = "raising"

        def observe(self, memory, frame):
            raise ValueError("no")

    contain = Containment()
    known = TrackingMemory(3)
    assert target_tracks.observed(Raising(), known, GroundFrame(0.0, ()), contain) == known
    assert contain.take() == ("raising raised ValueError: no",)


def watched(tracker: MultiTargetTracker, memory, frames, robots=10):
    """Return the memory after frames that show robots on parallel tracks, 1 m apart."""
    known = TrackingMemory(memory)
    for k in frames:
        seen = tuple(
            GroundDetection(
                "haar", np.array([0.33 * DT * k, float(i)]), 2e-4 * np.eye(2), 0.9, 1.0, 1.0, 2.5
            )
            for i in range(robots)
        )
        known = target_tracks.observed(tracker, known, GroundFrame(k * DT, seen), Containment())
    return known


def test_a_checkpoint_holds_the_tracks_and_is_small():
    tracker = MultiTargetTracker()
    half = watched(tracker, tracker.begin(), range(30))
    text = value_codec.written(half)
    assert len(text) < 200_000
    resumed = value_codec.read(text)
    after = watched(tracker, resumed.tracks, range(30, 40))
    whole = watched(tracker, half.tracks, range(30, 40))
    assert value_codec.written(after) == value_codec.written(whole)
    assert len(tracker.targets(after.tracks, 2.0)) == 10


def test_targets_fade_when_no_frame_comes():
    tracker = MultiTargetTracker()
    known = watched(tracker, tracker.begin(), range(30), robots=1)
    sds = []
    for now in np.arange(1.5, 120.0, 0.5):
        found = target_tracks.targets_at(tracker, known, float(now), Containment())
        sds += [it.position_sd for it in found.values()]
    assert sds == sorted(sds)
    assert max(sds) <= 1.0
    assert not found


class Boxes(BoxDetector):
    """Stands for any detector of boxes; frames bring their own."""

    kind = "boxes"

    def boxes(self, frame, camera, prior):
        return ()


class Hovering:
    """A navigator that hovers 2.5 m above the take-off point."""

    def begin(self):
        return None

    def propagate(self, known, observation):
        return None

    def pose_at(self, known, at):
        return Transform(IDENTITY, vec(0.0, 0.0, -2.5))

    def read(self, known):
        here, still = vec(0.0, 0.0, -2.5), vec(0.0, 0.0, 0.0)
        health = Health(True, False, None, None, 0.1, 0)
        return NavState(here, still, IDENTITY, still, health, {}, np.zeros((15, 15)), still, 0)


WATCHING = """\
missionkit: 1
mission: watching
camera:
  {use: corners, width: 320, height: 240, focal: 277, mount: {position: [0, 0, 0], tilt_deg: 90}}
perception: [boxes]
tracking: {use: tracker}
initial: up
states:
  up: {kind: hover, transitions: [{to: land, when: {use: within, of: tracked, radius: 0.1}}]}
  land: {kind: land}
"""


def sensed(plan, memory, ticks):
    """Return memory and estimate after ticks in which the camera sees one robot drive by."""
    for k in ticks:
        at = k * DT
        centre = np.array([159.5, 119.5 - 277.0 / 2.5 * (0.33 * at - 0.5)])
        box = BoxDetection("haar", centre, (37.0, 37.0), 0.9)
        seen = Observation(at + DT, frame=Frame(at, None, boxes=(box,)))
        senses, estimate = sense(plan, memory, seen, Containment())
        memory = memory._replace(now=seen.now, senses=senses)
    return memory, estimate


def test_what_the_camera_finds_is_a_target_of_the_estimate_and_survives_a_checkpoint():
    catalogue = builtin().extended("detectors", [Boxes])
    plan = prepare(parse(WATCHING, "w.yaml", catalogue), catalogue)
    plan = plan._replace(navigator=Hovering())
    memory, seen = sensed(plan, begin(plan), range(30))
    assert seen.targets["tracked"] is seen.targets["robot_1"]
    assert seen.targets["tracked"].position == pytest.approx([0.33 * 1.5 - 0.5, 0, 0], abs=0.02)
    assert seen.looks[-1].seen == {"robot_1", "tracked"}
    saved = value_codec.read(value_codec.written(memory.senses.tracking))
    resumed = memory._replace(senses=memory.senses._replace(tracking=saved))
    _, after = sensed(plan, resumed, range(30, 40))
    _, whole = sensed(plan, memory, range(30, 40))
    assert value_codec.written(after.targets) == value_codec.written(whole.targets)


def test_a_tracker_whose_memory_cannot_be_saved_restarts_on_resume():
    catalogue = builtin().extended("detectors", [Boxes])
    plan = prepare(parse(WATCHING, "w.yaml", catalogue), catalogue)
    memory = begin(plan)
    memory = memory._replace(senses=memory.senses._replace(tracking=TrackingMemory(object())))
    kept, lost = keepable(plan.chart, memory, value_codec.is_plain)
    assert kept.senses.tracking is None
    assert lost == ("the memory of the tracker cannot be saved: it will restart on resume",)


def test_a_tracked_target_in_view_does_not_vouch_for_the_velocity():
    """It moves, so it corrects nothing that the autopilot could learn from."""
    pole = Target("pole", np.zeros(3), 0.1, None, None, 10.0)
    seen = with_chosen(named(robot(2, 1.0, seen_at=10.0)), TrackingMemory(None, "robot_2"))
    for targets, vouched in ((seen, False), ({**seen, "pole": pole}, True)):
        law = VelocityLaw(Control())
        acting = BehaviorState(law.begin())
        answer = law.command(acting, Mode.GPS, Step(), calm(targets=targets), Containment())
        assert (answer.command.own_velocity is not None) is vouched


def test_the_record_names_each_tracked_target_once():
    seen = with_chosen(NEAR_AND_FAR, TrackingMemory(None, "robot_2"))
    text = message_encoding.estimate("0", calm(targets=seen))
    assert text.count('"name":"robot_2"') == 1
    assert text.count('"name":') == 3
