"""Plans to test with: one of everything, and generated ones."""

from __future__ import annotations

import json
from typing import Any

from hypothesis import strategies as st

from missionkit.chart.load import parse
from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import builtin
from missionkit.chart.text.foreign_files import ForeignKind, foreign_kind
from missionkit.interchange.bounded_input import json_of
from missionkit.interchange.ledger import Ledger
from missionkit.interchange.mission_plan import mission_plan
from missionkit.interchange.mission_text import mission_text
from missionkit.interchange.plan import (
    Corridor,
    Fence,
    Home,
    Land,
    LatLon,
    Place,
    Plan,
    Rally,
    Return,
    Survey,
    TakeOff,
    Turns,
    Waypoint,
)
from missionkit.interchange.plan_fitting import FitOptions, fit
from missionkit.interchange.plan_formats import plan_from

CATALOGUE = builtin()
HOME = Home(47.3977, 8.5456, 488.0)
FLAT = FitOptions(flat_ground=True)


def mission_of(text: str) -> Mission:
    return parse(text, "plan.yaml", CATALOGUE)


def imported(raw: bytes, options: FitOptions = FLAT, areas: Any = "survey") -> tuple[str, Ledger]:
    """Return the mission that a file becomes, and its ledger."""
    kind = foreign_kind(raw)
    assert kind is not None
    ledger = Ledger("file", str(kind))
    text = mission_text(fit(plan_from(raw, kind, areas, ledger), options, ledger), "plan")
    return text, ledger


def exported(text: str, writer: Any) -> tuple[bytes, Ledger]:
    """Return the file that a mission becomes, and its ledger."""
    ledger = Ledger("plan.yaml", "mission")
    return writer(mission_plan(mission_of(text), None, ledger), "plan", ledger), ledger


def item(command: int, *params: Any, frame: int = 3, **more: Any) -> dict[str, Any]:
    return {
        "type": "SimpleItem",
        "command": command,
        "frame": frame,
        "autoContinue": True,
        "params": [*params, *[0] * (7 - len(params))],
        **more,
    }


def way(lat: float, lon: float, alt: Any, frame: int = 3, **more: Any) -> dict[str, Any]:
    return item(16, 0, 0, 0, None, lat, lon, alt, frame=frame, **more)


def survey_item(**style: Any) -> dict[str, Any]:
    camera = {
        "AdjustedFootprintSide": 12,
        "AdjustedFootprintFrontal": 8,
        "DistanceToSurface": 30,
        "DistanceToSurfaceRelative": True,
    }
    return {
        "type": "ComplexItem",
        "complexItemType": "survey",
        "version": 5,
        "angle": 30,
        "polygon": [[47.3975, 8.544], [47.3982, 8.544], [47.3982, 8.545], [47.3975, 8.545]],
        "TransectStyleComplexItem": {"CameraCalc": camera, "TurnAroundDistance": 5, **style},
    }


def qgc(items: list[Any], fence: Any = None, rally: Any = (), **mission: Any) -> bytes:
    return json.dumps(
        {
            "fileType": "Plan",
            "version": 1,
            "geoFence": fence or {"circles": [], "polygons": [], "version": 2},
            "rallyPoints": {"points": list(rally), "version": 2},
            "mission": {
                "version": 2,
                "firmwareType": 12,
                "plannedHomePosition": list(HOME),
                "items": items,
                **mission,
            },
        }
    ).encode()


def read_qgc(raw: bytes) -> Any:
    assert foreign_kind(raw) is ForeignKind.QGC_PLAN
    return json_of(raw)


_offsets = st.integers(-300_000, 300_000).map(lambda it: it * 1e-8)  # deg, to 1 mm


@st.composite
def spots(draw: st.DrawFn) -> LatLon:
    lat, lon = HOME.lat + draw(_offsets), HOME.lon + draw(_offsets)
    return LatLon(round(lat, 9), round(lon, 9))


_heights = st.integers(20, 1000).map(lambda it: it * 0.1)
_speeds = st.integers(1, 100).map(lambda it: round(it * 0.1, 1))


@st.composite
def places(draw: st.DrawFn) -> Place:
    reference = draw(st.sampled_from(["above_home", "amsl", "agl"]))
    height = draw(_heights) + (HOME.alt if reference == "amsl" else 0.0)
    return Place(*draw(spots()), round(height, 4), reference)


@st.composite
def waypoints(draw: st.DrawFn) -> Waypoint:
    wait = draw(st.sampled_from([0.0, 0.0, 2.5, 30.0]))
    look = draw(st.none() | places())
    return Waypoint(
        draw(places()),
        0,
        draw(_speeds),
        wait,
        None if look else draw(st.none() | st.sampled_from([0.0, 12.5, 180.0, 270.0])),
        photo=wait > 1.0 and draw(st.booleans()),
        look_at=look,
    )


@st.composite
def areas(draw: st.DrawFn) -> Survey | Corridor:
    lat, lon = draw(spots())
    step = draw(st.integers(20, 90)) * 1e-5
    ring = (
        LatLon(lat, lon),
        LatLon(round(lat + step, 9), lon),
        LatLon(round(lat + step, 9), round(lon + step, 9)),
    )
    shared = (draw(_heights), "above_home", 0, draw(st.integers(10, 40)) * 1.0)
    angle = float(draw(st.integers(0, 179)))
    turn, speed = draw(st.sampled_from([0.0, 4.0])), draw(_speeds)
    if draw(st.booleans()):
        return Survey(ring, *shared, angle, turn, speed, exact=True)
    return Corridor(ring[:2], 30.0, *shared, turn, speed, exact=True)


@st.composite
def turns(draw: st.DrawFn) -> Turns:
    place = draw(places())
    place = Place(*place.spot, draw(_heights), "above_home")
    radius, count = draw(st.integers(2, 50)) * 1.0, draw(st.integers(1, 5)) * 1.0
    return Turns(place, radius, count, 0, draw(st.booleans()), draw(_speeds))


@st.composite
def plans(draw: st.DrawFn) -> Plan:
    middle = draw(st.lists(waypoints() | areas() | turns(), max_size=6))
    end = draw(st.sampled_from([Return(0), Land(None, 0)]) | spots().map(lambda it: Land(it, 0)))
    up = TakeOff(draw(_heights), "above_home", None, 0)
    rally = tuple(Rally(it, 0) for it in draw(st.lists(places(), max_size=2, unique=True)))
    fence = None
    if draw(st.booleans()):
        far, near = 0.02, 0.004
        box = tuple(
            LatLon(round(HOME.lat + a * far, 9), round(HOME.lon + b * far, 9))
            for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))
        )
        hole = tuple(
            LatLon(round(HOME.lat + near + a, 9), round(HOME.lon + near + b, 9))
            for a, b in ((0, 0), (0.001, 0), (0.001, 0.001))
        )
        fence = Fence(box, ((hole, 0),), 150.0, 0)
    return Plan(HOME, (up, *middle, end), fence, rally)
