"""Textures drawn from noise: ground, bark, plaster, sky and printed marker boards.

A texture is an 8-bit grey array (rows, columns). Ground textures repeat without a seam. Each
look is a constant of the simulator: it is drawn once a process, from a fixed seed, and shared.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Iterator
from typing import NamedTuple

import cv2
import numpy as np
import numpy.typing as npt

from missionkit.messages import Image

Field = npt.NDArray[np.float32]  # (rows, columns)

SEED = 20250
SUN = np.array([-0.55, -0.35, -0.76])  # towards the sun, NED: from the south-west, 49° up
TRUNK_AZIMUTHS = 16  # azimuths from which a trunk is drawn
WHITE, BLACK = 225, 28  # grey levels of paper and ink


class GroundLook(NamedTuple):
    """Grey level and contrast of a ground texture; `GROUNDS` has one for each name of `Ground`."""

    mean: float
    contrast: float  # sd of the patches of decimetres and metres
    detail: float  # sd of blades and grains of millimetres and centimetres


GROUNDS = {
    "grass": GroundLook(104, 17, 19),
    "soil": GroundLook(122, 13, 13),
    "gravel": GroundLook(138, 8, 24),
    "concrete": GroundLook(158, 6, 5),
    "grid": GroundLook(128, 7, 5),
    "lines": GroundLook(112, 6, 6),
}
LINE_WIDTH = 0.05  # m
LINE_EVERY = {"grid": (1.0, 1.0), "lines": (2.5, 0.0)}  # m apart, to the east and to the north
WHITE_LINE = 212  # grey level


def fractal(
    rng: np.random.Generator, coarsest: tuple[int, int], octaves: int, fall: float
) -> Field:
    """Return seamless noise of zero mean and unit sd, of `coarsest` cells doubled `octaves` times.

    Each doubling adds white noise of `fall` times the sd of the one before: below 1 the noise is
    smooth, about 1 every scale is equally strong.

    Args:
        rng: source of the noise.
        coarsest: rows and columns of the first layer.
        octaves: how often it is doubled.
        fall: sd of a layer over that of the one before.
    """
    noise = rng.standard_normal(coarsest, dtype=np.float32)
    for octave in range(1, octaves + 1):
        noise = _doubled(noise)
        noise += fall**octave * rng.standard_normal(noise.shape, dtype=np.float32)
    return np.asarray((noise - noise.mean()) / noise.std(), np.float32)


def _doubled(noise: Field) -> Field:
    """Enlarge seamless noise by two, keeping it seamless."""
    rim = 2
    tiled = np.pad(noise, rim, mode="wrap")
    big = cv2.resize(tiled, None, fx=2.0, fy=2.0, interpolation=cv2.INTER_CUBIC)
    return np.asarray(big[2 * rim : -2 * rim, 2 * rim : -2 * rim], np.float32)


def grey(values: Field) -> Image:
    """Round and clip to 8 bits."""
    return np.clip(np.rint(values), 0, 255).astype(np.uint8)


def pyramid(texture: Image) -> tuple[Image, ...]:
    """Return the texture and its halves by area, down to 4 texels."""
    levels = [texture]
    while min(levels[-1].shape) >= 8:
        rows, columns = levels[-1].shape
        half = (columns // 2, rows // 2)
        smaller = cv2.resize(levels[-1], half, interpolation=cv2.INTER_AREA)
        levels.append(np.asarray(smaller, np.uint8))
    return tuple(levels)


@functools.cache
def ground_patches(name: str) -> Image:
    """Return (2048, 2048), or (2000, 2000) with lines, seamless: the ground's coarse structure."""
    look = GROUNDS[name]
    rng = np.random.default_rng(SEED)
    if name in LINE_EVERY:  # whole metres long, so that lines meet where it repeats
        return grey(look.mean + look.contrast * fractal(rng, (125, 125), 4, 0.8))
    noise = fractal(rng, (4, 4), 9, 1.0)
    bare = 0.5 + 0.5 * np.tanh(3.0 * (fractal(rng, (8, 8), 8, 0.55) - 1.2))
    return grey(look.mean + look.contrast * (noise + 1.3 * bare))


@functools.cache
def ground_detail(name: str) -> Image:
    """Return (1024, 1024), or (1000, 1000) with lines, seamless, about 128: added to the coarse."""
    look = GROUNDS[name]
    rng = np.random.default_rng(SEED + 1)
    if name in LINE_EVERY:
        return grey(128 + look.detail * fractal(rng, (125, 125), 3, 1.05))
    noise = fractal(rng, (64, 64), 4, 1.05)
    return grey(128 + look.detail * noise)


def with_lines(texture: Image, name: str, texel: float, level: float) -> Image:
    """Return a ground texture with its painted lines, about whole multiples of their distance.

    Args:
        texture: seamless, east to the right and north downwards from 0, 0.
        name: of the ground.
        texel: m.
        level: grey level of the lines.
    """
    if name not in LINE_EVERY:
        return texture
    columns, rows = (_painted(side, texel, every) for side, every in _sides(texture, name))
    share = np.maximum(columns[None, :], rows[:, None])
    return grey(np.asarray((1.0 - share) * texture + share * level, np.float32))


def _sides(texture: Image, name: str) -> Iterator[tuple[int, float]]:
    return zip(texture.shape[::-1], LINE_EVERY[name], strict=True)


