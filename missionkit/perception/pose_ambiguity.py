"""Which of the two poses of a square is the true one: P1 section 2.2, correction P1.3."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Final, NamedTuple

from missionkit.geometry import Quat, multiply, to_matrix
from missionkit.perception.square_pose import SIGMA_PX, Solution, angle_between

DECISIVE: Final = 6.0  # difference in cost: odds of exp(3) = 20 to 1
SAME: Final = math.radians(2.0)  # two orientations this close need no choice
_TILT_SD: Final = math.radians(8.0)  # how straight markers hang, and the vehicle's own attitude
_PRIOR_SD: Final = math.radians(20.0)  # of a prior orientation that does not say how good it is
_PRIOR_SD_LEAST: Final = math.radians(5.0)
_TILT_MOST: Final = 3.0  # standard deviations: beyond them the marker is not an upright one
_PRIOR_MOST: Final = 4.0


class Expectation(NamedTuple):
    """Prior knowledge of a marker's orientation."""

    camera: Quat | None = None  # camera to world; None: unknown
    upright: bool = False  # the marker's y axis points up
    attitude: Quat | None = None  # marker axes to world, the previous estimate
    angle_sd: float | None = None  # rad, of `attitude`


def cost(solution: Solution, sigma: float, expected: Expectation) -> float:
    """Return minus twice the log of a solution's posterior, up to a constant.

        c = 8 e²/σ² + min(τ/σ_τ, 3)² + min(δ/σ_δ, 4)²

    e: rms reprojection error over 8 coordinates (px), σ: corner noise (px), τ: angle between the
    marker's y axis and the vertical, δ: angle to the previous orientation. The two priors
    saturate, so that a wrong one cannot outvote a clear image.

    Args:
        solution: one of the planar poses.
        sigma: corner noise, px.
        expected: vertical and previous orientation, where known.
    """
    image = 8.0 * (solution.error / sigma) ** 2
    if expected.camera is None:
        return image
    attitude = multiply(expected.camera, solution.pose.rotation)
    return image + _gravity(attitude, expected) + _previous(attitude, expected)


def _gravity(attitude: Quat, expected: Expectation) -> float:
    if not expected.upright:
        return 0.0
    tilt = math.acos(max(-1.0, min(1.0, -to_matrix(attitude)[2, 1])))
    return min(tilt / _TILT_SD, _TILT_MOST) ** 2


def _previous(attitude: Quat, expected: Expectation) -> float:
    if expected.attitude is None:
        return 0.0
    angle = angle_between(attitude, expected.attitude)
    sd = _PRIOR_SD if expected.angle_sd is None else max(expected.angle_sd, _PRIOR_SD_LEAST)
    return min(angle / sd, _PRIOR_MOST) ** 2


def resolve(solutions: Sequence[Solution], expected: Expectation) -> tuple[Solution, bool]:
    """Return the most probable of one or two solutions, and whether the choice is open.

    It is open if the other costs less than `DECISIVE` more and its orientation is another one.
    The corner noise is taken as the best solution's residual where that exceeds `SIGMA_PX`.
    """
    if len(solutions) == 1:
        return solutions[0], False
    sigma = max(SIGMA_PX, min(s.error for s in solutions))
    (best_cost, _, best), (other_cost, _, other) = sorted(
        (cost(s, sigma, expected), i, s) for i, s in enumerate(solutions)
    )
    apart = angle_between(best.pose.rotation, other.pose.rotation)
    return best, apart > SAME and other_cost - best_cost < DECISIVE
