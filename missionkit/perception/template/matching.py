"""Normalised cross-correlation with several templates, at the size that is expected.

For template t and window w, both less their means: r = Σ t w / √(Σ t² Σ w²), from -1 to 1; the
best of all templates counts, at its local maxima.
"""

from __future__ import annotations

from typing import Final

import cv2
import numpy as np
import numpy.typing as npt

from missionkit.geometry import Mat
from missionkit.messages import Image
from missionkit.perception.apparent_size import SizeGate
from missionkit.perception.size_pyramid import LEAST_SD, Found, grouped, level_of, widths

LEAST: Final = 0.45  # of the correlation: less is chance
PEAK: Final = np.ones((3, 3), np.uint8)

Templates = npt.NDArray[np.float32]  # (n, side, side)


def objects(
    image: Image, templates: Templates, inner: float, gate: SizeGate, spans: tuple[float, float]
) -> list[Found]:
    """Return what looks like one of the templates; its margin is the correlation.

    Args:
        image: (h, w), grey.
        templates: (n, side, side).
        inner: px, of the object in a template.
        gate: which width is searched for where.
        spans: px, least and largest width.
    """
    side = templates.shape[1]
    parts = [np.empty((0, 4))]
    for width in widths(*spans):
        level = level_of(image, width, gate.aspect, inner, side)
        r = correlation(level.image, templates)
        places, values = _peaks(r)
        u, v = ((places[:, i] - level.pad + 0.5 * side) / level.scale[i] - 0.5 for i in (0, 1))
        expected = gate.plane[0] * u + gate.plane[1] * v + gate.plane[2]
        fits = np.abs(expected - width) <= gate.margin
        parts.append(np.column_stack([u, v, np.full(len(u), width), values])[fits])
    return grouped(np.vstack(parts))


def correlation(image: Image, templates: Templates) -> npt.NDArray[np.float32]:
    """Return the best correlation for each place of a window, (h - side + 1, w - side + 1).

    A window that is flat correlates with nothing: 0.
    """
    side = templates.shape[1]
    flat = image.astype(np.float32)
    best = np.full((image.shape[0] - side + 1, image.shape[1] - side + 1), -1.0, np.float32)
    for template in templates:
        np.maximum(best, cv2.matchTemplate(flat, template, cv2.TM_CCOEFF_NORMED), out=best)
    mean, square = (
        cv2.boxFilter(it, -1, (side, side), anchor=(0, 0))[: best.shape[0], : best.shape[1]]
        for it in (flat, flat * flat)
    )
    best[~(square - mean * mean > LEAST_SD**2)] = 0.0
    return best


def _peaks(r: npt.NDArray[np.float32]) -> tuple[Mat, Mat]:
    """Return the local maxima, (n, 2) column and row between pixels, and their values (n,)."""
    top = (r >= LEAST) & (r >= cv2.dilate(r, PEAK))
    top[[0, -1], :] = top[:, [0, -1]] = False
    rows, columns = np.nonzero(top)
    values = r.astype(np.float64)
    middle = values[rows, columns]
    places = np.column_stack(
        [
            columns + _vertex(values[rows, columns - 1], middle, values[rows, columns + 1]),
            rows + _vertex(values[rows - 1, columns], middle, values[rows + 1, columns]),
        ]
    )
    return places, middle


def _vertex(before: Mat, at: Mat, after: Mat) -> Mat:
    """Return where, from -0.5 to 0.5, a parabola through three neighbours is highest."""
    bend = 2.0 * at - before - after
    shift = 0.5 * (after - before) / np.where(bend > 1e-9, bend, 1.0)
    return np.clip(np.where(bend > 1e-9, shift, 0.0), -0.5, 0.5)
