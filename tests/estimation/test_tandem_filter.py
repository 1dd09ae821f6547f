"""The free flyer's navigator: gate, silence, late and impossible input, divergence."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from free_flights import (
    ANCHORS,
    LEVER,
    both,
    error,
    flown,
    flyer,
    measured,
    parameters,
    truth_started,
    wandering,
)
from pydantic import ValidationError

from missionkit.estimation.tandem_ekf.parameters import CompoundEkf, TandemEkf
from missionkit.geometry import IDENTITY, rotate, to_matrix
from missionkit.messages import AnchorRange, Features, Imu, Observation
from missionkit.recorder import value_codec

MOTION = wandering(4)
KINDS = [TandemEkf, CompoundEkf]


def begun(kind=TandemEkf, *, seed=0, upto=None, vision=True, **changes):
    """Return navigator, memory after a flight, and its observations."""
    rng = np.random.default_rng(seed)
    navigator = flyer(kind, **changes)
    seen = measured(MOTION, rng, vision=vision)
    known = truth_started(navigator, MOTION, rng)
    return navigator, flown(navigator, known, seen[:upto]), seen


def sound(known):
    for P in (known.P, known.A):
        assert np.isfinite(P).all()
        np.testing.assert_allclose(P, P.T, rtol=0, atol=1e-15)
        if len(P):
            assert np.linalg.eigvalsh(P).min() > 0.0
    assert np.isfinite(known.x[:16]).all()


@pytest.mark.parametrize("kind", KINDS)
def test_the_state_is_that_of_the_centre_of_mass(kind):
    navigator, known, _ = begun(kind)
    state = navigator.read(known)
    k = len(MOTION.times) - 1
    e = error(state, MOTION, k)
    assert np.abs(e[:3]).max() < 0.006
    assert np.abs(e[6:]).max() < 0.01
    radio = state.position + rotate(state.attitude, LEVER)
    np.testing.assert_allclose(known.x[:3], radio, atol=1e-12)
    assert state.health.aligned
    assert state.health.placed
    assert not state.health.diverged
    assert state.health.gnss_at == pytest.approx(4.0)
    assert state.health.vision_at == pytest.approx(4.0)
    assert 0.5 < state.health.mahalanobis < 1.5
    assert state.health.position_sd == math.sqrt(state.covariance.diagonal()[:3].max())
    assert state.targets["target"].seen_at == pytest.approx(4.0)
    assert value_codec.is_plain(known)


def test_before_the_first_sample_it_is_where_the_mission_says():
    navigator = flyer(position=(0.1, 0.2, 0.3), attitude_deg=(90.0, 0.0, 0.0))
    state = navigator.read(navigator.begin())
    np.testing.assert_allclose(state.position, [0.1, 0.2, 0.3], atol=1e-12)
    turned = to_matrix(state.attitude) @ np.array([0.0, 1.0, 0.0])
    np.testing.assert_allclose(turned, [0.0, 0.0, 1.0], atol=1e-12)
    assert not state.health.aligned
    assert not state.health.diverged


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("off", [0.05, 0.12, -0.3, 5.0])
def test_a_range_beyond_the_gate_changes_nothing_but_the_counts(kind, off):
    navigator, known, seen = begun(kind, upto=60)
    last = seen[60]
    one = last.ranges[-1]
    lonely = replace(last, ranges=(), features=())
    bad = replace(lonely, ranges=(one._replace(distance=one.distance + off),))
    with_it, without = navigator.propagate(known, bad), navigator.propagate(known, lonely)
    if abs(off) < 0.1:
        assert with_it.rejected == 0
        return
    assert with_it.rejected == 1
    np.testing.assert_allclose(with_it.x, without.x, atol=1e-12)
    np.testing.assert_allclose(with_it.P, without.P, rtol=1e-9, atol=1e-18)
    alone = navigator.read(without).health.mahalanobis
    assert navigator.read(with_it).health.mahalanobis < alone + 0.3  # one outlier does not drown it


def test_one_wrong_feature_is_left_out_of_its_frame():
    navigator, known, seen = begun(upto=60)
    frame = seen[60].features[0]
    points = frame.points.copy()
    points[2] += [0.01, 0.0, 0.0]
    bad = navigator.propagate(known, replace(seen[60], features=(frame._replace(points=points),)))
    kept = [n for n in range(6) if n != 2]
    fewer = frame._replace(names=tuple(frame.names[n] for n in kept), points=frame.points[kept])
    good = navigator.propagate(known, replace(seen[60], features=(fewer,)))
    np.testing.assert_allclose(bad.x, good.x, atol=1e-12)
    np.testing.assert_allclose(bad.A, good.A, rtol=1e-9)
    assert bad.frames.refused < 0.01


@pytest.mark.parametrize("kind", KINDS)
def test_when_most_ranges_are_refused_it_says_that_it_has_diverged(kind):
    """Carried away by 0.5 m, unseen: within two seconds it is said, and later it is found again."""
    navigator, known, _ = begun(kind, vision=False, upto=40)
    x = known.x.copy()
    x[:3] += [0.3, 0.4, 0.1]
    known, after = known._replace(x=x), []
    rng = np.random.default_rng(3)
    for seen in measured(wandering(40), rng, vision=False)[40:]:
        known = navigator.propagate(known, seen)
        after.append(navigator.read(known).health)
    first = next(i for i, h in enumerate(after) if h.diverged)
    assert first < 40
    assert "ranges are refused" in after[first].cause
    assert after[first].mahalanobis > 1.5
    assert max(health.mahalanobis for health in after) > 2.5
    assert not after[-1].diverged


def test_when_frames_are_refused_it_says_that_it_has_diverged():
    navigator, known, seen = begun(upto=40)
    turned = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    for one in seen[40:]:
        frame = one.features[0]
        wrong = frame._replace(points=frame.points @ turned)
        known = navigator.propagate(known, replace(one, features=(wrong,)))
    health = navigator.read(known).health
    assert health.diverged
    assert "camera frames are refused" in health.cause
    assert health.vision_at == pytest.approx(1.95)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, -1.0, 1e9])
def test_ranges_that_mean_nothing_are_refused_and_said(kind, bad):
    navigator, known, seen = begun(kind, vision=False, upto=20)
    for one in seen[20:60]:
        ranges = tuple(r._replace(distance=bad) for r in one.ranges)
        known = navigator.propagate(known, replace(one, ranges=ranges))
        sound(known)
    health = navigator.read(known).health
    assert health.diverged
    assert f"is {bad:g} m" in health.cause
    assert health.rejected > 50


def test_names_that_are_not_known_are_refused_and_said():
    navigator, known, seen = begun(upto=20)
    stray = AnchorRange(seen[20].now, "aa", 1.0)
    other = Features(seen[20].now, "moon", ("f0",), np.zeros((1, 3)))
    known = navigator.propagate(known, replace(seen[20], ranges=(stray,), features=(other,)))
    assert known.rejected >= 1
    for one in seen[21:60]:
        known = navigator.propagate(known, replace(one, ranges=(stray,) * 3, features=()))
    cause = navigator.read(known).health.cause
    assert "'aa', which is not an anchor of navigation: did you mean 'a'?" in cause


@pytest.mark.parametrize("points", [np.full((6, 3), np.nan), np.zeros((2, 3)), np.zeros((6, 2))])
def test_features_that_mean_nothing_are_refused(points):
    navigator, known, seen = begun(upto=20)
    frame = seen[20].features[0]._replace(points=points)
    known = navigator.propagate(known, replace(seen[20], features=(frame,)))
    assert known.rejected >= 0
    sound(known)
    np.testing.assert_allclose(known.frames.at, 0.95)


@pytest.mark.parametrize("bad", [math.nan, math.inf, 1e9])
def test_inertial_samples_that_mean_nothing_are_silence(bad):
    navigator, known, seen = begun(upto=20)
    for one in seen[20:40]:
        imu = tuple(s._replace(gyro=np.full(3, bad)) for s in one.imu)
        known = navigator.propagate(known, replace(one, imu=imu))
        sound(known)
    health = navigator.read(known).health
    assert health.diverged
    assert "no inertial samples for 1." in health.cause


@pytest.mark.parametrize("kind", KINDS)
def test_a_gap_in_the_inertial_samples_makes_it_unsure_and_vision_brings_it_back(kind):
    navigator, known, seen = begun(kind, upto=30)
    before = navigator.read(known)
    for one in seen[30:36]:
        known = navigator.propagate(known, replace(one, imu=(), ranges=(), features=()))
    known = navigator.propagate(known, replace(seen[36], ranges=(), features=()))
    after = navigator.read(known)
    sd = np.sqrt(after.covariance.diagonal()[6:9])
    assert (sd > 0.03).all()  # 0.1 rad/s over 0.3 s
    assert after.health.position_sd > before.health.position_sd
    known = flown(navigator, known, seen[37:])
    e = error(navigator.read(known), MOTION, len(MOTION.times) - 1)
    assert np.abs(e[6:]).max() < 0.01
    assert np.abs(e[:3]).max() < 0.006


@pytest.mark.parametrize("kind", KINDS)
def test_without_measurements_the_place_loses_its_source(kind):
    navigator, known, seen = begun(kind, upto=10)
    sds = []
    for one in seen[10:]:
        known = navigator.propagate(known, replace(one, ranges=(), features=()))
        sds.append(navigator.read(known).health.position_sd)
    assert (np.diff(sds) > 0.0).all()
    health = navigator.read(known).health
    assert not health.placed
    assert not health.diverged
    assert health.mahalanobis is None


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("lag", [0.03, 0.1])
def test_ranges_that_come_late_count_at_their_own_time(kind, lag):
    rng = np.random.default_rng(8)
    navigator = flyer(kind)
    seen = measured(MOTION, rng, vision=False, lag=lag)
    known = flown(navigator, truth_started(navigator, MOTION, rng), seen)
    state = navigator.read(known)
    assert state.late == 0
    assert state.health.rejected < 3
    assert np.abs(error(state, MOTION, len(MOTION.times) - 1)[:3]).max() < 0.03


def test_too_late_twice_and_from_the_future_are_not_used():
    navigator, known, seen = begun(vision=False, upto=20)
    again = navigator.propagate(known, replace(seen[20], ranges=seen[20].ranges * 2))
    once = navigator.propagate(known, seen[20])
    np.testing.assert_array_equal(again.P, once.P)
    assert again.late == once.late + len(seen[20].ranges)
    fresh = navigator.begin()
    fresh = navigator.propagate(fresh, replace(seen[60], ranges=()))
    old = replace(seen[61], ranges=seen[20].ranges)
    assert navigator.propagate(fresh, old).late == len(seen[20].ranges)
    soon = AnchorRange(seen[20].now + 1.0, "a", 1.0)
    ahead = navigator.propagate(known, replace(seen[20], ranges=(soon,)))
    assert ahead.ranges.why == f"range of a has the time {soon.at:g} s at {seen[20].now:g} s"


def test_the_order_in_one_observation_does_not_matter():
    navigator, known, seen = begun(upto=20)
    other = replace(seen[20], ranges=seen[20].ranges[::-1])
    for a, b in zip(
        navigator.propagate(known, seen[20]), navigator.propagate(known, other), strict=True
    ):
        assert np.array_equal(a, b) if isinstance(a, np.ndarray) else True


def test_memory_is_never_changed():
    navigator, known, seen = begun(upto=20)
    text = value_codec.written(known)
    navigator.propagate(known, seen[20])
    navigator.read(known)
    assert value_codec.written(known) == text


def test_poses_of_the_last_half_second_are_known():
    navigator, known, _ = begun(upto=41)
    pose = navigator.pose_at(known, 1.975)
    assert np.abs(pose.translation - MOTION.places[198]).max() < 0.01
    assert navigator.pose_at(known, 0.5) is None
    assert navigator.pose_at(known, 2.5) is None
    assert navigator.fuse(known, ()) is known


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("sds", [(1e-6, 1e-6, 1e-6), (1e3, 1e2, 170.0), (1e-6, 10.0, 90.0)])
def test_ill_conditioned_starts_leave_covariances_symmetric_and_positive(kind, sds):
    place, velocity, angle = sds
    navigator = flyer(kind, position_sd=place, velocity_sd=velocity, attitude_sd_deg=angle)
    rng = np.random.default_rng(2)
    known = navigator.begin()
    for seen in measured(wandering(2), rng):
        known = navigator.propagate(known, seen)
        sound(known)


def test_still_and_level_it_needs_no_camera_nor_target():
    for navigator in both(targets={}):
        known = navigator.begin()
        for n in range(40):
            now = 0.05 * (n + 1)
            imu = tuple(Imu(now - 0.01 * k, np.zeros(3), np.zeros(3)) for k in range(4, -1, -1))
            far = tuple(
                AnchorRange(now, a, math.dist(at, np.array([0.0, 1.0, 0.0]) + LEVER))
                for a, at in ANCHORS.items()
            )
            known = navigator.propagate(known, Observation(now, imu=imu, ranges=far))
        state = navigator.read(known)
        np.testing.assert_allclose(state.position, [0.0, 1.0, 0.0], atol=1e-6)
        np.testing.assert_allclose(state.attitude, IDENTITY, atol=1e-4)
        assert state.targets == {}


def test_anchors_at_one_place_are_a_mistake():
    with pytest.raises(ValidationError, match="anchors a and b are at the same place"):
        parameters(anchors={"a": (0, 0, 0), "b": (0, 0, 0), "c": (1, 0, 0)})
