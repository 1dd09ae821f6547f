"""What the page knows of a mission before it flies."""

from __future__ import annotations

from typing import NamedTuple

from missionkit.chart.drawing.presentation_attributes import with_attributes
from missionkit.chart.drawing.svg_chart import svg
from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.state_contracts import fulfilled
from missionkit.chart.plugin_catalogue import Catalogue
from missionkit.chart.prose.requirement_text import requirement_text
from missionkit.chart.semantics.compiled_chart import HISTORY, Chart
from missionkit.engine.prepared_mission import PreparedMission
from missionkit.messages import Occupancy
from missionkit.page.facts.chart_ids import transitions, way_ids
from missionkit.page.facts.plain_values import points, vector
from missionkit.recorder.scenery import DrawnBox, Round, Scenery

CELLS_DRAWN = 20_000  # blocked cells of a known map that the page is given at most


class FlownMission(NamedTuple):
    """A mission, what flies it, and what stands around."""

    model: Mission
    catalogue: Catalogue
    plan: PreparedMission
    scenery: Scenery


def chart_picture(mission: FlownMission) -> str:
    """Return the chart as SVG with `data-state` and `data-transition`, without a style sheet."""
    drawn = fulfilled(mission.model, mission.catalogue)
    return with_attributes(svg(drawn, ids=way_ids(mission.plan.chart)))


def mission_facts(mission: FlownMission, source: str, version: str) -> dict[str, object]:
    """Return what `/api/mission` answers.

    Args:
        mission: that is shown.
        source: live, recording or play.
        version: of missionkit.
    """
    model, chart = mission.model, mission.plan.chart
    origin = model.geodetic_origin
    return {
        "source": source,
        "title": model.name,
        "summary": model.summary,
        "version": version,
        "dialect": None,
        "over_ground": mission.scenery.over_ground,
        "states": _states(chart),
        "transitions": [it.as_value(n) for n, it in enumerate(transitions(chart), 1)],
        "guards": _guards(model, chart),
        "requirements": [
            {"name": it.name, "text": requirement_text(it)} for it in model.requirements
        ],
        "events": sorted({event for it in chart.states.values() for event in _events(it)}),
        "duration": None,
        "tick": mission.plan.period,
        "parameters": {
            name: {"value": value, "text": ""} for name, value in _plain(model.params).items()
        },
        "map": _map(mission),
        "origin": None
        if origin is None
        else {"lat": origin.latitude, "lon": origin.longitude, "alt": origin.altitude},
        "tiles": None,
    }


def _plain(params: dict[str, object]) -> dict[str, object]:
    kinds = str | int | float | bool
    return {
        name: value if isinstance(value, kinds) else str(value) for name, value in params.items()
    }


def _states(chart: Chart) -> list[dict[str, object]]:
    return [
        {
            "name": state.name,
            "kind": state.kind.name,
            "parent": state.parent or None,
            "behaviour": "" if state.behavior is None else state.behavior.kind,
            "history": state.shape in HISTORY,
        }
        for state in chart.states.values()
        if state.name
    ]


def _events(state: object) -> list[str]:
    return [event for one in getattr(state, "transitions", ()) for event in one.events]


def _guards(model: Mission, chart: Chart) -> dict[str, dict[str, object]]:
    """Return every guard by the name of its answer."""
    found: dict[str, dict[str, object]] = {}
    for it in transitions(chart):
        for name in it.guards:
            known = found.setdefault(
                name,
                {
                    "text": ex.text(model.guards[name]) if name in model.guards else name,
                    "unit": "",
                    "quantity": None,
                    "for": None,
                },
            )
            if it.hold:
                known["for"] = it.hold
    return found


def _map(mission: FlownMission) -> dict[str, object]:
    scenery = mission.scenery
    return {
        "obstacles": [_obstacle(it) for it in scenery.obstacles],
        "markers": [
            {"name": it.name, "at": vector(it.position), "size": float(it.size)}
            for it in scenery.markers
        ],
        "places": [
            {"name": name, "at": [float(part) for part in it.position]}
            for name, it in mission.model.targets.items()
        ],
        "fences": [
            {
                "outline": points(it.corners),
                "holes": [points(hole) for hole in it.holes],
                "top": None,
            }
            for it in scenery.fences
        ],
        "known": None if mission.plan.map is None else _known(mission.plan.map),
    }


def _obstacle(it: Round | DrawnBox) -> dict[str, object]:
    shape: dict[str, object]
    if isinstance(it, Round):
        shape = {"shape": "round", "at": list(map(float, it.at)), "radius": float(it.radius)}
    else:
        shape = {"shape": "polygon", "outline": points(it.footprint()[:-1])}
    return {**shape, "bottom": float(it.bottom), "top": float(it.top)}


def _known(it: Occupancy) -> dict[str, object]:
    """Return the blocked cells of a known map as centres, the first of very many."""
    rows, columns = (it.costs == float("inf")).nonzero()
    cells = list(zip(rows.tolist(), columns.tolist(), strict=True))[:CELLS_DRAWN]
    return {
        "resolution": float(it.resolution),
        "turned": float(it.turned),
        "blocked": points(it.spot(row + 0.5, column + 0.5) for row, column in cells),
    }
