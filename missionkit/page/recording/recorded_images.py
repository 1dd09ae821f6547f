"""The camera frames of a flight record, kept beside in a file without a name."""

from __future__ import annotations

import base64
import bisect
import json
import tempfile


class RecordedImages:
    """JPEG images by the time they were recorded."""

    def __init__(self) -> None:
        self._file = tempfile.TemporaryFile()  # noqa: SIM115 - lives as long as the page
        self._times: list[float] = []
        self._places: list[tuple[int, int]] = []  # offset and length, bytes

    def add(self, at: float, message: bytes) -> None:
        """Keep one.

        Args:
            at: s.
            message: the JSON of a `foxglove.CompressedImage`.
        """
        jpeg = base64.b64decode(json.loads(message)["data"])
        self._times.append(at)
        self._places.append((self._file.tell(), self._file.write(jpeg)))

    def number_at(self, at: float) -> int | None:
        """Return the number of the last image that is not later than a time (s)."""
        number = bisect.bisect_right(self._times, at + 1e-6) - 1
        return None if number < 0 else number

    def jpeg(self, number: int) -> bytes | None:
        """Return an image by its number."""
        if not 0 <= number < len(self._places):
            return None
        offset, length = self._places[number]
        self._file.seek(offset)
        data = self._file.read(length)
        self._file.seek(0, 2)
        return data

    def close(self) -> None:
        """Forget all of them."""
        self._file.close()
