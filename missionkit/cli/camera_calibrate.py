"""`missionkit camera calibrate` and `missionkit camera board`."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Sequence
from itertools import chain, islice
from pathlib import Path
from typing import Any, NamedTuple

from missionkit.api.vehicle_camera import named
from missionkit.errors import UsageError
from missionkit.perception import charuco
from missionkit.perception.lens_calibration import (
    NAMES,
    CalibratedLens,
    calibrate,
    doubts,
)
from missionkit.vehicle.camera.camera_device import CaptureSettings
from missionkit.vehicle.camera.image_stream import images


class Squares(NamedTuple):
    """A board: how many squares, edges in metres."""

    columns: int
    rows: int
    square: float
    marker: float
    dictionary: str


def draw(squares: Squares, out: Path) -> None:
    """Write the board as a picture that prints in its true size.

    Raises:
        UsageError: there is no such board.
    """
    if out.suffix.lower() != ".png":
        raise UsageError(f"{out}: expected a file that ends in .png")
    try:
        data = charuco.printed(charuco.board(*squares))
    except ValueError as error:
        raise UsageError(str(error)) from error
    out.write_bytes(data)
    width, height = (1e3 * count * squares.square for count in squares[:2])
    print(f"wrote {out}: {width:.0f} x {height:.0f} mm; print it unscaled")  # noqa: T201


def calibration(sources: Sequence[str], squares: Squares, size: str | None, most: int) -> None:
    """Find the lens; print the mission's `camera:` section, and on stderr what is doubtful.

    Args:
        sources: images, films, devices or URLs.
        squares: of the board.
        size: WIDTHxHEIGHT to request from a device (px).
        most: number of images to inspect.

    Raises:
        UsageError: a source, the board or the size is none, or the views do not suffice.
    """
    wanted = None if size is None else _size(size)
    try:
        board = charuco.board(*squares)
        taken = chain.from_iterable(images(named(it), wanted) for it in sources)
        views = [charuco.view(it.image, board) for it in islice(taken, most)]
        lens = calibrate([it for it in views if it is not None], board)
    except ValueError as error:
        raise UsageError(str(error)) from error
    print("\n".join(_section(lens)))  # noqa: T201
    for doubt in doubts(lens):
        print(f"warning: {doubt}", file=sys.stderr)  # noqa: T201


def _size(text: str) -> CaptureSettings:
    width, _, height = text.partition("x")
    if not (width.isdecimal() and height.isdecimal()):
        raise UsageError(f"--size {text}: expected WIDTHxHEIGHT, such as 1280x720")
    return CaptureSettings(int(width), int(height), 0.0)


def _section(lens: CalibratedLens) -> Iterator[str]:
    """Yield the lines of a mission's camera, with comments on how well it is known."""
    least, most = map(math.degrees, lens.tilts)
    yield f"# reprojection error {lens.error:.3f} px over {lens.views} views"
    yield (
        f"# they cover {lens.covered:.0%} of the image, the board tilted {least:.0f} to "
        f"{most:.0f} deg"
    )
    yield f"# standard deviations: {_deviations(lens)}"
    if math.isnan(lens.deviations["k3"]):
        yield "# these views cannot distinguish k3 from 0"
    yield f"camera:\n  width: {lens.width}\n  height: {lens.height}"
    yield f"  matrix: [{', '.join(f'[{_numbers(row)}]' for row in lens.matrix)}]"
    yield f"  distortion: [{_numbers(lens.distortion)}]"


def _deviations(lens: CalibratedLens) -> str:
    spreads = {name: lens.deviations[name] for name in NAMES}
    return ", ".join(f"{name} {it:.2g}" for name, it in spreads.items() if not math.isnan(it))


def _numbers(row: Any) -> str:
    return ", ".join(f"{it:.6g}" for it in row)
