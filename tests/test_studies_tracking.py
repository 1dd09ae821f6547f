"""The study of tracking: its runs, its page, and its picture."""

from __future__ import annotations

import math

import numpy as np
import pytest

from missionkit.sim.ground_robots import SPIN_LEFT
from studies import tracking
from studies.tracking_flight import SPINS_AT, Followed, path
from studies.tracking_runs import Single, classified, crossing, driven, singles
from studies.tracking_scene import PERIOD, ROBOT, Scene, Watcher, above


def made(delay: float) -> Single:
    """A run whose errors are known: 1 cm and 2 deg, 2 cm and 4 deg after its one spin."""
    straight = np.tile([0.01, math.radians(2.0)], (100, 1))
    after = np.tile([0.02, math.radians(4.0)], (60, 1))
    return Single((delay,), 0, straight, after, np.full((1, 3), 0.1), (1, 1000))


def flown() -> Followed:
    times = np.arange(0.0, 60.0, 1.0)
    zeros = np.zeros(60)
    return Followed(times, zeros, zeros, zeros, zeros, np.full((60, 2), 17.0))


def test_the_page_holds_the_results_and_the_picture_is_drawn(tmp_path, monkeypatch):
    monkeypatch.setattr(tracking, "followed", lambda *_: flown())
    runs = [dict.fromkeys(("imm", "mmae", "static"), made(0.1 + 0.001 * i)) for i in range(100)]
    classes = {("target", 3.0): [0.0] * 99 + [0.9], ("obstacle robot", 3.0): [1.0, math.nan]}
    found = tracking.Results(
        runs, [flown()], {next(iter(tracking.SCENES)): ["kept"] * 200}, classes
    )
    tracking.write(found, 45.0, tmp_path, "the command")
    text = (tmp_path / "tracking.md").read_text()
    assert "$" not in text
    assert "1.00 cm and 2.0 deg rms" in text
    assert "95 % within 0.19 s" in text
    assert "0.100 % of the other frames" in text
    assert "Class wrong after 3 s: 2 of 102" in text  # a robot that is not tracked counts
    assert "200 of 200" in text
    assert "at most 17 px" in text
    assert (tmp_path / "tracking.png").stat().st_size > 20_000


def test_one_robot_is_followed_by_all_estimators_on_the_same_measurements():
    runs = singles(3, 24.0)
    assert list(runs) == ["imm", "mmae", "static"]
    assert runs["imm"].missed == 0
    assert max(runs["imm"].delays) < 0.35
    assert np.median(runs["imm"].straight[:, 0]) < np.median(runs["static"].straight[:, 0])


def test_the_truth_of_a_run_spins_for_as_long_as_the_firmware_says():
    _, spinning = driven(3, 24.0)
    begins = np.flatnonzero((spinning[1:] > 0.0) & (spinning[:-1] <= 0.0)) + 1
    lengths = [np.flatnonzero(spinning[k:] <= 0.0)[0] * PERIOD for k in begins[:1]]
    assert lengths == pytest.approx([ROBOT.spin_time], abs=PERIOD)
    assert SPIN_LEFT == 3


def test_robots_that_pass_each_other_keep_their_identity():
    assert {crossing(seed) for seed in range(3)} == {"kept"}


def test_a_wrong_pose_of_the_vehicle_is_no_loss_of_identity():
    """In the world the estimates are beside the robots; in the vehicle's eyes they are on them."""
    off = tracking.SCENES["two, vehicle off by 5 cm and 1 deg"]
    assert {crossing(seed, off) for seed in range(4)} == {"kept"}


def test_a_robot_in_view_is_classified():
    for what in (True, False):
        answers = [it for it in (classified(seed, obstacle=what) for seed in range(6)) if it]
        assert answers
        assert all((p > 0.5) == what for it in answers for p in it)


def test_the_path_of_fig_5_turns_and_spins():
    headings = np.degrees(path()[:, 2] - 0.3)
    at = {t: headings[round(t / PERIOD) - 1] for t in (14.0, 18.0, SPINS_AT, 33.0, 49.0)}
    turn = math.degrees(2.0 * ROBOT.turn_offset / ROBOT.wheel_base)
    assert list(at.values()) == pytest.approx(
        [0.0, 3.0 * turn, 3.0 * turn, 3.0 * turn + 180.0, 180.0 - turn]
    )


def test_what_the_vehicle_is_wrong_about_shifts_all_of_a_frame_alike():
    watcher = Watcher(Scene(pixel=1e-6, position=0.1), np.random.default_rng(0))
    places = np.array([[0.3, 0.2], [-0.4, 0.5]])
    one, two = watcher.detections(above(0.0, 0.0), places)
    shifts = np.array([one.position, two.position]) - places
    assert 0.01 < np.abs(shifts).max() < 0.5
    assert shifts[0, :2] == pytest.approx(shifts[1, :2], abs=0.05)
    assert one.covariance[0, 0] == pytest.approx(0.1**2, rel=0.1)
