"""Images of maps: PNG and PGM, whose size is looked at before anything is decoded."""

from __future__ import annotations

import re
import struct
import zlib

import cv2
import numpy as np
import numpy.typing as npt

Shades = npt.NDArray[np.float64]
"""(height, width), 0 black to 1 white; NaN where the image is transparent."""

PNG = b"\x89PNG\r\n\x1a\n"
_SPACE = rb"(?:[ \t\r\n]|#[^\r\n]*[\r\n])+"
_PGM = re.compile(
    rb"(P[25])" + _SPACE + rb"(\d{1,9})" + _SPACE + rb"(\d{1,9})" + _SPACE + rb"(\d{1,9})[ \t\r\n]"
)


def decode_shades(data: bytes, most: int) -> Shades:
    """Return the shades of a PNG or PGM file.

    Grey is value / largest value, also of 16 bits and of a PGM whose largest value is another
    than 255; of colours the mean, as map_server does. A pixel that is transparent in the least is
    not known.

    Args:
        data: of the file.
        most: pixels it may have.

    Raises:
        ValueError: it is neither, is too large, or its data do not fit its header.
    """
    if data.startswith(PNG) and len(data) >= 33:
        width, height = struct.unpack(">II", data[16:24])
        _require_size(width, height, most)
        return _png(data)
    header = _PGM.match(data)
    if header is None:
        raise ValueError(f"these {len(data)} bytes are not a PNG or PGM image")
    width, height, largest = (int(header[part]) for part in (2, 3, 4))
    _require_size(width, height, most)
    if not 0 < largest < 65536:
        raise ValueError(f"its largest value is {largest}, expected 1 to 65535")
    body, count = data[header.end() :], width * height
    values = _text(body, count) if header[1] == b"P2" else _binary(body, count, largest)
    if len(values) != count:
        raise ValueError(f"{width} x {height} pixels by its header, but {len(values)} in the file")
    if values.max() > largest:
        raise ValueError(f"a pixel of {values.max()}, and {largest} is the largest by its header")
    return values.reshape(height, width).astype(np.float64) / largest


def _require_size(width: int, height: int, most: int) -> None:
    if width < 1 or height < 1:
        raise ValueError(f"it has {width} x {height} pixels")
    if width * height > most:
        raise ValueError(f"{width} x {height} pixels, and {most} are the most; use larger cells")


def _binary(body: bytes, count: int, largest: int) -> npt.NDArray[np.int64]:
    dtype = np.dtype("u1" if largest < 256 else ">u2")
    whole = min(count, len(body) // dtype.itemsize)
    return np.frombuffer(body, dtype, whole).astype(np.int64)


def _text(body: bytes, count: int) -> npt.NDArray[np.int64]:
    words = re.sub(rb"#[^\r\n]*", b"", body).split()[: count + 1]
    if not all(word.isdigit() and len(word) < 7 for word in words):
        raise ValueError("a pixel is not a number")
    return np.array([int(word) for word in words[:count]], np.int64)


def _require_whole(data: bytes) -> None:
    """Follow a PNG's chunks to its end and compare their checksums.

    Raises:
        ValueError: it is cut short or was changed.
    """
    at, kind = len(PNG), b""
    while kind != b"IEND":
        if at + 12 > len(data):
            raise ValueError("a PNG that cannot be decoded: it is cut short")
        (length,) = struct.unpack(">I", data[at : at + 4])
        kind, end = data[at + 4 : at + 8], at + 8 + length
        if data[end : end + 4] != struct.pack(">I", zlib.crc32(data[at + 4 : end])):
            raise ValueError("a PNG that cannot be decoded: it is cut short or damaged")
        at = end + 4


def _png(data: bytes) -> Shades:
    _require_whole(data)
    try:
        image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error as error:
        raise ValueError(f"a PNG that cannot be decoded: {error}") from None
    if image is None:
        raise ValueError("a PNG that cannot be decoded")
    largest = 65535.0 if image.dtype == np.uint16 else 255.0
    if image.ndim == 2:
        return image.astype(np.float64) / largest
    colours, alpha = image[..., :3], image[..., 3:]
    shades = colours.astype(np.float64).mean(axis=2) / largest
    return np.where((alpha < largest).any(axis=2), np.nan, shades)
