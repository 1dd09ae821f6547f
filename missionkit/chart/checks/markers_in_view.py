"""Standoffs from which the camera does not see the marker that they are measured from."""

from __future__ import annotations

from collections.abc import Iterator

from missionkit.behaviors.land_on import LandOn
from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.checks.standoffs import body_radius, reach_of
from missionkit.errors import Level, Place, Problem
from missionkit.perception.aruco import Aruco
from missionkit.perception.marker_view import seen_below, unseen

LANDS = frozenset(("all", "descend"))  # phases of `land_on` that come down
HIGHEST = 10.0  # m, up to which a marker is looked for


def problems_of(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield each standoff at which no marker of the target lies wholly in the picture.

    The vehicle is taken to be level and to face the marker, as it is at its goal; the lens is
    taken to be free of distortion. Only markers that hang upright and face a known way are judged,
    and no camera on a gimbal, which can turn to them.
    """
    mission = chart.mission
    unjudged = mission.camera.use == "none" or mission.camera.gimbal is not None
    if unjudged or not chart.tree.catalogue.vehicle.over_ground:
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
            why = [unseen(camera, marker, point, reach.turn_deg) for marker in markers]
            if all(why):
                what = f"state {name!r}: at [{', '.join(f'{it:g}' for it in point)}] from"
                yield _problem(state.behavior.place, f"{what} {reach.target!r} {why[0]}", level)
                break


def dark_landings(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield each `land_on` that loses its last marker higher than it counts on.

    The vehicle is taken to be level and over the middle of the pad, the lens to be free of
    distortion. Pads are judged of which every marker is one that lies face up.
    """
    mission = chart.mission
    if mission.camera.use == "none" or mission.camera.gimbal is not None:
        return
    camera = mission.camera.model()
    for name, state, _ in chart.tree.states.values():
        use = state.behavior
        if use is None or not isinstance(use.plugin, LandOn) or use.plugin.phase not in LANDS:
            continue
        dark, target = use.plugin.dark, use.plugin.target
        mine = [
            it.plugin for it in mission.perception if getattr(it.plugin, "target", "") == target
        ]
        markers = [it for it in mine if isinstance(it, Aruco) and not it.upright]
        if not markers or len(markers) < len(mine):
            continue
        heights = (dark + 0.02 * n for n in range(round(HIGHEST / 0.02)))
        lowest = next((h for h in heights if any(seen_below(camera, m, h) for m in markers)), None)
        if lowest is None or lowest <= dark + 0.02:
            continue
        yield Problem(
            use.place,
            f"state {name!r}: below {lowest:.2f} m the camera sees no marker of {target!r} wholly, "
            f"but the pad may be out of view only below 'dark', {dark:g} m: the vehicle turns back",
            Level.WARNING,
            "marker-out-of-view",
            f"dark: {lowest:.2f}, or a smaller marker in the middle of the pad",
        )


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
