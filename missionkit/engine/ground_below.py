"""Where the ground below the vehicle is, and how well that and its attitude are known."""

from __future__ import annotations

from typing import Any, Final

import numpy as np

from missionkit.estimation.navigator import Navigator, NavState
from missionkit.geometry import rotate, vec
from missionkit.messages import Range
from missionkit.perception.ground_plane import ViewNoise

STALE: Final = 0.5  # s; the ground that was measured earlier may be other ground
RANGE_SD: Final = 0.05  # m, of a range sensor and of how level the ground is


def ground_below(
    navigator: Navigator, navigation: Any, state: NavState, distance: Range | None, now: float
) -> tuple[float, ViewNoise]:
    """Return how far down (m, NED) the ground is, and what makes places on it uncertain.

    Without a recent distance it is taken to be as high as the take-off point. The vehicle's
    horizontal position does not count: what it is off by shifts the vehicle and all it sees alike.

    Args:
        navigator: of the mission.
        navigation: its memory.
        state: its estimate.
        distance: the newest, fresh or not.
        now: s.
    """
    sd = np.sqrt(np.maximum(np.diagonal(state.covariance), 0.0))
    noise = ViewNoise(height=float(sd[2]), attitude=float(sd[6:9].mean()))
    if distance is None or now - distance.at > STALE:
        return 0.0, noise
    body = navigator.pose_at(navigation, distance.at)
    if body is None:
        return 0.0, noise
    down = float(rotate(body.rotation, vec(0.0, 0.0, distance.distance))[2])
    return float(body.translation[2]) + down, noise._replace(height=RANGE_SD)
