"""`missionkit camera`: calibrates a camera, and looks whether it sees the markers."""

from __future__ import annotations

import time
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import Annotated, Any

import typer

from missionkit.cli.options import told
from missionkit.errors import MissionkitError, UsageError

camera = typer.Typer(help="Calibrate a camera, and check what it sees.", no_args_is_help=True)

Dictionary = Annotated[str, typer.Option(metavar="NAME", help="of the markers")]
Most = Annotated[int, typer.Option(min=1, help="images that are looked at")]


@camera.command()
@told
def calibrate(
    sources: Annotated[
        list[str], typer.Argument(metavar="SOURCE ...", help="images, a video or a device number")
    ],
    columns: Annotated[int, typer.Option(help="squares across")] = 7,
    rows: Annotated[int, typer.Option(help="squares down")] = 5,
    square: Annotated[float, typer.Option(help="edge of a square (m)")] = 0.04,
    marker: Annotated[float, typer.Option(help="edge of a marker (m)")] = 0.03,
    dictionary: Dictionary = "DICT_4X4_50",
    images: Most = 300,
) -> None:
    """Find the lens from views of a ChArUco board; prints the mission's `camera:` section."""
    from missionkit.perception import calibration  # noqa: PLC0415

    try:
        plan = calibration.board(columns, rows, square, marker, dictionary)
        seen = (calibration.view(it, plan) for it in islice(_all(sources), images))
        lens = calibration.calibrate([it for it in seen if it is not None], plan)
    except ValueError as error:
        raise UsageError(str(error)) from error
    matrix = ", ".join(f"[{', '.join(f'{it:.6g}' for it in row)}]" for row in lens.matrix)
    print(f"# reprojection error {lens.error:.3f} px over {lens.views} views")  # noqa: T201
    print(f"camera:\n  width: {lens.width}\n  height: {lens.height}")  # noqa: T201
    print(f"  matrix: [{matrix}]")  # noqa: T201
    print(f"  distortion: [{', '.join(f'{it:.6g}' for it in lens.distortion)}]")  # noqa: T201


@camera.command()
@told
def check(
    source: Annotated[str, typer.Argument(metavar="SOURCE", help="device number, file or URL")],
    dictionary: Dictionary = "DICT_6X6_250",
    out: Annotated[Path, typer.Option(metavar="FILE.png", help="the picture")] = Path("camera.png"),
    images: Most = 30,
) -> None:
    """Detect markers, draw them into a PNG, and say what was seen and how fast."""
    from missionkit.perception import calibration  # noqa: PLC0415

    try:
        detector = calibration.detector(dictionary)
    except ValueError as error:
        raise UsageError(str(error)) from error
    image: Any = None
    corners: Any = ()
    ids: Any = None
    begun, spent, count = time.perf_counter(), 0.0, 0
    for image in islice(_all([source]), images):
        before = time.perf_counter()
        corners, ids, _ = detector.detectMarkers(image)
        spent, count = spent + time.perf_counter() - before, count + 1
    rate = count / (time.perf_counter() - begun)
    if not calibration.draw(out, image, corners, ids):
        raise UsageError(f"{out}: the picture could not be written")
    found = [] if ids is None else sorted(int(it) for it in ids.ravel())
    names = ", ".join(map(str, found)) or "none"
    print(f"{count} images of {image.shape[1]}x{image.shape[0]}, {rate:.1f} a second")  # noqa: T201
    print(f"markers in the last: {names}; detection {1e3 * spent / count:.1f} ms")  # noqa: T201
    print(f"drawn in {out}")  # noqa: T201


def _all(sources: list[str]) -> Iterator[Any]:
    """Return the images of files, videos or devices, one after the other."""
    from missionkit.perception.calibration import read  # noqa: PLC0415
    from missionkit.vehicle.device import opened  # noqa: PLC0415

    for source in sources:
        picture = read(source)
        if picture is not None:
            yield picture
            continue
        capture = opened(int(source) if source.isdecimal() else source)
        try:
            good, image = capture.read()
            if not good:
                raise MissionkitError(f"{source}: no image comes from it; is it there, a camera?")
            while good:
                yield image
                good, image = capture.read()
        finally:
            capture.release()
