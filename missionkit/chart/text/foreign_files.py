"""Files of other programs, recognised by what is in them, whatever they are called."""

from __future__ import annotations

import re
from collections.abc import Mapping
from enum import StrEnum
from types import MappingProxyType

HEAD = 64 * 1024  # bytes that are looked at


class ForeignKind(StrEnum):
    """What a file is."""

    QGC_PLAN = "QGroundControl plan"
    WAYPOINTS = "file of waypoints (QGC WPL)"
    KML = "KML document"
    KMZ = "KMZ archive"
    WPML = "DJI wayline file (WPML)"
    GEOJSON = "GeoJSON document"
    GPX = "GPX document"
    OPENCV = "OpenCV calibration"
    ROS_CAMERA = "ROS camera_info calibration"
    SCXML = "SCXML chart"
    XSTATE = "XState chart"
    ULOG = "ULog"
    DATAFLASH = "log of ArduPilot (.bin)"
    TLOG = "telemetry log (.tlog)"


LOGS = frozenset({ForeignKind.ULOG, ForeignKind.DATAFLASH, ForeignKind.TLOG})
_ROOTS: Mapping[str, ForeignKind] = MappingProxyType(
    {
        "kml": ForeignKind.KML,
        "gpx": ForeignKind.GPX,
        "scxml": ForeignKind.SCXML,
        "opencv_storage": ForeignKind.OPENCV,
    }
)
_ROOT = re.compile(r"<\s*(?:\w+:)?(kml|gpx|scxml|opencv_storage)[\s>/]")
_GEO = re.compile(
    r'"type"\s*:\s*"(FeatureCollection|Feature|GeometryCollection|(Multi)?(Point|LineString|'
    r'Polygon))"'
)
_JSON_STATES, _JSON_PLAN = re.compile(r'"states"\s*:\s*\{'), re.compile(r'"fileType"\s*:\s*"Plan"')
_OURS = re.compile(r'"missionkit"\s*:')  # a mission may be written as JSON
_ROS = tuple(re.compile(rf"^{key}\s*:", re.MULTILINE) for key in ("image_width", "camera_matrix"))


def foreign_kind(raw: bytes) -> ForeignKind | None:
    """Return what a file of another program is, None for any other file.

    Args:
        raw: the bytes of the file; the first 64 KiB are enough.

    >>> foreign_kind(b"QGC WPL 110")
    <ForeignKind.WAYPOINTS: 'file of waypoints (QGC WPL)'>
    >>> foreign_kind(b"missionkit: 1") is None
    True
    """
    head = raw[:HEAD]
    if (kind := _binary(head, raw)) is not None:
        return kind
    text = head.decode("utf-16" if head[:2] in {b"\xff\xfe", b"\xfe\xff"} else "utf-8", "replace")
    text = text.removeprefix("\ufeff").lstrip()
    if text.startswith("QGC WPL"):
        return ForeignKind.WAYPOINTS
    if text.startswith("%YAML:1.0") or "!!opencv-matrix" in text:
        return ForeignKind.OPENCV
    if text.startswith("<"):
        return _xml(text)
    if text.startswith("{"):
        return _json(text)
    return ForeignKind.ROS_CAMERA if all(it.search(text) for it in _ROS) else None


def complaint(kind: ForeignKind, file: str) -> str:
    """Return a sentence for a file of another program where a mission was expected.

    Args:
        kind: of the file.
        file: its name.
    """
    article = "an" if str(kind)[:1] in "OX" or kind is ForeignKind.SCXML else "a"
    command = "log" if kind in LOGS else "import"
    return f"this is {article} {kind}, not a file of missionkit: missionkit {command} {file}"


def _binary(head: bytes, raw: bytes) -> ForeignKind | None:
    if head.startswith(b"PK\x03\x04"):
        names = raw if len(raw) < (1 << 22) else raw[:HEAD] + raw[-HEAD:]
        return ForeignKind.WPML if b".wpml" in names else ForeignKind.KMZ
    if head.startswith(b"ULog\x01\x12\x35"):
        return ForeignKind.ULOG
    if head.startswith(b"\xa3\x95\x80"):
        return ForeignKind.DATAFLASH
    stamped = len(head) > 20 and head[8] in {0xFD, 0xFE} and head[:2] in {b"\0\5", b"\0\6"}
    return ForeignKind.TLOG if stamped else None


def _xml(text: str) -> ForeignKind | None:
    found = _ROOT.search(text)
    if found is None:
        return None
    kind = _ROOTS[found[1]]
    return ForeignKind.WPML if kind is ForeignKind.KML and "dji.com/wpmz" in text else kind


def _json(text: str) -> ForeignKind | None:
    if _JSON_PLAN.search(text):
        return ForeignKind.QGC_PLAN
    if _GEO.search(text):
        return ForeignKind.GEOJSON
    chart = _JSON_STATES.search(text) and not _OURS.search(text)
    return ForeignKind.XSTATE if chart else None
