"""Drawing the ground plane and the sky.

A pixel's ray has the down component g, linear in the pixel, so that lines of equal camera depth
z = h / g (h: height of the eye) are straight and parallel to the horizon g = 0. The ground is
painted in such bands, each with the texture level whose texels fit its pixels.
"""

from __future__ import annotations

import functools
import math
from typing import NamedTuple

import cv2
import numpy as np

from missionkit.geometry import Mat, Vec3
from missionkit.messages import Image
from missionkit.sim import textures
from missionkit.sim.perspective_canvas import CanvasView
from missionkit.sim.texture_patches import (
    Polygon,
    clip,
    patches_of,
    warp,
)
from missionkit.units import Spot

COARSE_TEXEL, FINE_TEXEL = 0.04, 0.005  # m, texels of the two ground textures
HAZE = 150  # grey level at the horizon
LOWEST_EYE = 0.03  # m, the eye is never drawn lower than this

Homography = list[list[float]]  # (3, 3), canvas to east, north and depth, m


class Sheet(NamedTuple):
    """A seamless texture, repeated often enough to cover its band from any starting tile."""

    image: Image
    texel: float  # m
    tile: int  # texels
    how: int  # of interpolation: linear only where texels may be larger than pixels


class Band(NamedTuple):
    """Texture for pixels that cover less than `reach` of ground, more than the band before."""

    reach: float  # m
    sheet: Sheet
    detail: Sheet | None


@functools.lru_cache(maxsize=16)
def bands(name: str, diagonal: int) -> tuple[Band, ...]:
    """Return the bands of a ground texture, near to far, for a canvas's diagonal (px)."""
    ground, white = textures.ground_patches(name), textures.WHITE_LINE
    patches = textures.pyramid(textures.with_lines(ground, name, COARSE_TEXEL, white))
    over = 128.0 + white - textures.GROUNDS[name].mean
    grain = textures.with_lines(textures.ground_detail(name), name, FINE_TEXEL, over)
    details = textures.pyramid(grain)
    fine = [_sheet(_faded(details[k], 128, 0.2 * k), FINE_TEXEL * 2**k, diagonal) for k in range(4)]
    coarse = [
        _sheet(_faded(patches[k], HAZE, 0.13 * k), COARSE_TEXEL * 2**k, diagonal) for k in range(5)
    ]
    bare = coarse[0] if name not in textures.LINE_EVERY else _sheet(ground, COARSE_TEXEL, diagonal)
    near = [Band(1.4 * sheet.texel, bare, sheet) for sheet in fine]
    far = [Band(1.4 * sheet.texel, sheet, None) for sheet in coarse[1:]]
    return (*near, *far[:-1], far[-1]._replace(reach=2.8 * far[-1].sheet.texel))


def _sheet(tile: Image, texel: float, diagonal: int) -> Sheet:
    """Lay out a square tile; a row length of a power of two would defeat the cache."""
    side = tile.shape[0]
    repeats = math.ceil(1.9 * diagonal / side) + 1
    how = cv2.INTER_LINEAR if texel in {FINE_TEXEL, COARSE_TEXEL} else cv2.INTER_NEAREST
    more = side * (repeats - 1)
    return Sheet(np.pad(tile, ((0, more), (0, more + 64)), "wrap"), texel, side, how)


def _faded(image: Image, towards: int, share: float) -> Image:
    return textures.grey((1.0 - share) * image.astype(np.float32) + share * towards)


def paint(canvas: Image, view: CanvasView, layers: tuple[Band, ...]) -> None:
    """Draw sky, horizon and ground on the whole canvas, in place.

    Args:
        canvas: (h, w), grey, changed in place.
        view: pose and lens of the camera.
        layers: textures by distance.
    """
    rays = view.rays
    g = rays[2]
    width, height = view.size
    whole: Polygon = [(0, 0), (width - 1, 0), (width - 1, height - 1), (0, height - 1)]
    canvas[:] = HAZE
    _paint_sky(canvas, clip(whole, (-g).tolist()), g)
    eye_height = max(LOWEST_EYE, -float(view.eye[2]))
    ground = np.stack([*(view.eye[i] * g + eye_height * rays[i] for i in (1, 0)), g]).tolist()
    depths = [0.0, *_depths(layers, eye_height, rays)]
    left = clip(whole, [*g[:2].tolist(), float(g[2]) - eye_height / depths[-1]])
    for band, near in zip(reversed(layers), reversed(depths[:-1]), strict=True):
        if len(left) < 3:
            return
        line = g.copy()
        line[2] -= eye_height / near if near > 0 else math.inf
        polygon = clip(left, (-line).tolist()) if near > 0 else left
        _paint_band(canvas, polygon, ground, band)
        left = clip(left, line.tolist()) if near > 0 else []


def _paint_sky(canvas: Image, polygon: Polygon, g: Vec3) -> None:
    back = np.stack([np.array([0.0, 0.0, 0.5]), -0.8 * g, np.array([0.0, 0.0, 1.0])])
    gradient = textures.sky()
    for patch in patches_of(canvas, polygon):
        drawn = warp(gradient, back, patch, int(gradient[-1, 0]), how=cv2.INTER_NEAREST)
        patch.lay(drawn)


def _depths(layers: tuple[Band, ...], height: float, rays: Mat) -> list[float]:
    """Return the camera depths (m) at which a pixel covers the `reach` of each band.

    A pixel covers z/f across and z² c/(f h) along the line of sight, c = f |∇g|; what counts is
    the geometric mean of the two, or z/f when that is longer.
    """
    focal = 1.0 / float(np.linalg.norm(rays[:, 0]))
    steepness = max(1e-6, focal * math.hypot(rays[2, 0], rays[2, 1]))
    across = [band.reach * focal for band in layers]
    return [min(it, math.cbrt(it**2 * height / steepness)) for it in across]


def _paint_band(canvas: Image, polygon: Polygon, ground: Homography, band: Band) -> None:
    if len(polygon) < 3:
        return
    (a, b, c), (d, e, f), (g, h, i) = ground
    depths = [g * x + h * y + i for x, y in polygon]
    corners = list(zip(polygon, depths, strict=True))
    low = (
        min((a * x + b * y + c) / z for (x, y), z in corners),
        min((d * x + e * y + f) / z for (x, y), z in corners),
    )
    sheets = [(s.image, _placed(ground, low, s), s.how) for s in (band.sheet, band.detail) if s]
    for patch in patches_of(canvas, polygon):
        drawn, *details = [warp(image, back, patch, 128, how=how) for image, back, how in sheets]
        for detail in details:
            cv2.addWeighted(drawn, 1.0, detail, 1.0, -128.0, dst=drawn)
        cv2.copyTo(drawn, patch.mask, patch.target)


def _placed(ground: Homography, low: Spot, sheet: Sheet) -> Mat:
    """Return canvas to unit square for a sheet laid out from east and north `low` (m)."""
    period = sheet.texel * sheet.tile
    rows, columns = sheet.image.shape
    east, north = (math.floor(at / period) * period for at in low)
    (a, b, c), (d, e, f), (g, h, i) = ground
    width, height = sheet.texel * columns, sheet.texel * rows
    across = [(a - east * g) / width, (b - east * h) / width, (c - east * i) / width]
    down = [(d - north * g) / height, (e - north * h) / height, (f - north * i) / height]
    return np.array([across, down, [g, h, i]])
