"""The formats of plans: from the bytes of a file to a plan, and back."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType

from missionkit.chart.text.foreign_files import ForeignKind
from missionkit.interchange.bounded_input import (
    ForeignFileError,
    json_of,
    members,
    text_of,
    xml_of,
)
from missionkit.interchange.feature_plan import Areas, plan_of
from missionkit.interchange.features import Feature
from missionkit.interchange.geojson import geojson, read_geojson
from missionkit.interchange.gpx import gpx, read_gpx
from missionkit.interchange.kml_reader import read_kml
from missionkit.interchange.kml_writer import archive, kml
from missionkit.interchange.ledger import Ledger
from missionkit.interchange.plan import Plan
from missionkit.interchange.plan_features import features_of
from missionkit.interchange.qgc_plan_reader import read_plan
from missionkit.interchange.qgc_plan_writer import plan_json
from missionkit.interchange.waypoints_file import read_waypoints, waypoints_text
from missionkit.interchange.wpml_reader import read_wpml
from missionkit.interchange.wpml_writer import wpml

PLANS = frozenset(
    {
        *(ForeignKind.QGC_PLAN, ForeignKind.WAYPOINTS, ForeignKind.KML, ForeignKind.KMZ),
        *(ForeignKind.WPML, ForeignKind.GEOJSON, ForeignKind.GPX),
    }
)
DJI_SUFFIX = ".wpml.kmz"


def plan_from(raw: bytes, kind: ForeignKind, areas: Areas, ledger: Ledger) -> Plan:
    """Return the plan in a file.

    Args:
        raw: the bytes of the file.
        kind: one of `PLANS`.
        areas: what an area is of which the file does not say it.
        ledger: gets an entry for each item.

    Raises:
        ForeignFileError: it cannot be read.
    """
    match kind:
        case ForeignKind.QGC_PLAN:
            return read_plan(json_of(raw), ledger)
        case ForeignKind.WAYPOINTS:
            return read_waypoints(text_of(raw), ledger)
        case ForeignKind.GEOJSON:
            return plan_of(read_geojson(json_of(raw), ledger), areas, ledger)
        case ForeignKind.GPX:
            return plan_of(read_gpx(xml_of(raw), ledger), areas, ledger)
        case ForeignKind.WPML:
            return _waylines(raw, ledger)
        case _:
            return plan_of(_kml_features(raw, ledger), areas, ledger)


def _waylines(raw: bytes, ledger: Ledger) -> Plan:
    if not raw.startswith(b"PK"):
        return read_wpml(None, xml_of(raw), ledger)
    files = members(raw)
    named = {Path(name).name: data for name, data in files.items()}
    waylines, template = (
        None if name not in named else xml_of(named[name])
        for name in ("waylines.wpml", "template.kml")
    )
    return read_wpml(waylines, template, ledger)


def _kml_features(raw: bytes, ledger: Ledger) -> list[Feature]:
    if not raw.startswith(b"PK"):
        return list(read_kml(xml_of(raw), ledger))
    files = members(raw)
    if not files:
        raise ForeignFileError("the archive holds no .kml file")
    return [it for data in files.values() for it in read_kml(xml_of(data), ledger)]


def _kml(plan: Plan, name: str, ledger: Ledger) -> bytes:
    del ledger  # it says everything
    return kml(features_of(plan), name)


def _kmz(plan: Plan, name: str, ledger: Ledger) -> bytes:
    return archive([("doc.kml", _kml(plan, name, ledger))])


def _geojson(plan: Plan, name: str, ledger: Ledger) -> bytes:
    del ledger
    return geojson(features_of(plan), name).encode()


def _qgc(plan: Plan, name: str, ledger: Ledger) -> bytes:
    del name
    return plan_json(plan, ledger).encode()


def _waypoints(plan: Plan, name: str, ledger: Ledger) -> bytes:
    del name
    return waypoints_text(plan, ledger).encode()


def _wpml(plan: Plan, name: str, ledger: Ledger) -> bytes:
    del name
    return wpml(plan, ledger)


Writer = Callable[[Plan, str, Ledger], bytes]
WRITERS: Mapping[str, tuple[ForeignKind, Writer]] = MappingProxyType(
    {
        ".plan": (ForeignKind.QGC_PLAN, _qgc),
        ".waypoints": (ForeignKind.WAYPOINTS, _waypoints),
        DJI_SUFFIX: (ForeignKind.WPML, _wpml),
        ".kml": (ForeignKind.KML, _kml),
        ".kmz": (ForeignKind.KMZ, _kmz),
        ".geojson": (ForeignKind.GEOJSON, _geojson),
        ".gpx": (ForeignKind.GPX, gpx),
    }
)
"""By how the name of the file ends."""


def writer_of(path: Path) -> tuple[ForeignKind, Writer]:
    """Return the format that the name of a file asks for.

    Raises:
        ForeignFileError: there is none.
    """
    name = path.name.lower()
    suffix = next((it for it in WRITERS if name.endswith(it)), None)
    if suffix is None:
        raise ForeignFileError(f"{path}: expected a name that ends in {', '.join(sorted(WRITERS))}")
    return WRITERS[suffix]
