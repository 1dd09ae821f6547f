"""The lens of a camera from views of a ChArUco board, and how well they determine it.

A small reprojection error says that the lens fits where the board was. What it is worth elsewhere
is shown by the standard deviations, by how much of the image the views cover, and by how far the
board was tilted: https://docs.opencv.org, "Camera Calibration", calibrateCameraExtended.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

import cv2
import numpy as np

from missionkit.geometry import Mat
from missionkit.perception.charuco import View, different

LEAST_VIEWS: Final = 8
CELLS: Final = (8, 6)  # parts of the image, across and down
NAMES: Final = ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3")
POWERS: Final = {"k1": 3, "k2": 5, "k3": 7}  # of the distance from the middle

SURE: Final = 3.0  # standard deviations by which k3 must differ from 0
SLACK: Final = 1.0  # px that a coefficient may be unsure by in the corners of the image
FOCAL_SLACK: Final = 0.005  # share of the focal length
WILD: Final = 0.1  # share of the focal length by which no lens may be unsure
FLAT: Final = math.radians(4.0)  # with less tilt any focal length fits, whatever its deviation says
POOR: Final = 1.0  # px, reprojection error
COVERED: Final = 0.7
TILTED: Final = math.radians(20.0)

NO_LENS: Final = "no lens explains these views: tilt the board by 30 to 45 deg, to all sides"


@dataclass(frozen=True, slots=True)
class CalibratedLens:
    """An OpenCV calibration: `matrix` (3, 3), `distortion` (5,), and how well it is known."""

    width: int
    height: int
    matrix: Mat
    distortion: Mat
    error: float  # px, root mean square
    views: int
    deviations: Mapping[str, float]  # of each of `NAMES`, px or 1; nan: not estimated
    covered: float  # share of the image in which a corner of the board was seen
    tilts: tuple[float, float]  # rad, least and most, board against image


def calibrate(views: Sequence[View], board: Any) -> CalibratedLens:
    """Return the lens that explains the views.

    k3 is fitted only if it comes out at least `SURE` standard deviations from zero; otherwise it
    follows the noise, and bends the parts of the image that no view has reached.

    Raises:
        ValueError: the views are too few, too similar, of several sizes, or explained by no lens.
    """
    if len(views) < LEAST_VIEWS:
        raise ValueError(f"the board is seen in {len(views)} images; {LEAST_VIEWS} are needed")
    if len({(it.width, it.height) for it in views}) > 1:
        raise ValueError("the images are of several sizes; all must come from one camera")
    kept = different(views)
    if len(kept) < LEAST_VIEWS:
        raise ValueError(
            f"only {len(kept)} of {len(views)} views differ; {LEAST_VIEWS} are needed: "
            "move and tilt the board between them"
        )
    try:
        lens = _fitted(kept, board, 0)
        if abs(lens.distortion[4]) < SURE * lens.deviations["k3"]:
            lens = _fitted(kept, board, cv2.CALIB_FIX_K3)
    except cv2.error as error:  # as of corners that all lie on a line
        raise ValueError(NO_LENS) from error
    if not _is_one(lens):
        raise ValueError(NO_LENS)
    return lens


def doubts(lens: CalibratedLens) -> Iterator[str]:
    """Yield what the views do not determine, a sentence each, with what would help.

    A deviation s of k_n moves a pixel by f r^(2n+1) s, of p by 3 f r² s, at r = |pixel - c| / f.
    """
    if lens.error > POOR:
        yield (
            f"a reprojection error of {lens.error:.1f} px is too much: the board bends, images are "
            "blurred, or it is not the board that was named"
        )
    if lens.covered < COVERED:
        yield (
            f"the board covers {lens.covered:.0%} of the image: what lies outside is guessed; "
            "show it at the edges and in the corners"
        )
    if lens.tilts[1] < TILTED:
        yield (
            f"the board is tilted by {math.degrees(lens.tilts[1]):.0f} deg at most: "
            "tilt it by 30 to 45 deg, to all sides"
        )
    focal = float(lens.matrix[0, 0])
    share = lens.deviations["fx"] / focal
    if share > FOCAL_SLACK:
        yield f"the focal length is known to {share:.1%} only, and so is every distance: tilt more"
    middle = lens.matrix[:2, 2]
    reach = float(np.linalg.norm(np.maximum(middle, (lens.width, lens.height) - middle)) / focal)
    for name, value in zip(NAMES[4:], lens.distortion, strict=True):
        spread = lens.deviations[name]
        moves = focal * spread * (reach ** POWERS[name] if name in POWERS else 3.0 * reach**2)
        if moves > SLACK:
            yield (
                f"{name} = {value:.3g} ± {spread:.2g} is not determined, worth ± {moves:.1f} px in "
                "the corners of the image: more views there, sharper ones"
            )


def _is_one(lens: CalibratedLens) -> bool:
    """Say whether what was fitted can be a lens at all."""
    spreads = [lens.deviations[name] for name in NAMES[:8]]
    if not np.isfinite([*spreads, *lens.matrix.ravel(), *lens.distortion]).all():
        return False
    return lens.tilts[1] > FLAT and max(spreads[:2]) < WILD * float(lens.matrix[0, 0])


def _fitted(views: Sequence[View], board: Any, flags: int) -> CalibratedLens:
    corners = np.asarray(board.getChessboardCorners(), np.float32)
    width, height = views[0].width, views[0].height
    error, matrix, distortion, turns, _, deviations, _, _ = cv2.calibrateCameraExtended(
        [corners[it.ids] for it in views],
        [np.asarray(it.pixels, np.float32) for it in views],
        (width, height),
        np.eye(3),
        np.zeros(5),
        flags=flags,
    )
    spreads = [float(it) for it in np.ravel(deviations)[: len(NAMES)]]
    if flags & cv2.CALIB_FIX_K3:
        spreads[-1] = math.nan
    tilts = [math.acos(min(1.0, abs(float(cv2.Rodrigues(it)[0][2, 2])))) for it in turns]
    return CalibratedLens(
        width,
        height,
        np.asarray(matrix, np.float64),
        np.asarray(distortion, np.float64).ravel()[:5],
        float(error),
        len(views),
        dict(zip(NAMES, spreads, strict=True)),
        _covered(views),
        (min(tilts), max(tilts)),
    )


def _covered(views: Sequence[View]) -> float:
    """Return the share of the image's parts in which a corner was seen."""
    size = np.array([views[0].width, views[0].height])
    pixels = np.vstack([it.pixels for it in views])
    parts = np.clip((pixels + 0.5) * CELLS // size, 0, np.array(CELLS) - 1)
    return len(np.unique(parts, axis=0)) / math.prod(CELLS)
