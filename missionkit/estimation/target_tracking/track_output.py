"""A track as the target that guards and behaviours see."""

from __future__ import annotations

import math

import numpy as np

from missionkit.estimation.target_tracking import track
from missionkit.estimation.target_tracking.reversal_clock import reversal_in, spin_left
from missionkit.estimation.target_tracking.track import Motion, Track
from missionkit.geometry import Vec3
from missionkit.messages import Target
from missionkit.messages.robot_modes import OBSTACLE, TARGET


def target_of(how: Motion, known: Track, name: str, now: float, ground: float) -> Target:
    """Return a track as a target; heading, velocity and modes only once its heading is known.

    Args:
        how: it is tracked.
        known: the track.
        name: of the target.
        now: s, when it is there.
        ground: m, down, of the ground it stands on.
    """
    x, P = track.mean(known)
    obstacle = track.obstacle_probability(how, known)
    seen = Target(
        name=name,
        position=np.array([x[0], x[1], ground]),
        position_sd=math.sqrt(0.5 * float(P[0, 0] + P[1, 1])),
        attitude=None,
        angle_sd=None,
        seen_at=known.seen_at,
        classes={TARGET: 1.0 - obstacle, OBSTACLE: obstacle},
        confidence=known.confidence,
    )
    if not known.oriented:
        return seen
    return seen._replace(
        velocity=_velocity(how, known),
        heading=float(x[2]),
        heading_sd=math.sqrt(float(P[2, 2])),
        reversal_in=reversal_in(known.clock, now, how.robot),
        spin_left=spin_left(known.clock, now, how.robot),
        modes=dict(zip(how.moving.names, known.state.mu.tolist(), strict=True)),
    )


def _velocity(how: Motion, known: Track) -> Vec3:
    """Return the mean (3,) over the models, m/s, NED."""
    speeds = known.state.mu * how.moving.models[:, 0]
    headings = known.state.X[:, 2]
    return np.array([speeds @ np.cos(headings), speeds @ np.sin(headings), 0.0])
