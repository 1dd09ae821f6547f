"""Files of other programs, read within bounds: nothing in them is executed or fetched."""

from __future__ import annotations

import io
import json
import math
import zipfile
import zlib
from collections.abc import Iterable
from pathlib import Path
from typing import Any, TypeVar
from xml.etree.ElementTree import Element, ParseError

from defusedxml import DefusedXmlException
from defusedxml.ElementTree import fromstring

from missionkit.chart.text.regular_file import read_bytes
from missionkit.errors import UsageError

MOST_BYTES = 32 * 1024 * 1024
MOST_MEMBERS = 1_000  # files in an archive
MOST_DEPTH = 100  # of JSON and XML
MOST_VALUES = 2_000_000
LARGEST = 1e9  # of a number in a plan: no degrees, metres or seconds are more
T = TypeVar("T")
_MARKS = ((b"\xef\xbb\xbf", "utf-8-sig"), (b"\xff\xfe", "utf-16"), (b"\xfe\xff", "utf-16"))


class ForeignFileError(UsageError):
    """A file of another program that cannot be read, in one sentence."""


def read(path: Path) -> bytes:
    """Return the bytes of a file.

    Raises:
        ForeignFileError: it cannot be read, is empty or too large.
    """
    try:
        raw = read_bytes(path, MOST_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
        raise ForeignFileError(f"{path}: cannot be read: {reason.lower()}") from error
    if not raw:
        raise ForeignFileError(f"{path}: the file is empty")
    if len(raw) > MOST_BYTES:
        raise ForeignFileError(f"{path}: larger than {MOST_BYTES >> 20} MiB")
    return raw


def text_of(raw: bytes) -> str:
    """Return text by its byte order mark, as UTF-8 without one.

    Raises:
        ForeignFileError: it is neither.
    """
    encoding = next((name for mark, name in _MARKS if raw.startswith(mark)), "utf-8")
    try:
        text = raw.decode(encoding)
    except UnicodeDecodeError as error:
        raise ForeignFileError(
            f"not {encoding.upper()} text at byte {error.start}: save the file as UTF-8"
        ) from error
    if "\0" in text:
        raise ForeignFileError("this is a binary file, not text")
    return text


def json_of(raw: bytes) -> Any:
    """Return what JSON says; NaN and Infinity, which QGroundControl writes, are None.

    Raises:
        ForeignFileError: it is not JSON, or too deep.
    """
    text = text_of(raw)
    try:
        found = json.loads(text, parse_constant=lambda _: None, parse_float=_finite)
    except json.JSONDecodeError as error:
        end = error.pos >= len(text.rstrip())
        what = "it ends in the middle" if end else error.msg.lower()
        raise ForeignFileError(
            f"not valid JSON in line {error.lineno}, column {error.colno}: {what}"
        ) from error
    except ValueError as error:  # an integer of thousands of digits
        raise ForeignFileError(f"not valid JSON: {error}") from error
    except RecursionError as error:
        raise ForeignFileError(f"nested deeper than {MOST_DEPTH} levels") from error
    _require_shallow(found)
    return found


def xml_of(raw: bytes) -> Element:
    """Return the root of an XML document, without entities, DTDs or anything outside of it.

    Raises:
        ForeignFileError: it is not XML, too deep or too long, or declares entities.
    """
    try:
        root: Element = fromstring(raw, forbid_dtd=True)
    except ParseError as error:
        line, column = error.position
        raise ForeignFileError(
            f"not valid XML in line {line}, column {column + 1}: {str(error).split(':')[0]}"
        ) from error
    except DefusedXmlException as error:
        raise ForeignFileError(
            "it declares a DTD or entities, which are not read: remove them"
        ) from error
    except (ValueError, LookupError) as error:  # an encoding that there is none of
        raise ForeignFileError(f"not valid XML: {error}") from error
    waiting, seen = [(root, 1)], 0
    while waiting:
        element, depth = waiting.pop()
        seen += 1
        if depth > MOST_DEPTH or seen > MOST_VALUES:
            raise ForeignFileError(f"nested deeper than {MOST_DEPTH} levels, or too large")
        waiting += [(each, depth + 1) for each in element]
    return root


def members(raw: bytes) -> dict[str, bytes]:
    """Return the .kml and .wpml files of an archive by name, unpacked in memory within bounds.

    Raises:
        ForeignFileError: it is not a ZIP archive, has too many files, or they are too large.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(raw)) as archive:
            listed = archive.infolist()
            if len(listed) > MOST_MEMBERS:
                raise ForeignFileError(f"the archive has more than {MOST_MEMBERS} files")
            wanted = [it for it in listed if it.filename.lower().endswith((".kml", ".wpml"))]
            found: dict[str, bytes] = {}
            left = MOST_BYTES
            for it in wanted:
                with archive.open(it) as stream:
                    data = stream.read(left + 1)  # whatever size the archive claims
                left -= len(data)
                if left < 0:
                    raise ForeignFileError(f"unpacked it is larger than {MOST_BYTES >> 20} MiB")
                found[it.filename] = data
    except (zipfile.BadZipFile, zlib.error, EOFError, OSError) as error:
        raise ForeignFileError("the ZIP archive is damaged or cut short") from error
    except (NotImplementedError, RuntimeError) as error:  # a method or a password
        raise ForeignFileError(f"the ZIP archive cannot be unpacked: {error}") from error
    return found


def local(element: Element) -> str:
    """Return the tag of an element without its namespace."""
    return str(element.tag).rpartition("}")[2]


def child(element: Element, *names: str) -> Element | None:
    """Return the first element on a way of tags below one, whatever their namespaces."""
    found: Element | None = element
    for name in names:
        if found is None:
            return None
        found = next((each for each in found if local(each) == name), None)
    return found


def words(element: Element, *names: str) -> str:
    """Return the text of an element below one, "" without it."""
    found = child(element, *names)
    return "" if found is None else (found.text or "").strip()


def padded(values: Iterable[T], count: int) -> list[T | None]:
    """Return the first `count` values, with None for those that are missing.

    >>> padded([1, 2], 3)
    [1, 2, None]
    """
    row: list[T | None] = [*values, *[None] * count]
    return row[:count]


def number(value: object) -> float | None:
    """Return a number that something can measure, None for anything else; text is read as one.

    >>> number("12.5"), number(None), number("nan"), number(True)
    (12.5, None, None, None)
    """
    if isinstance(value, bool) or not isinstance(value, int | float | str):
        return None
    try:
        found = float(value)
    except (ValueError, OverflowError):
        return None
    return found if math.isfinite(found) and abs(found) <= LARGEST else None


def _finite(text: str) -> float | None:
    value = float(text)
    return value if math.isfinite(value) else None


def _require_shallow(data: object) -> None:
    waiting, seen = [(data, 1)], 0
    while waiting:
        value, depth = waiting.pop()
        seen += 1
        if depth > MOST_DEPTH:
            raise ForeignFileError(f"nested deeper than {MOST_DEPTH} levels")
        if seen > MOST_VALUES:
            raise ForeignFileError(f"more than {MOST_VALUES} values: too large")
        if isinstance(value, dict):
            waiting += [(each, depth + 1) for each in value.values()]
        elif isinstance(value, list):
            waiting += [(each, depth + 1) for each in value]