def _painted(side: int, texel: float, every: float) -> Field:
    """Return how much of each texel of a row lines cover."""
    if every <= 0.0:
        return np.zeros(side, np.float32)
    middles = (np.arange(side) + 0.5) * texel
    away = np.abs((middles + 0.5 * every) % every - 0.5 * every)
    covered = (0.5 * (LINE_WIDTH + texel) - away) / min(texel, LINE_WIDTH)
    return np.asarray(np.clip(covered, 0.0, min(1.0, LINE_WIDTH / texel)), np.float32)


@functools.cache
def bark() -> tuple[tuple[Image, ...], ...]:
    """Return for each of `TRUNK_AZIMUTHS` viewing azimuths the pyramid of a lit trunk, (512, 128).

    Columns are equidistant across the silhouette, so column x in (-1, 1) shows the surface at
    the angle asin(x) from the line of sight. Rows run from top to foot.
    """
    rng = np.random.default_rng(SEED + 2)
    fissures = fractal(rng, (2, 16), 5, 0.95)
    coat = cv2.resize(fissures, (512, 512), interpolation=cv2.INTER_CUBIC)
    coat = coat + 0.8 * fractal(rng, (8, 8), 6, 0.9)
    foot = 1.0 - 0.35 * np.exp(-np.arange(511, -1, -1, dtype=np.float32) / 18.0)[:, None]
    across = np.arcsin((np.arange(128) + 0.5) / 64 - 1.0)
    drawn = []
    for sector in range(TRUNK_AZIMUTHS):
        # seen from the trunk, the camera's left edge of the silhouette lies clockwise
        azimuth = 2 * math.pi * sector / TRUNK_AZIMUTHS - across
        columns = np.rint(azimuth / (2 * math.pi) * 512).astype(int) % 512
        lit = shade(np.stack([np.cos(azimuth), np.sin(azimuth), 0 * azimuth], axis=-1))
        drawn.append(pyramid(grey((88 + 17 * coat[:, columns]) * lit[None, :] * foot)))
    return tuple(drawn)


def sector(azimuth: float) -> int:
    """Return which of the `TRUNK_AZIMUTHS` an azimuth (rad) is nearest to."""
    return round(azimuth / (2 * math.pi) * TRUNK_AZIMUTHS) % TRUNK_AZIMUTHS


@functools.cache
def drum(brightness: int) -> tuple[tuple[Image, ...], ...]:
    """Return for each of `TRUNK_AZIMUTHS` azimuths the pyramid of a lit round wall, (8, 32).

    Args:
        brightness: grey level of its paint.
    """
    across = np.arcsin((np.arange(32) + 0.5) / 16 - 1.0)
    drawn = []
    for sector in range(TRUNK_AZIMUTHS):
        azimuth = 2 * math.pi * sector / TRUNK_AZIMUTHS - across
        lit = shade(np.stack([np.cos(azimuth), np.sin(azimuth), 0 * azimuth], axis=-1))
        drawn.append(pyramid(np.repeat(grey(brightness * lit)[None], 8, axis=0)))
    return tuple(drawn)


def shade(normals: npt.NDArray[np.float64]) -> Field:
    """Return Lambert's brightness (0 to about 1.3) of surfaces with normals (..., 3), NED."""
    sunlit = np.maximum(0.0, normals @ SUN)
    sky = 0.5 - 0.5 * normals[..., 2]
    return np.asarray(0.42 + 0.72 * sunlit + 0.16 * sky, np.float32)


@functools.cache
def plaster() -> Image:
    """Return (512, 512), seamless: a weathered wall, unlit."""
    rng = np.random.default_rng(SEED + 3)
    wall = 150 + 9 * fractal(rng, (4, 4), 7, 0.95)
    joints = np.ones((512, 512), np.float32)
    joints[::64] = joints[1::64] = 0.8
    for row in range(8):
        joints[64 * row : 64 * row + 64, 64 * (row % 2) :: 128] = 0.8
    return grey(wall * cv2.GaussianBlur(joints, (3, 3), 0.8))


@functools.cache
def foliage() -> tuple[tuple[Image, ...], ...]:
    """Return for each of `TRUNK_AZIMUTHS` azimuths the pyramid of a lit ball, (128, 128)."""
    rng = np.random.default_rng(SEED + 4)
    leaves = 92 + 20 * fractal(rng, (4, 4), 5, 0.95)
    side = (np.arange(128) + 0.5) / 64 - 1.0
    right, down = np.meshgrid(side, side)
    out = np.sqrt(np.maximum(0.0, 1.0 - right**2 - down**2))
    drawn = []
    for sector in range(TRUNK_AZIMUTHS):
        c, s = (f(2 * math.pi * sector / TRUNK_AZIMUTHS) for f in (math.cos, math.sin))
        normals = np.stack([c * out + s * right, s * out - c * right, down], axis=-1)
        drawn.append(pyramid(grey(leaves * shade(normals))))
    return tuple(drawn)


@functools.cache
def sky() -> Image:
    """Return (256, 4): brightness from the horizon (top row) to the zenith."""
    height = np.linspace(0.0, 1.0, 256, dtype=np.float32)[:, None]
    return grey(np.repeat(212 - 62 * height**0.6, 4, axis=1))


@functools.cache
def board(dictionary: str, number: int) -> tuple[tuple[Image, ...], float]:
    """Return the pyramid of a printed marker and the board's side over the marker's.

    The marker's black square is surrounded by a quiet zone of white, one cell wide.
    """
    markers = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, dictionary))
    cells = markers.markerSize + 2
    ink = cv2.aruco.generateImageMarker(markers, number, cells)
    page = np.pad(np.where(ink > 0, WHITE, BLACK).astype(np.uint8), 1, constant_values=WHITE)
    return pyramid(np.kron(page, np.ones((32, 32), np.uint8))), (cells + 2) / cells
