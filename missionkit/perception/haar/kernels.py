"""Kernels of the Haar detector: feature values, the best stump, and the search of an image.

Imported late: numba compiles them.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from missionkit.jit import compiled

Ints = npt.NDArray[np.int32]
Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.uint64]


@compiled
def integrated(image: npt.NDArray[np.uint8]) -> tuple[Floats, Floats]:
    """Return the integral images (h + 1, w + 1) of an image (h, w) and of its squares."""
    rows, columns = image.shape
    sums, squares = np.zeros((rows + 1, columns + 1)), np.zeros((rows + 1, columns + 1))
    for y in range(rows):
        row, row2 = 0.0, 0.0
        for x in range(columns):
            value = float(image[y, x])
            row += value
            row2 += value * value
            sums[y + 1, x + 1] = sums[y, x + 1] + row
            squares[y + 1, x + 1] = squares[y, x + 1] + row2
    return sums, squares


@compiled
def inside(sums: Floats, left: int, top: int, width: int, height: int) -> float:
    """Return the sum over a rectangle from an integral image.

    Args:
        sums: the integral image.
        left: px, of the rectangle.
        top: px.
        width: px.
        height: px.
    """
    right, bottom = left + width, top + height
    return float(sums[bottom, right] - sums[top, right] - sums[bottom, left] + sums[top, left])


@compiled
def scale_of(sums: Floats, squares: Floats, left: int, top: int, side: int) -> float:
    """Return n σ of a square window.

    Args:
        sums: integral of the image.
        squares: integral of its squares.
        left: px, of the window.
        top: px.
        side: px.
    """
    n = side * side
    mean = inside(sums, left, top, side, side) / n
    variance = inside(squares, left, top, side, side) / n - mean * mean
    return n * math.sqrt(max(variance, 0.0))


@compiled
def corners_of(rectangles: Ints, columns: int) -> Indices:
    """Return where the corners of rectangles are in a flat integral image, (n, 3, 4).

    In the order in which `feature` adds them up. Unsigned: numba then need not ask for negative
    indices, half of the time of a search.

    Args:
        rectangles: (n, 3, 4), px, left, top, width, height in a window.
        columns: of the integral image.
    """
    corners = np.empty(rectangles.shape, np.uint64)
    for k in range(len(rectangles)):
        for r in range(rectangles.shape[1]):
            left, top, width, height = rectangles[k, r]
            above, below = top * columns + left, (top + height) * columns + left
            corners[k, r, 0], corners[k, r, 1] = below + width, above + width
            corners[k, r, 2], corners[k, r, 3] = below, above
    return corners


@compiled
def feature(
    flat: Floats, corners: Indices, weights: Floats, which: int, at: np.uint64, scale: float
) -> float:
    """Return the value of one feature in one window.

    Args:
        flat: integral of the image, row after row.
        corners: (n, 3, 4), of the rectangles of all features, see `corners_of`.
        weights: (n, 3).
        which: of the features.
        at: index of the window's left top corner.
        scale: n σ of the window.
    """
    total = 0.0
    for r in range(corners.shape[1]):
        weight = weights[which, r]
        if weight != 0.0:
            total += weight * (
                flat[at + corners[which, r, 0]]
                - flat[at + corners[which, r, 1]]
                - flat[at + corners[which, r, 2]]
                + flat[at + corners[which, r, 3]]
            )
    return total / scale


@compiled
def values(
    patches: npt.NDArray[np.uint8], rectangles: Ints, weights: Floats, least: float
) -> npt.NDArray[np.float32]:
    """Return the value of each feature in each patch, (features, patches).

    Args:
        patches: (n, side, side).
        rectangles: (features, 3, 4), px.
        weights: (features, 3).
        least: standard deviation that a flatter patch counts as having, grey levels.
    """
    side = patches.shape[1]
    out = np.empty((len(rectangles), len(patches)), np.float32)
    corners, start = corners_of(rectangles, side + 1), np.uint64(0)
    for i in range(len(patches)):
        sums, squares = integrated(patches[i])
        scale = max(scale_of(sums, squares, 0, 0, side), least * side * side)
        for j in range(len(rectangles)):
            out[j, i] = feature(sums.ravel(), corners, weights, j, start, scale)
    return out


@compiled
def best_stump(
    values: npt.NDArray[np.float32], order: Ints, w: Floats, y: Floats
) -> tuple[int, float, float, float]:
    """Return the stump with the least weighted squared error: feature, threshold, low, high.

    The answer is the weighted mean of y below the threshold (low), and at or above it (high).

    Args:
        values: (features, n).
        order: (features, n), indices that sort each row.
        w: (n,), weights that sum up to 1.
        y: (n,), -1 or 1.
    """
    all_w, all_wy = 0.0, 0.0
    for i in range(len(w)):
        all_w += w[i]
        all_wy += w[i] * y[i]
    best, chosen, threshold, low, high = -1.0, 0, 0.0, 0.0, 0.0
    for j in range(len(values)):
        sum_w, sum_wy = 0.0, 0.0
        for k in range(len(w) - 1):
            i = order[j, k]
            sum_w += w[i]
            sum_wy += w[i] * y[i]
            here, following = values[j, i], values[j, order[j, k + 1]]
            rest = all_w - sum_w
            if following <= here or sum_w <= 1e-12 or rest <= 1e-12:
                continue
            gain = sum_wy * sum_wy / sum_w + (all_wy - sum_wy) * (all_wy - sum_wy) / rest
            if gain > best:
                best, chosen = gain, j
                threshold = 0.5 * (float(here) + float(following))
                low, high = sum_wy / sum_w, (all_wy - sum_wy) / rest
    return chosen, threshold, low, high


@compiled
def passed_by(
    flat: Floats,
    corners: Indices,
    weights: Floats,
    stumps: Floats,
    ends: Ints,
    limits: Floats,
    at: np.uint64,
    scale: float,
) -> float:
    """Return by how much a window's sums exceed all limits together; -1: a stage refuses it.

    Args:
        flat: integral of the image, row after row.
        corners: (n, 3, 4), of the stumps' features, see `corners_of`.
        weights: (n, 3).
        stumps: (n, 3), threshold, low, high.
        ends: of the stages, behind each one's last stump.
        limits: of the stages' sums.
        at: index of the window's left top corner.
        scale: n σ of the window.
    """
    over, first = 0.0, 0
    for stage in range(len(ends)):
        answer = 0.0
        for k in range(first, ends[stage]):
            value = feature(flat, corners, weights, k, at, scale)
            answer += stumps[k, 1] if value < stumps[k, 0] else stumps[k, 2]
        first = ends[stage]
        if answer < limits[stage]:
            return -1.0
        over += answer - limits[stage]
    return over


@compiled
def search(
    sums: Floats,
    squares: Floats,
    side: int,
    rectangles: Ints,
    weights: Floats,
    stumps: Floats,
    ends: Ints,
    limits: Floats,
    place: Floats,
    size: float,
    margin: float,
    stride: int,
    pad: int,
    least: float,
    found: Floats,
) -> int:
    """Write column, row (px of the full image) and score of windows that pass all stages.

    Args:
        sums: integral of the image at the size where an object is as large as in the window.
        squares: integral of its squares.
        side: px, of the window.
        rectangles: (n, 3, 4), of the stumps' features.
        weights: (n, 3).
        stumps: (n, 3), threshold, low, high.
        ends: of the stages, behind each one's last stump.
        limits: of the stages' sums.
        place: (5,), the object's width by pixel, p0 u + p1 v + p2, and px of the image by px of
            the full one, across and down.
        size: px, of the objects that are searched for, in the full image.
        margin: px, that the expected width may differ from `size`.
        stride: px, between windows.
        pad: px, of the rim around the image.
        least: standard deviation of a window that shows something, grey levels.
        found: (m, 3), to be written.

    Returns:
        How many passed, at most m.
    """
    count, middle = 0, 0.5 * side
    flat, corners = sums.ravel(), corners_of(rectangles, sums.shape[1])
    for top in range(0, sums.shape[0] - side, stride):
        for left in range(0, sums.shape[1] - side, stride):
            u = (left - pad + middle) / place[3] - 0.5
            v = (top - pad + middle) / place[4] - 0.5
            if abs(place[0] * u + place[1] * v + place[2] - size) > margin:
                continue
            scale = scale_of(sums, squares, left, top, side)
            if scale < least * side * side:
                continue
            at = np.uint64(top * sums.shape[1] + left)
            over = passed_by(flat, corners, weights, stumps, ends, limits, at, scale)
            if over >= 0.0 and count < len(found):
                found[count, 0], found[count, 1], found[count, 2] = u, v, over
                count += 1
    return count
