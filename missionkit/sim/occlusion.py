"""Occlusion and shading in the rendered image."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
import numpy.typing as npt

from missionkit.messages import Image, Points
from missionkit.sim import textures
from missionkit.sim.perspective_canvas import (
    CanvasView,
    Hull,
    in_sight,
    outline,
)
from missionkit.sim.solid_shapes import Solid, ring_of
from missionkit.sim.texture_patches import patches_of


def separator(a: Solid, b: Solid) -> tuple[float, float, float, float]:
    """Return a plane (n, d) that parts two convex bodies: a where n · x < d, b beyond.

    An eye with n · eye > d sees b in front of a. Of the planes along the bodies' own sides and
    square to the line between their centres the one with the widest gap is taken.
    """
    between = b.centre - a.centre
    lines = [between * (1.0, 1.0, 1.0), between * (1.0, 1.0, 0.0)]
    lines = [line / np.linalg.norm(line) for line in lines if np.linalg.norm(line) > 1e-9]
    normals = np.vstack([a.normals, -a.normals, b.normals, -b.normals, *lines])
    high = (a.hull.points @ normals.T).max(axis=0)
    low = (b.hull.points @ normals.T).min(axis=0)
    best = int(np.argmax(low - high))
    n, e, d = (float(c) for c in normals[best])
    return n, e, d, float(0.5 * (low[best] + high[best]))


class OcclusionScene:
    """The solids of a world, with what has been learnt about their order."""

    def __init__(self, solids: Sequence[Solid]) -> None:
        self._solids = tuple(solids)
        self._spheres = _spheres([s.hull for s in solids])
        self._planes: dict[tuple[int, int], tuple[float, float, float, float]] = {}
        self._shadows = [_shadow(s.hull) for s in solids if s.marker is None]
        self._shaded = _spheres(self._shadows)

    def arranged(
        self, view: CanvasView, hidden: frozenset[int], moving: Sequence[Solid] = ()
    ) -> list[Solid]:
        """Return the solids that may be seen, back to front.

        Each pair is ordered by a plane that parts it; a solid in front of n others comes n-th.

        Args:
            view: of the camera.
            hidden: ids of markers that are not to be seen.
            moving: solids that are in sight in this frame, back to front among themselves.
        """
        near = np.flatnonzero(in_sight(view, *self._spheres)).tolist()
        near = [i for i in near if self._solids[i].marker not in hidden]
        seen = [*(self._solids[i] for i in near), *moving]
        eye = view.eye.tolist()
        wins = [0] * len(seen)
        for k, i in enumerate(near):
            for m in range(k + 1, len(seen)):
                both = m < len(near)
                plane = self._plane(i, near[m]) if both else separator(seen[k], seen[m])
                n, e, d, offset = plane
                ahead = n * eye[0] + e * eye[1] + d * eye[2] > offset
                wins[m if ahead else k] += 1
        for m in range(len(near), len(seen)):
            wins[m] += m - len(near)
        return [seen[k] for k in sorted(range(len(seen)), key=wins.__getitem__)]

    def _plane(self, i: int, j: int) -> tuple[float, float, float, float]:
        if (i, j) not in self._planes:
            self._planes[i, j] = separator(self._solids[i], self._solids[j])
        return self._planes[i, j]

    def shade(self, canvas: Image, view: CanvasView, moving: Sequence[Solid] = ()) -> None:
        """Darken the ground where obstacles shut out the sun, in place.

        Args:
            canvas: (h, w), grey, changed in place.
            view: of the camera.
            moving: solids that cast a shadow in this frame.
        """
        near = np.flatnonzero(in_sight(view, *self._shaded)).tolist()
        for shadow in (*(self._shadows[i] for i in near), *(_shadow(it.hull) for it in moving)):
            for patch in patches_of(canvas, outline(view, shadow)):
                dark = cv2.convertScaleAbs(patch.target, alpha=0.68)
                patch.lay(np.asarray(dark, np.uint8))


def _spheres(hulls: Sequence[Hull]) -> tuple[Points, npt.NDArray[np.float64]]:
    """Return a sphere around each hull: centres (N, 3), radii (N,)."""
    centres = np.array([hull.points.mean(axis=0) for hull in hulls]).reshape(-1, 3)
    reach = [
        np.linalg.norm(hull.points - centre, axis=1).max()
        for hull, centre in zip(hulls, centres, strict=True)
    ]
    return centres, np.array(reach, dtype=np.float64)


def _shadow(hull: Hull) -> Hull:
    """Return the shadow of a body on the ground."""
    p = hull.points
    spots = p[:, :2] - p[:, 2:] / textures.SUN[2] * textures.SUN[:2]
    around = cv2.convexHull(spots.astype(np.float32))[:, 0].astype(np.float64)
    return ring_of(np.column_stack([around, np.zeros(len(around))]))
