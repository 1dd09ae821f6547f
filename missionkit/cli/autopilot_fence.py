"""The fence of a mission as an autopilot or a ground station keeps it."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import NamedTuple

from missionkit.chart.checks.geofence_violations import walls
from missionkit.chart.model.mission import Mission
from missionkit.errors import UsageError
from missionkit.geometry import vec
from missionkit.guards.geofence import InsideFence
from missionkit.interchange.plan import Home, LatLon, degrees
from missionkit.interchange.qgc_plan_writer import plan_document
from missionkit.polygons import Corner, widened


class AutopilotFence(NamedTuple):
    """A polygon to stay inside of, holes to stay out of, and a ceiling."""

    corners: tuple[Corner, ...]
    holes: tuple[tuple[Corner, ...], ...]
    height: float  # m
    left_out: tuple[str, ...] = ()  # what an autopilot cannot keep


def fence_of(mission: Mission, margin: float) -> AutopilotFence:
    """Return the fence of the mission's failsafes, `margin` (m) wider, its holes narrower.

    The mission's own failsafe is to act first, and the autopilot's if that fails. Several boxes
    become the box round them all.

    Raises:
        UsageError: no failsafe has a fence, or it cannot be given to an autopilot.
    """
    found = walls(mission)
    if not found:
        raise UsageError(
            f"mission {mission.name!r}: no failsafe has a fence; add one such as "
            "{when: {not: {use: inside_fence, north: [-20, 120], east: [-40, 60], height: 30}}, "
            "to: land}"
        )
    if len(found) == 1:
        return _widened(found[0], margin)
    if any(it.polygon is not None or it.holes for it in found):
        raise UsageError(
            f"mission {mission.name!r}: its failsafes have {len(found)} fences, and an autopilot "
            "keeps one polygon: give it one, in the section 'fence'"
        )
    norths, easts = zip(*(corner for it in found for corner in it.outline()), strict=True)
    whole = InsideFence(
        north=(min(norths), max(norths)),
        east=(min(easts), max(easts)),
        height=max(it.ceiling for it in found),
    )
    return _widened(whole, margin)


def plan_file(
    mission: Mission, around: AutopilotFence, points: Sequence[tuple[float, float, float]]
) -> str:
    """Return a plan for QGroundControl with the fence and rally points, and no mission items.

    Args:
        mission: has an `origin`.
        around: the fence.
        points: rally points: north, east, height above home (m).

    Raises:
        UsageError: the mission has no origin.
    """
    if mission.origin is None:
        raise UsageError(
            f"mission {mission.name!r} has no 'origin': a file needs latitude and longitude"
        )
    origin = mission.origin.geodetic

    def spots(shape: Sequence[Corner]) -> list[LatLon]:
        return [LatLon(*map(degrees, origin.place(vec(*it, 0.0))[:2])) for it in shape]

    shapes = [(around.corners, True), *((hole, False) for hole in around.holes)]
    plan = plan_document(
        items=(),
        home=Home(origin.latitude, origin.longitude, origin.altitude),
        polygons=[(spots(shape), inclusion) for shape, inclusion in shapes],
        rally=[(*spots([(n, e)])[0], height) for n, e, height in points],
    )
    return json.dumps(plan, indent=2) + "\n"


def _widened(fence: InsideFence, margin: float) -> AutopilotFence:
    corners = widened(fence.outline(), margin)
    if corners is None:
        raise UsageError(
            f"the fence cannot be made {margin:g} m wider without overlapping itself: use a "
            "smaller --margin"
        )
    holes, left_out = [], []
    for number, hole in enumerate(fence.holes, 1):
        narrower = widened(hole.polygon, -margin)
        if hole.height is not None:
            left_out.append(f"hole {number}, since it may be flown over")
        elif narrower is None:
            left_out.append(f"hole {number}, which is too narrow for the margin of {margin:g} m")
        else:
            holes.append(narrower)
    return AutopilotFence(corners, tuple(holes), fence.ceiling + margin, tuple(left_out))
