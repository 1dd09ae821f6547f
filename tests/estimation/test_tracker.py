"""The tracker: birth, confirmation, coasting, death, identity, late frames, and bad input."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import chi2

from missionkit.estimation.target_tracking.association import MOST_DETECTIONS, fused, usable
from missionkit.estimation.target_tracking.heading_start import Place, first_state
from missionkit.estimation.target_tracking.tracker import MultiTargetTracker, Tracker, inside
from missionkit.ground_robot import GroundRobot
from missionkit.messages import GroundDetection, GroundFrame

ROBOT = GroundRobot()
DT, SD = 0.05, 0.0135
GROUND = 0.3  # m, down
R = SD**2 * np.eye(2)


def at(north: float, east: float, by: str = "haar", score: float = 0.8, **other) -> GroundDetection:
    seen = GroundDetection(by, np.array([north, east]), R, score, 1.0, 0.5, 2.5)
    return seen._replace(**other)


def drives(k: int, north: float = 0.0, east: float = 0.0, heading: float = 0.4):
    """Where a robot is at frame k."""
    way = ROBOT.speed * DT * k
    return north + way * math.cos(heading), east + way * math.sin(heading)


def made(**settings) -> Tracker:
    return Tracker(MultiTargetTracker(**settings), ROBOT)


def watched(tracker: Tracker, frames, known=None):
    known = known or tracker.begin()
    for k, detections in frames:
        known = tracker.observe(known, GroundFrame(k * DT, tuple(detections), ground=GROUND))
    return known


def seen_driving(tracker: Tracker, frames: int, seed: int = 0):
    noise = np.random.default_rng(seed).normal(0.0, SD, (frames, 2))
    return watched(tracker, ((k, [at(*(drives(k) + noise[k]))]) for k in range(frames)))


def test_a_robot_is_found_with_its_heading_speed_and_mode():
    tracker = made()
    known = seen_driving(tracker, 40)
    (robot,) = tracker.targets(known, 39 * DT).values()
    assert robot.position == pytest.approx([*drives(39), GROUND], abs=0.02)
    assert robot.heading == pytest.approx(0.4, abs=0.1)
    assert robot.velocity == pytest.approx(
        0.33 * np.array([math.cos(0.4), math.sin(0.4), 0]), abs=0.04
    )
    assert robot.modes["straight"] + robot.modes["circling"] > 0.95
    assert robot.confidence == 1.0
    assert 0.003 < robot.position_sd < SD
    assert sum(robot.classes.values()) == pytest.approx(1.0)


@pytest.mark.parametrize(("score", "needed"), [(1.0, 2), (0.8, 3), (0.5, 4)])
def test_a_track_is_confirmed_when_its_scores_suffice(score, needed):
    tracker = made()
    known = tracker.begin()
    for k in range(needed):
        assert not tracker.targets(known, k * DT)
        known = watched(tracker, [(k, [at(*drives(k), score=score)])], known)
    assert len(tracker.targets(known, needed * DT)) == 1


def test_two_detectors_together_confirm_sooner_than_one():
    both = [at(0.0, 0.0, score=0.6), at(0.01, 0.0, by="template", score=0.5)]
    (seen,) = fused(usable(both), 0.17)
    assert seen.score == pytest.approx(0.8)
    assert seen.position == pytest.approx([0.005, 0.0])
    np.testing.assert_allclose(seen.covariance, R)  # the same pixels: no surer than one of them


def test_detections_of_one_detector_or_far_apart_are_two_objects():
    assert len(fused([at(0.0, 0.0), at(0.01, 0.0)], 0.17)) == 2
    assert len(fused([at(0.0, 0.0), at(0.3, 0.0, by="template")], 0.17)) == 2


def test_a_false_alarm_is_never_a_target():
    tracker = made()
    rng = np.random.default_rng(0)
    known = tracker.begin()
    for k in range(200):
        known = watched(tracker, [(k, [at(*rng.uniform(-2, 2, 2), score=0.6)])], known)
        assert not tracker.targets(known, k * DT)


def test_it_coasts_while_it_is_hidden_and_comes_back_as_the_same():
    tracker = made()
    known = seen_driving(tracker, 40)
    (before,) = tracker.targets(known, 39 * DT).values()
    known = watched(tracker, ((k, []) for k in range(40, 55)), known)
    (robot,) = tracker.targets(known, 54 * DT).values()
    assert robot.position[:2] == pytest.approx(drives(54), abs=0.1)
    assert robot.position_sd > 3.0 * before.position_sd
    assert robot.confidence == pytest.approx(0.5)
    known = watched(tracker, ((k, [at(*drives(k))]) for k in range(55, 60)), known)
    assert list(tracker.targets(known, 59 * DT)) == ["robot_1"]


def test_it_ends_once_it_should_have_been_seen_for_a_second():
    tracker = made()
    known = seen_driving(tracker, 40)
    known = watched(tracker, ((k, []) for k in range(40, 59)), known)
    assert tracker.targets(known, 58 * DT)
    known = watched(tracker, ((k, []) for k in range(59, 62)), known)
    assert not tracker.targets(known, 61 * DT)


def test_one_detection_among_many_misses_keeps_it_alive():
    tracker = made()
    known = seen_driving(tracker, 40)
    known = watched(
        tracker, ((k, [at(*drives(k))] if k % 15 == 9 else []) for k in range(40, 100)), known
    )
    assert list(tracker.targets(known, 99 * DT)) == ["robot_1"]


def test_a_second_box_on_a_robot_that_is_tracked_begins_nothing():
    tracker = made()
    known = seen_driving(tracker, 20)
    known = watched(
        tracker, ((k, [at(*drives(k)), at(*drives(k, east=0.12))]) for k in range(20, 40)), known
    )
    assert list(tracker.targets(known, 39 * DT)) == ["robot_1"]


def test_outside_the_view_it_lives_as_long_as_its_place_is_known():
    tracker = made()
    known = seen_driving(tracker, 40)
    view = np.array([[50.0, 50.0], [51.0, 50.0], [51.0, 51.0], [50.0, 51.0]])
    ends = None
    for k in range(40, 2000):
        known = tracker.observe(known, GroundFrame(k * DT, (), view))
        if not tracker.targets(known, k * DT):
            ends = (k - 40) * DT
            break
        assert tracker.targets(known, k * DT)["robot_1"].confidence == 1.0
    assert ends is not None
    assert 2.0 < ends < 60.0


def test_a_late_frame_is_taken_in_at_its_own_time():
    tracker = made()
    frames = [GroundFrame(k * DT, (at(*drives(k)),)) for k in range(40)]
    known = tracker.begin()
    for frame in frames:
        known = tracker.observe(known, frame)
    shuffled = frames[:30] + [frames[i] for i in (33, 30, 32, 31, 34, 37, 39, 36, 35, 38)]
    other = tracker.begin()
    for frame in shuffled:
        other = tracker.observe(other, frame)
    for one, two in zip(known.now.tracks, other.now.tracks, strict=True):
        np.testing.assert_array_equal(one.state.X, two.state.X)
    late = tracker.observe(known, frames[3])
    assert (late.now, late.late) == (known.now, 1)


def test_a_target_is_where_it_is_now_though_its_image_took_a_while():
    tracker = made()
    known = seen_driving(tracker, 60)
    (robot,) = tracker.targets(known, 62 * DT).values()
    assert robot.position[:2] == pytest.approx(drives(62), abs=0.02)


BAD = [
    at(math.nan, 0.0),
    at(0.0, math.inf),
    at(0.0, 0.0, covariance=np.full((2, 2), math.nan)),
    at(0.0, 0.0, covariance=np.zeros((2, 2))),
    at(0.0, 0.0, covariance=-R),
    at(0.0, 0.0, score=math.nan),
    at(0.0, 0.0, score=1.5),
    at(0.0, 0.0, size=math.nan),
    at(0.0, 0.0, size=-1.0),
    at(0.0, 0.0, offset=math.inf),
    at(0.0, 0.0, height=math.nan),
    at(0.0, 0.0, position=np.zeros(3)),
    at(1e300, 0.0),
]


@pytest.mark.parametrize("bad", BAD)
def test_what_is_no_detection_never_touches_a_track(bad):
    tracker = made()
    known = seen_driving(tracker, 20)
    good = at(*drives(20))
    clean = watched(tracker, [(20, [good])], known)
    with_bad = watched(tracker, [(20, [bad, good])], known)
    assert with_bad.refused == 1
    for one, two in zip(clean.now.tracks, with_bad.now.tracks, strict=True):
        np.testing.assert_array_equal(one.state.X, two.state.X)
    never = tracker.observe(known, GroundFrame(math.nan, (good,)))
    assert never.now is known.now


def test_only_the_surest_20_detections_of_a_frame_are_looked_at():
    found = [at(float(i), 0.0, score=0.5 + 0.01 * i) for i in range(30)]
    assert [it.score for it in usable(found)] == [it.score for it in found[:9:-1]]
    assert len(usable(found)) == MOST_DETECTIONS


def test_twenty_robots_keep_twenty_identities():
    tracker, rng = made(), np.random.default_rng(1)
    starts = [(2.0 * (i % 5), 2.0 * (i // 5), 0.6 * i) for i in range(20)]
    known = tracker.begin()
    names = []
    for k in range(60):
        found = [at(*(np.array(drives(k, *s)) + rng.normal(0, SD, 2))) for s in starts]
        known = watched(tracker, [(k, [found[i] for i in rng.permutation(20)])], known)
        if k in (5, 59):
            targets = tracker.targets(known, k * DT)
            places = [drives(k, *s) for s in starts]
            names.append(
                [
                    min(targets, key=lambda n, p=p, t=targets: math.dist(t[n].position[:2], p))
                    for p in places
                ]
            )
    assert len(set(names[0])) == 20
    assert names[0] == names[1]


def test_the_tracker_knows_how_uncertain_it_is():
    """Errors over their covariance are chi-squared: 60 robots, each at one moment."""
    tracker, nees = made(), []
    for seed in range(60):
        known = seen_driving(tracker, 40, seed)
        x, P = known.now.tracks[0].state.X[0], known.now.tracks[0].state.P[0]
        e = x - [*drives(39), 0.4]
        nees.append(float(e @ np.linalg.solve(P, e)))
    # Its noise allows for random turns, which these robots do not take: surer than it says.
    assert chi2.ppf(0.005, 180) / 60 / 4 < np.mean(nees) < chi2.ppf(0.995, 180) / 60


def test_a_spin_out_of_view_costs_neither_identity_nor_heading():
    tracker = made()
    known = seen_driving(tracker, 40)
    view = np.array([[50.0, 50.0], [51.0, 50.0], [51.0, 51.0], [50.0, 51.0]])
    for k in range(40, 89):  # it spins where it was seen last
        known = tracker.observe(known, GroundFrame(k * DT, (), view))
    back = [drives(k, *drives(39), heading=0.4 + math.pi) for k in range(60)]
    known = watched(tracker, ((89 + k, [at(*back[k])]) for k in range(60)), known)
    (robot,) = tracker.targets(known, 148 * DT).values()
    assert robot.name == "robot_1"
    assert math.cos(robot.heading - 0.4 - math.pi) > math.cos(0.1)


def test_no_heading_is_made_up_for_a_robot_that_stands_or_spins():
    still = [Place(k * DT, np.array([1.0, 2.0]), R) for k in range(12)]
    assert first_state(still, ROBOT.speed) is None
    assert first_state(still[:3], ROBOT.speed) is None
    moving = [Place(k * DT, np.array(drives(k)), R) for k in range(12)]
    x, P = first_state(moving, ROBOT.speed)
    assert x == pytest.approx([*drives(11), 0.4])
    assert math.degrees(math.sqrt(P[2, 2])) == pytest.approx(4.0, abs=1.5)


def test_the_static_estimator_tracks_places_alone():
    tracker = made(estimator="static")
    (robot,) = tracker.targets(seen_driving(tracker, 40), 39 * DT).values()
    assert robot.heading is None
    assert robot.velocity is None
    assert robot.position[:2] == pytest.approx(drives(39), abs=0.05)


def test_filterpy_tracks_as_the_kernels_do():
    ours, theirs = seen_driving(made(), 15), seen_driving(made(library="filterpy"), 15)
    for one, two in zip(ours.now.tracks, theirs.now.tracks, strict=True):
        np.testing.assert_allclose(one.state.X, two.state.X, atol=1e-9)


def test_a_place_is_inside_a_polygon_whichever_way_round_it_goes():
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    for polygon in (square, square[::-1]):
        assert inside(np.array([0.5, 0.9]), polygon)
        assert not inside(np.array([0.5, 1.1]), polygon)
    assert inside(np.array([9.0, 9.0]), None)


def test_a_detector_that_takes_it_for_an_obstacle_robot_decides_its_class():
    tracker = made()
    frames = [
        (
            k,
            [
                at(*drives(k), sized=False, kind="robot"),
                at(*drives(k), by="tower", kind="obstacle"),
            ],
        )
        for k in range(0, 20)
    ]
    (robot,) = tracker.targets(watched(tracker, frames), 19 * DT).values()
    assert robot.classes["obstacle"] > 0.99


def test_a_size_that_was_searched_for_is_not_taken_for_a_measured_one():
    tracker = made()
    far = {"offset": 1.5, "height": 2.5}  # where a tower would make a box larger
    likely = {}
    for sized in (True, False):
        frames = [(k, [at(*drives(k), sized=sized, kind="robot", **far)]) for k in range(5)]
        (robot,) = tracker.targets(watched(tracker, frames), 4 * DT).values()
        likely[sized] = robot.classes["obstacle"]
    assert likely[True] < 0.02
    assert 0.1 < likely[False] < 0.3


def test_detections_of_two_kinds_by_one_detector_are_one_object():
    (one,) = fused([at(0.0, 0.0, kind="robot"), at(0.05, 0.0, kind="obstacle")], 0.17)
    assert one.kind == "obstacle"
    sized = [at(0.0, 0.0, size=1.8), at(0.05, 0.0, by="tower", size=1.0, sized=False)]
    (one,) = fused(sized, 0.17)
    assert (one.size, one.sized) == (1.8, True)
