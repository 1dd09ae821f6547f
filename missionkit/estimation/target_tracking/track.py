"""One track: a target's filter, how often it was seen, and what it is likely to be."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.estimation.target_tracking import model_bank, multiple_models
from missionkit.estimation.target_tracking.apparent_size import size_evidence
from missionkit.estimation.target_tracking.heading_start import MOST_PLACES, Place, first_state
from missionkit.estimation.target_tracking.multiple_models import (
    Bank,
    BankState,
    Library,
    bank,
    kernels,
)
from missionkit.estimation.target_tracking.reversal_clock import ReversalClock, advanced
from missionkit.geometry import Mat, Vec3
from missionkit.ground_robot import GroundRobot
from missionkit.messages import GroundDetection
from missionkit.messages.robot_modes import OBSTACLE, SPIN

WINDOW = 30
"""Frames over which a track's confidence is counted (P1 section 1.3)."""
INDEPENDENT_EVERY = 0.2
"""Sizes of boxes measured nearer to each other in time say the same again (s)."""
LIKELY = 0.5  # probability of a spin
SAID_OBSTACLE, SAID_TARGET = 3.0, -1.0
"""Logarithm of the odds obstacle robot : target, of what a detector takes it for."""
MOST_EVIDENCE = 12.0
"""Of sizes, a logarithm of odds: a class can still be wrong."""


class Motion(NamedTuple):
    """How targets are tracked."""

    robot: GroundRobot
    moving: Bank  # once the heading is known
    still: Bank  # before
    library: Library


class Track(NamedTuple):
    """One target; an immutable value."""

    number: int
    born_at: float  # s
    seen_at: float  # s, of the last detection
    state: BankState
    oriented: bool  # its heading is known
    places: tuple[Place, ...]  # measured lately, until its heading is known
    looks: int = 0  # the last frames as bits, 1: detected, the newest lowest
    frames: int = 0  # of those, at most `WINDOW`
    missed_for: float = 0.0  # s in view without a detection, up to now
    trust: float = 0.0  # scores of its detections until it is confirmed, summed up
    confirmed: bool = False
    evidence: float = 0.0  # of sizes, logarithm of the odds obstacle robot : target
    clock: ReversalClock = ReversalClock()

    @property
    def confidence(self) -> float:
        """Share of the last frames in which it was detected: P1's γ."""
        return self.looks.bit_count() / max(self.frames, 1)


def motion(estimator: multiple_models.Estimator, robot: GroundRobot, library: Library) -> Motion:
    """Return how targets are tracked.

    Args:
        estimator: whose models.
        robot: how they drive.
        library: whose code filters.
    """
    return Motion(robot, bank(estimator, robot), bank("static", robot), library)


def born(how: Motion, number: int, at: float, seen: GroundDetection) -> Track:
    """Return a new track at a detection.

    Args:
        how: it is tracked.
        number: of the track.
        at: s, of the frame.
        seen: the detection.
    """
    P = np.diag([0.0, 0.0, math.pi**2 / 3.0])
    P[:2, :2] = seen.covariance
    state = multiple_models.begun(how.still, np.array([*seen.position, 0.0]), P)
    place = Place(at, seen.position, seen.covariance)
    first = Track(number, at, at, state, oriented=False, places=(place,))
    return _counted(first, seen)


def predicted(how: Motion, known: Track, dt: float) -> Track:
    """Return the track `dt` (s) later.

    Args:
        how: it is tracked.
        known: the track.
        dt: s.
    """
    models = how.moving if known.oriented else how.still
    library = kernels(how.library)
    return known._replace(state=multiple_models.predicted(models, known.state, dt, library))


def updated(how: Motion, known: Track, at: float, seen: GroundDetection) -> Track:
    """Return the track after a detection.

    Args:
        how: it is tracked.
        known: the track at the time of the frame.
        at: s, of the frame.
        seen: the detection, which belongs to it.
    """
    models = how.moving if known.oriented else how.still
    state = multiple_models.corrected(
        models, known.state, seen.position, seen.covariance, kernels(how.library)
    )
    place = Place(at, seen.position, seen.covariance)
    weight = min((at - known.seen_at) / INDEPENDENT_EVERY, 1.0)
    evidence = known.evidence + weight * _class_evidence(seen, how.robot.diameter)
    after = known._replace(
        state=state,
        clock=_clocked(how, known, state, at),
        seen_at=at,
        missed_for=0.0,
        places=() if known.oriented else (*known.places[1 - MOST_PLACES :], place),
        evidence=min(max(evidence, -MOST_EVIDENCE), MOST_EVIDENCE),
    )
    return _oriented(how, _counted(after, seen))


def _class_evidence(seen: GroundDetection, diameter: float) -> float:
    """Return how much likelier a detection is that of an obstacle robot: a logarithm."""
    if seen.kind == OBSTACLE:
        return SAID_OBSTACLE
    if not seen.sized:
        return SAID_TARGET
    return size_evidence(seen.size, seen.offset, seen.height, diameter)


def _clocked(how: Motion, known: Track, state: BankState, at: float) -> ReversalClock:
    if not known.oriented or SPIN not in how.moving.names:
        return known.clock
    spins = bool(state.mu[how.moving.names.index(SPIN)] > LIKELY)
    return advanced(known.clock, at, known.seen_at, spins=spins, robot=how.robot)


def missed(known: Track, dt: float) -> Track:
    """Return the track after a frame that should have shown it and did not, `dt` (s) long."""
    return _counted(known, None)._replace(missed_for=known.missed_for + dt)


def mean(known: Track) -> tuple[Vec3, Mat]:
    """Return its state (3,) and covariance (3, 3)."""
    return model_bank.combined(*known.state)


def obstacle_probability(how: Motion, known: Track) -> float:
    """Return how likely it is an obstacle robot, by its motion and by the size of its boxes.

    Args:
        how: it is tracked.
        known: the track.
    """
    by_motion = multiple_models.OBSTACLE_SHARE
    if known.oriented and OBSTACLE in how.moving.kinds:
        circles = [kind == OBSTACLE for kind in how.moving.kinds]
        by_motion = float(known.state.mu[circles].sum())
    odds = by_motion * math.exp(known.evidence)
    return odds / (odds + 1.0 - by_motion)


def _counted(known: Track, seen: GroundDetection | None) -> Track:
    looks = (known.looks << 1 | (seen is not None)) & ((1 << WINDOW) - 1)
    trust = known.trust + (0.0 if seen is None else seen.score)
    return known._replace(looks=looks, frames=min(known.frames + 1, WINDOW), trust=trust)


def _oriented(how: Motion, known: Track) -> Track:
    """Begin with the models of motion as soon as the last places show a heading."""
    if known.oriented or len(how.moving.names) == 1:  # the static model has no heading
        return known
    first = first_state(known.places, how.robot.speed)
    if first is None:
        return known
    state = multiple_models.begun(how.moving, *first)
    return known._replace(state=state, oriented=True, places=())
