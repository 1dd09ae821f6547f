"""Standoffs from which the camera does not see the marker that they are measured from."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.checks.planned_legs import Point3
from missionkit.chart.checks.standoffs import body_radius, reach_of
from missionkit.errors import Level, Place, Problem
from missionkit.geometry import Mat, conjugate, rotate
from missionkit.messages import CameraModel
from missionkit.perception.aruco import Aruco

CORNERS = ((-0.5, 0.5), (0.5, 0.5), (0.5, -0.5), (-0.5, -0.5))  # of a marker: right, up


def problems_of(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield each standoff at which no marker of the target lies wholly in the picture.

    The vehicle is taken to be level and to face the marker, as it is at its goal; the lens is
    taken to be free of distortion. Only markers that hang upright and face a known way are judged.
    """
    mission = chart.mission
    if mission.camera.use == "none" or not chart.tree.catalogue.vehicle.over_ground:
        return
    camera = mission.camera.model()
    for name, state, _ in chart.tree.states.values():
        reach = reach_of(state)
        if reach is None or reach.kind == "spiral" or state.behavior is None:
            continue
        if reach.least <= body_radius(chart):
            continue  # reported as touching
        markers = _markers(chart, reach.target)
        if not markers or not state.behavior.place.file:
            continue
        for point, level in ((reach.far, Level.ERROR), (reach.near, Level.WARNING)):
            why = [_unseen(camera, marker, point) for marker in markers]
            if all(why):
                what = f"state {name!r}: at [{', '.join(f'{it:g}' for it in point)}] from"
                yield _problem(state.behavior.place, f"{what} {reach.target!r} {why[0]}", level)
                break


def _problem(place: Place, says: str, level: Level) -> Problem:
    return Problem(
        place,
        f"{says}: the vehicle stops and waits there",
        level,
        "marker-out-of-view",
        "another standoff, camera mount or lens, or one more marker for this distance",
    )


def _markers(chart: AnalysedChart, target: str) -> list[Aruco]:
    """Return the markers of a target that are known to hang upright and to face a known way."""
    surveyed = chart.mission.targets.get(target)
    if surveyed is None or surveyed.facing_deg is None:
        return []
    plugins = [use.plugin for use in chart.mission.perception]
    mine = [it for it in plugins if getattr(it, "target", "") == target]
    markers = [it for it in mine if isinstance(it, Aruco) and it.upright]
    return markers if len(markers) == len(mine) else []


def _unseen(camera: CameraModel, marker: Aruco, standoff: Point3) -> str:
    """Return why a camera does not see a marker, "" if it does.

    Args:
        camera: on the body.
        marker: hangs upright.
        standoff: (3,), m, out, right and up of the vehicle from the target.
    """
    out, right, up = standoff
    across, above, ahead = marker.offset
    back = conjugate(camera.mount.rotation)
    corners = [
        (
            out - ahead,
            across + x * marker.size - right,
            up - above - y * marker.size,
        )
        for x, y in CORNERS
    ]
    seen = [rotate(back, np.array(it) - camera.mount.translation) for it in corners]
    if any(float(it[2]) <= 0.0 for it in seen):
        return "the marker lies beside or behind the camera"
    pixels = np.array([(camera.matrix @ it / it[2])[:2] for it in seen])
    size = np.array([camera.width - 1, camera.height - 1])
    if (pixels < 0.0).any() or (pixels > size).any():
        column, row = pixels.mean(axis=0)
        return (
            f"the marker is not wholly in the picture: its centre lies at pixel {column:.0f}, "
            f"{row:.0f} of {camera.width} x {camera.height}, and it is {_extent(pixels)} px wide"
        )
    area = _area(pixels)
    if not marker.min_area <= area <= marker.max_area:
        limit = "min_area" if area < marker.min_area else "max_area"
        bound = getattr(marker, limit)
        return f"the marker covers {area:.0f} px², beyond its {limit!r} of {bound:g} px²"
    return ""


def _extent(pixels: Mat) -> int:
    return math.ceil(float(np.ptp(pixels[:, 0])))


def _area(pixels: Mat) -> float:
    """Return the area (px²) of a polygon by the shoelace formula."""
    x, y = pixels.T
    return 0.5 * abs(float(x @ np.roll(y, 1) - y @ np.roll(x, 1)))
