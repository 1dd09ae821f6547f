"""The vision-aided inertial navigator over rendered flights, graded by the truth."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from seeing import LENS, built, observed, step, through

from missionkit.estimation.builder import build
from missionkit.estimation.error_state_ekf import measurement_models, process_model
from missionkit.estimation.ud_filter.factors import covariance
from missionkit.estimation.ud_vision import feature_steps, feature_table, vehicle_steps
from missionkit.estimation.ud_vision.feature_table import LOST_AFTER
from missionkit.estimation.ud_vision.parameters import UdVisionEkf
from missionkit.geometry import IDENTITY, Transform, vec
from missionkit.messages import Frame, Imu, Observation
from missionkit.perception.feature_matching import matched
from missionkit.recorder import value_codec

HOVER = 100  # ticks until the first leg


@cache
def recorded():
    return list(observed(14.0))


def test_it_flies_ten_metres_by_the_ground_alone_and_knows_how_well():
    navigator = built()
    known, truth = through(navigator, recorded())
    state = navigator.read(known)
    assert np.linalg.norm(truth.position[:2] - recorded()[HOVER][1].position[:2]) > 2.5
    error, sd = np.linalg.norm((state.position - truth.position)[:2]), state.health.position_sd
    assert error < min(0.25, 3.0 * sd)
    assert 0.01 < sd < 0.25
    assert state.position[2] == pytest.approx(truth.position[2], abs=0.03)
    assert state.velocity == pytest.approx(truth.velocity, abs=0.1)
    assert abs(state.attitude @ truth.attitude) > 1 - 1e-3
    assert not state.health.diverged
    assert state.health.placed
    assert known.used >= 8


class Conventional:
    """The same filter on P, fed with all that the factors are fed with: what it comes to."""

    def __init__(self, monkeypatch, kind=np.float64):
        self.x = self.P = None
        self.kind, self.worst, self.calls = kind, 0.0, 0
        for module, name in (
            (vehicle_steps, "advance"),
            (feature_steps, "see"),
            (feature_steps, "begin"),
        ):
            ours, real = getattr(self, name), getattr(module, name)
            monkeypatch.setattr(module, name, self.beside(real, ours))

    def beside(self, real, ours):
        def called(x, U, D, *others):
            if self.P is None:
                self.x, self.P = x.copy(), covariance(U, D).astype(self.kind)
            copies = [np.copy(it) if isinstance(it, np.ndarray) else it for it in others]
            answer = real(x, U, D, *others)
            ours(*copies)
            self.calls += 1
            gap = np.abs(covariance(U, D) - self.P).max() / np.abs(self.P).max()
            self.worst = max(self.worst, gap, np.abs(x - self.x).max())
            return answer

        return called

    def correct(self, H, r, variances):
        d = np.zeros(len(self.P), self.kind)
        for h, left, variance in zip(H.astype(self.kind), r, variances, strict=True):
            Ph = self.P @ h
            K = Ph / (h @ Ph + self.kind(variance))
            d = d + K * self.kind(left - h @ d)
            self.P = self.P - np.outer(K, Ph)
        process_model.rotate_by(self.x, d[6:9].astype(np.float64))
        self.x[:6] += d[:6]
        self.x[10:] += d[9:]

    def propagate(self, u, dt, noise):
        F, G = np.eye(len(self.P)), np.zeros((len(self.P), 12))
        F[:15, :15] = vehicle_steps.transition(process_model.move(self.x, u, dt), dt)
        G[3:15] = np.eye(12)
        q = dt * np.repeat([noise[0] + noise[4] * u[7], noise[1] + noise[5] * u[7], *noise[2:4]], 3)
        self.P = F @ self.P @ F.T + G @ np.diag(q) @ G.T

    def take(self, row, gates):
        H, r = np.zeros((3, len(self.P))), np.zeros(3)
        m = measurement_models.predict(self.x, row, H, r)
        R = row[6:15:4][:m]
        S = H[:m] @ self.P @ H[:m].T + np.diag(R)
        if r[:m] @ np.linalg.solve(S, r[:m]) < gates[m]:
            self.correct(H[:m], r[:m], R)

    def advance(self, t, imu, rows, until, noise, gates):
        rows = list(rows)
        while rows and rows[0][0] <= t:
            self.take(rows.pop(0), gates)
        for u in imu:
            while t < min(u[0], until):
                stop = min([u[0], until, *(row[0] for row in rows[:1])])
                self.propagate(u, stop - t, noise)
                t = stop
                while rows and rows[0][0] <= t:
                    self.take(rows.pop(0), gates)

    def expected(self, slot, eye, focal):
        H, z = np.zeros((2, len(self.P))), np.zeros(2)
        assert feature_steps.expect(self.x, slot, eye, focal, H, z)
        return H, z

    def see(self, slots, seen, eye, focal, variance, gate):
        rows, left = [np.zeros((0, len(self.P)))], [np.zeros(0)]
        for slot, at in zip(slots, seen, strict=True):
            H, z = self.expected(slot, eye, focal)
            S = H @ self.P @ H.T + variance * np.eye(2)
            if (at - z) @ np.linalg.solve(S, at - z) < gate:
                rows.append(H)
                left.append(at - z)
        r = np.concatenate(left)
        self.correct(np.concatenate(rows), r, np.full(len(r), variance))

    def begin(self, slot, seen, eye, focal, variances):
        sight = Transform(self.x[6:10].copy(), self.x[:3].copy())
        ray = Transform(sight.rotation, np.zeros(3)).apply(eye[:3] @ (*(seen / focal), 1.0))
        origin = sight.apply(eye[3])
        first = 15 + 3 * slot
        self.x[first + 1 : first + 4] = origin - origin[2] / ray[2] * ray
        self.P[first : first + 3] = self.P[:, first : first + 3] = 0.0
        self.P[range(first, first + 3), range(first, first + 3)] = variances[0]
        H = np.zeros((3, len(self.P)))
        H[:2], _ = self.expected(slot, eye, focal)
        H[2, first + 2] = 1.0
        self.correct(H, np.zeros(3), variances[[1, 1, 2]])


def test_in_double_precision_it_is_the_conventional_filter_over_a_run(monkeypatch):
    navigator = built(features=8, least_in_view=6, prior_sd=1.0)
    ours = Conventional(monkeypatch)
    known, _ = through(navigator, recorded()[:200])
    assert known.used >= 4
    assert ours.calls > 300
    assert ours.worst < 1e-9


def test_in_single_precision_27_states_and_a_prior_of_100_m_stay_within_4_mm():
    settings = {"features": 4, "least_in_view": 4, "prior_sd": 100.0}
    double, single = built(**settings), built(**settings, precision="single")
    exact, known = double.begin(), single.begin()
    apart = []
    for seen, _ in recorded()[:200]:
        exact, known = step(double, exact, seen), step(single, known, seen)
        apart.append(np.linalg.norm(exact.ahead[:3] - known.ahead[:3]))
    assert known.state.U.dtype == np.float32
    assert known.state.U.shape == (27, 27)
    assert known.used >= 3
    assert max(apart) <= 0.004


def without_frames(seen: Observation) -> Observation:
    return replace(seen, frame=None) if seen.now > 6.0 else seen


def late(seen: Observation) -> Observation:
    if seen.now <= 6.0 or seen.frame is None:
        return seen
    return replace(seen, frame=Frame(seen.frame.at - 0.5, seen.frame.image))


def dark(seen: Observation) -> Observation:
    if seen.now <= 6.0 or seen.frame is None:
        return seen
    return replace(seen, frame=Frame(seen.frame.at, np.full_like(seen.frame.image, 7)))


@pytest.mark.parametrize(
    ("change", "cause"),
    [
        (without_frames, "no camera image for"),
        (late, "camera images arrive 0.6 s late"),
        (dark, "0 features of the ground found again"),
    ],
)
def test_blind_it_says_why_and_that_it_knows_less_and_less(change, cause):
    navigator = built(blind_after=1.0)
    known, _ = through(navigator, recorded()[:115], change)
    sd = navigator.read(known).health.position_sd
    assert not navigator.read(known).health.diverged
    for seen, _ in recorded()[115:160]:
        known = step(navigator, known, change(seen))
    health = navigator.read(known).health
    assert health.diverged
    assert cause in health.cause
    assert health.position_sd > 3.0 * sd


def test_without_images_it_is_not_placed_on_the_ground_either():
    navigator = built()
    known, _ = through(navigator, recorded()[:29], lambda seen: replace(seen, frame=None))
    health = navigator.read(known).health
    assert health.aligned
    assert not health.placed
    known, _ = through(navigator, recorded()[:29])
    assert navigator.read(known).health.placed


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e8])
def test_what_is_not_a_number_is_refused(bad):
    def spoilt(seen: Observation) -> Observation:
        if round(seen.now / 0.05) % 4:
            return seen
        wrong, frame = np.array([bad, bad, bad]), seen.frame
        return replace(
            seen,
            imu=(*seen.imu[:-1], Imu(seen.imu[-1].at, wrong, wrong)),
            range=None if seen.range is None else seen.range._replace(distance=bad),
            mag=None if seen.mag is None else seen.mag._replace(field=wrong),
            frame=None if frame is None else frame._replace(at=bad),
        )

    navigator = built()
    known, truth = through(navigator, recorded()[:160], spoilt)
    state = navigator.read(known)
    assert state.position == pytest.approx(truth.position, abs=0.3)
    assert not state.health.diverged


def test_features_that_move_are_refused_and_given_up():
    """What a robot carries is not ground."""
    navigator = built()
    known, _ = through(navigator, recorded()[:110])
    moving, refused = np.flatnonzero(known.table.alive)[:3], 0
    patches = known.table.patches[moving].copy()
    for seen, _ in recorded()[110:125]:
        known = navigator.propagate(known, seen)
        search = None if seen.frame is None else navigator.search(known, seen.frame.at)
        if search is not None:
            matches = matched(seen.frame.image, seen.frame.at, LENS, search)
            strays = np.isin(search.slots, moving) & matches.found
            shifted = matches.points + 0.03 * strays[:, None]
            known = navigator.see(known, search, matches._replace(points=shifted))
            refused += known.refused
    assert refused >= 3 * LOST_AFTER
    for slot, patch in zip(moving, patches, strict=True):
        assert not (known.table.alive[slot] and (known.table.patches[slot] == patch).all())
    assert known.ahead[:3] == pytest.approx(recorded()[124][1].position, abs=0.1)


def test_silence_and_a_gap_of_the_inertial_unit_are_survived():
    def silent(seen: Observation) -> Observation:
        return replace(seen, imu=()) if 6.0 < seen.now < 7.0 else seen

    navigator = built()
    known, _ = through(navigator, recorded()[:135], silent)
    assert navigator.read(known).health.cause.startswith("no inertial samples")
    for seen, _ in recorded()[135:240]:
        known = step(navigator, known, silent(seen))
    state = navigator.read(known)
    assert not state.health.cause.startswith("no inertial samples")
    assert state.health.position_sd > 3.0
    assert known.used >= 8
    assert state.velocity == pytest.approx(recorded()[239][1].velocity, abs=0.5)


def test_it_knows_its_recent_poses():
    navigator = built()
    known, _ = through(navigator, recorded()[:150])
    past = navigator.pose_at(known, 7.25)
    assert past.translation == pytest.approx(recorded()[144][1].position, abs=0.1)
    assert navigator.pose_at(known, 6.0) is None
    assert navigator.pose_at(navigator.begin(), 1.0) is None


def test_a_memory_is_a_value_and_can_be_saved():
    navigator = built(features=6, precision="single")
    known, _ = through(navigator, recorded()[:120])
    text = value_codec.written(known)
    seen = recorded()[120][0]
    after = step(navigator, known, seen)
    assert value_codec.written(known) == text
    again = step(navigator, value_codec.read(text), seen)
    assert value_codec.written(again) == value_codec.written(after)


def test_it_starts_where_the_map_says_and_uses_neither_fixes_nor_markers():
    navigator = built(start=(7.0, -3.0))
    known, _ = through(navigator, recorded()[:60])
    state = navigator.read(known)
    assert state.position[:2] == pytest.approx([7.0, -3.0], abs=0.1)
    assert navigator.fuse(known, ()) is known
    assert state.health.gnss_at is None
    assert state.targets["post"].position == pytest.approx([4.0, 1.0, -1.0])


def test_it_needs_the_camera():
    with pytest.raises(ValueError, match="ud_vision_ekf needs the camera"):
        build(UdVisionEkf(), {}, Transform(IDENTITY, vec(0.0, 0.0, 0.0)))


def test_a_frame_that_comes_again_counts_once():
    navigator = built()
    known, _ = through(navigator, recorded()[:110])
    seen = recorded()[110][0]
    known = step(navigator, known, seen)
    assert navigator.search(known, seen.frame.at) is None


def test_of_features_that_crowd_together_those_seen_most_often_stay():
    table, slots = feature_table.begin(6), np.array([5, 1, 2, 4])
    table = feature_table.begun(table, slots, 0.0)._replace(sightings=np.array([0, 3, 9, 0, 9, 5]))
    row = np.array([[0.0, 0.0], [4.0, 0.0], [8.0, 0.0], [40.0, 0.0]])  # px
    kept = feature_table.thinned(table, slots, row, 10.0)
    assert np.flatnonzero(kept.alive).tolist() == [2, 4, 5]  # 1, next to 5 and 2, goes
    assert feature_table.thinned(table, slots, 3.0 * row, 10.0) is table
