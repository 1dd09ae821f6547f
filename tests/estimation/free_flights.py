"""A free flyer's true motion and what its sensors say, made here and not by the simulator."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.estimation.builder import build
from missionkit.estimation.tandem_ekf.parameters import CompoundEkf, FeaturedTarget, TandemEkf
from missionkit.geometry import (
    IDENTITY,
    Transform,
    conjugate,
    exp,
    log,
    multiply,
    normalised,
    rotate,
    to_matrix,
    vec,
)
from missionkit.messages import AnchorRange, Features, Imu, Observation

ANCHORS = {"a": (1, -0.2, 0.5), "b": (1, 0.2, -0.5), "c": (-1, 0.2, -0.5), "d": (-1, -0.2, 0.5)}
LEVER = np.array([0.05, 0.05, 0.0])
CAMERA = np.array([0.0, 0.0, 0.04])
CORNERS = [(0.035, 0.035), (0.035, -0.035), (-0.035, 0.035), (-0.035, -0.035)]
PATTERN = [*CORNERS, (0.02, 0.0), (0.0, -0.02)]
FEATURES = {f"f{i}": (x, y, -0.05) for i, (x, y) in enumerate(PATTERN)}
TARGET = (0.1, 1.0, 0.8)
"""Below the flyer at the start, its features facing up to it."""
NOISE = {"range": 0.02, "feature": 0.001, "accel": 0.003, "gyro": 6.1e-5}
FINE = 5
"""Steps of the truth in one inertial interval of 10 ms."""


class Motion(NamedTuple):
    """Truth at inertial samples, 100 a second."""

    times: np.ndarray  # (n,), s
    places: np.ndarray  # (n, 3), m, of the centre of mass
    velocities: np.ndarray  # (n, 3), m/s
    attitudes: np.ndarray  # (n, 4)
    rates: np.ndarray  # (n, 3), rad/s, body
    forces: np.ndarray  # (n, 3), m/s², body


def parameters(kind=TandemEkf, **changes):
    target = FeaturedTarget(position=TARGET, features=FEATURES)
    given = {
        "anchors": ANCHORS,
        "radio": tuple(LEVER),
        "camera": tuple(CAMERA),
        "targets": {"target": target},
        "position": (0.0, 1.0, 0.0),
        "underweight": 0.0,
    }
    return kind(**given | changes)


def flyer(kind=TandemEkf, **changes):
    return build(parameters(kind, **changes), {}, Transform(IDENTITY, vec(0.0, 0.0, 0.0)))


def both(**changes):
    return [flyer(TandemEkf, **changes), flyer(CompoundEkf, **changes)]


def wandering(seconds, turning=0.07):
    """Weave about the start while turning about all axes at up to `turning` (rad/s)."""
    n = 100 * seconds + 1
    t = np.arange(n) * 0.01
    phase, w = np.array([0.3, 1.1, 2.0]), np.array([0.31, 0.23, 0.17])
    places = np.array([0.0, 1.0, 0.0]) + 0.25 * (np.sin(np.outer(t, w) + phase) - np.sin(phase))
    velocities = 0.25 * w * np.cos(np.outer(t, w) + phase)
    accels = -0.25 * w * w * np.sin(np.outer(t, w) + phase)
    rate = turning * np.array([0.6, -0.5, 0.6])
    swing = 2.0 * np.array([0.29, 0.37, 0.21])

    def rates_at(at):
        return rate * np.sin(np.outer(at, swing) + phase)

    q, attitudes = IDENTITY.copy(), [IDENTITY.copy()]
    for k in range(n - 1):
        for w_now in rates_at(t[k] + (np.arange(FINE) + 0.5) * (0.01 / FINE)):
            q = normalised(multiply(q, exp(w_now * (0.01 / FINE))))
        attitudes.append(q)
    forces = [to_matrix(q).T @ a for q, a in zip(attitudes, accels, strict=True)]
    return Motion(t, places, velocities, np.array(attitudes), rates_at(t), np.array(forces))


def measured(motion, rng, *, vision=True, outliers=0.0, lag=0.0):
    """Return the observations of a flight at 20 Hz: 5 inertial samples, 2 to 3 ranges, a frame.

    A range to each anchor in turn comes at 50 Hz; an outlier is up to 1 m longer. `lag` (s) delays
    the ranges.
    """
    out, step = [], 5
    n = len(motion.times)
    accel = motion.forces + rng.normal(size=(n, 3)) * NOISE["accel"] / math.sqrt(0.01)
    gyro = motion.rates + rng.normal(size=(n, 3)) * NOISE["gyro"] / math.sqrt(0.01)
    imus = [Imu(float(t), a, w) for t, a, w in zip(motion.times, accel, gyro, strict=True)]
    ranges = [a_range(motion, rng, k, outliers) for k in range(2, n, 2)]
    for k in range(0, n, step):
        now = float(motion.times[k])
        due = (now - 0.05 - lag + 1e-9, now - lag + 1e-9)
        frame = (a_frame(motion, rng, k),) if vision else ()
        fresh = (r for r in ranges[max(0, k // 2 - 8) :][:12] if due[0] < r.at <= due[1])
        out.append(
            Observation(
                now,
                imu=tuple(imus[max(0, k - step + 1) : k + 1]),
                ranges=tuple(fresh),
                features=frame,
            )
        )
    return out


def a_range(motion, rng, k, outliers):
    name = list(ANCHORS)[(k // 2) % 4]
    radio = motion.places[k] + rotate(motion.attitudes[k], LEVER)
    far = float(np.linalg.norm(radio - np.array(ANCHORS[name]))) + NOISE["range"] * rng.normal()
    if rng.random() < outliers:
        far += rng.uniform(0.1, 1.0)
    return AnchorRange(float(motion.times[k]), name, far)


def a_frame(motion, rng, k):
    places = np.array(list(FEATURES.values())) + np.array(TARGET)
    D = to_matrix(motion.attitudes[k])
    points = (places - motion.places[k]) @ D - CAMERA
    points = points + NOISE["feature"] * rng.normal(size=points.shape)
    return Features(float(motion.times[k]), "target", tuple(FEATURES), points)


def start_error(navigator, known, rng):
    """Return the memory with an initial state that is off by a draw from its own covariance."""
    P = navigator.read(known).covariance[:9, :9]
    e = np.linalg.cholesky(P) @ rng.normal(size=9)
    x = known.x.copy()
    q = normalised(multiply(x[6:10], exp(e[6:9])))
    place = x[0:3] - rotate(x[6:10], LEVER) + e[0:3]
    x[0:3] = place + rotate(q, LEVER)
    x[3:6] += e[3:6]
    x[6:10] = q
    return known._replace(x=x)


def truth_started(navigator, motion, rng):
    """Return the memory that begins at the truth of a motion, off by a draw of its covariance."""
    known = navigator.begin()
    x = known.x.copy()
    x[6:10] = motion.attitudes[0]
    x[0:3] = motion.places[0] + rotate(x[6:10], LEVER)
    x[3:6] = motion.velocities[0] + rotate(x[6:10], np.cross(motion.rates[0], LEVER))
    x[10:13] = motion.rates[0]
    return start_error(navigator, known._replace(x=x), rng)


def error(state, motion, k):
    """Return truth less estimate (9,): δp (m), δv (m/s), δθ in body axes (rad)."""
    turn = log(multiply(conjugate(state.attitude), motion.attitudes[k]))
    places = motion.places[k] - state.position
    return np.concatenate((places, motion.velocities[k] - state.velocity, turn))


def nees(state, motion, k, part=slice(0, 9)):
    e, P = error(state, motion, k)[part], state.covariance[:9, :9][part, part]
    return float(e @ np.linalg.solve(P, e))


def flown(navigator, known, observations):
    for seen in observations:
        known = navigator.propagate(known, seen)
    return known
