"""Camera calibrations of ROS (camera_info) and of OpenCV, as the `camera` section of a mission.

http://wiki.ros.org/camera_calibration_parsers; OpenCV's FileStorage writes YAML 1.0 or XML.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any
from xml.etree.ElementTree import Element

from pydantic import ValidationError

from missionkit.chart.text.yaml_reader import read
from missionkit.errors import FileError, Problem
from missionkit.interchange.bounded_input import (
    ForeignFileError,
    child,
    local,
    number,
    text_of,
    words,
    xml_of,
)
from missionkit.interchange.ledger import Ledger
from missionkit.perception.camera_section import Camera

MATRIX = ("camera_matrix", "cameramatrix", "k", "intrinsics", "intrinsic_matrix")
DISTORTION = ("distortion_coefficients", "distcoeffs", "dist_coeffs", "d", "distortion")
WIDTH, HEIGHT = ("image_width", "width"), ("image_height", "height")
SIZE = ("image_size", "imagesize")
MODEL = ("distortion_model",)
READ = {*MATRIX, *DISTORTION, *WIDTH, *HEIGHT, *SIZE, *MODEL}
MODELS = ("plumb_bob", "rational_polynomial")
DIGITS = 9
_TAG = re.compile(r"!!opencv-[a-z-]+|!<tag:yaml\.org,2002:opencv-[a-z-]+>")
_DIRECTIVE = re.compile(r"\A%YAML:1\.0[^\n]*\n")


def camera_text(raw: bytes, ledger: Ledger) -> str:
    """Return the `camera` section that a calibration stands for.

    Args:
        raw: of the file.
        ledger: gets an entry for each key of the file.

    Raises:
        ForeignFileError: it cannot be read, or is of a lens that missionkit does not have.
    """
    values = _values(raw)
    for key in values:
        entry = ledger.open("key", str(key)[:60])
        if key.lower() not in READ:
            ledger.refuse(entry, "a mission's camera has nothing like it")
    camera = _camera({key.lower(): value for key, value in values.items()})
    rows = ", ".join(f"[{_numbers(row)}]" for row in camera.matrix or ())
    return "\n".join(
        (
            "camera:",
            f"  width: {camera.width}",
            f"  height: {camera.height}",
            f"  matrix: [{rows}]",
            f"  distortion: [{_numbers(camera.distortion)}]",
            "",
        )
    )


def _numbers(row: Sequence[float]) -> str:
    return ", ".join(f"{it:.{DIGITS}g}" for it in row)


def _values(raw: bytes) -> Mapping[str, Any]:
    """Return the top-level keys: numbers, texts, and matrices as flat lists."""
    text = text_of(raw)
    if text.lstrip().startswith("<"):
        return dict(_of_xml(xml_of(raw)))
    text = _TAG.sub("", _DIRECTIVE.sub("\n", text.lstrip()))
    try:
        document = read(text, "calibration")
        problems = document.problems
    except FileError as error:
        raise ForeignFileError(_sentence(error.problems[0])) from error
    if problems:
        raise ForeignFileError(_sentence(problems[0]))
    if not isinstance(document.data, dict):
        raise ForeignFileError("expected keys with values")
    return {key: _flat(value) for key, value in document.data.items()}


def _sentence(problem: Problem) -> str:
    return f"line {problem.place.line}, column {problem.place.column}: {problem.message}"


def _of_xml(root: Element) -> Iterator[tuple[str, Any]]:
    for each in root:
        data = words(each, "data") if child(each, "data") is not None else (each.text or "")
        found = [number(it) for it in data.split()]
        alone = len(found) == 1 and child(each, "data") is None
        yield local(each), found[0] if alone else found


def _flat(value: Any) -> Any:
    """Return the numbers of a matrix, however it is written."""
    if isinstance(value, Mapping) and "data" in value:
        value = value["data"]
    if isinstance(value, list):
        rows = [it if isinstance(it, list) else [it] for it in value]
        return [number(it) for row in rows for it in row]
    return value


def _first(values: Mapping[str, Any], names: Sequence[str]) -> Any:
    return next((values[name] for name in names if name in values), None)


def _camera(values: Mapping[str, Any]) -> Camera:
    matrix = _row(_first(values, MATRIX), 9, "its camera matrix", "3 x 3")
    size = _first(values, SIZE) or [_first(values, WIDTH), _first(values, HEIGHT)]
    width, height = _row(size, 2, "the size of its images", "image_width and image_height")
    try:
        return Camera(
            width=int(width),
            height=int(height),
            matrix=tuple(tuple(matrix[at : at + 3]) for at in (0, 3, 6)),
            distortion=_lens(values),
        )
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"])) or "the matrix"
        raise ForeignFileError(f"{where}: {first['msg'].removeprefix('Value error, ')}") from error


def _lens(values: Mapping[str, Any]) -> tuple[float, float, float, float, float]:
    """Return k1, k2, p1, p2, k3."""
    model = _first(values, MODEL)
    if model is not None and model not in MODELS:
        raise ForeignFileError(
            f"distortion_model {str(model)[:40]!r}: a mission's camera has plumb_bob, "
            "k1, k2, p1, p2, k3"
        )
    given = _first(values, DISTORTION)
    row = [] if given is None else given
    if not isinstance(row, list) or any(it is None for it in row):
        raise ForeignFileError("its distortion coefficients are not numbers")
    if any(row[5:]):
        raise ForeignFileError(
            f"{len(row)} distortion coefficients: a mission's camera has k1, k2, p1, p2, k3; "
            "calibrate without the rational model"
        )
    k1, k2, p1, p2, k3 = [*row, 0.0, 0.0, 0.0, 0.0, 0.0][:5]
    return k1, k2, p1, p2, k3


def _row(value: Any, count: int, what: str, expected: str) -> list[float]:
    numbers = value if isinstance(value, list) else []
    found = [it for it in map(number, numbers) if it is not None]
    if len(found) != count or len(numbers) != count:
        raise ForeignFileError(f"it does not have {what}: expected {expected}")
    return found
