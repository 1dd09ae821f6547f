"""Checks that the mission provides what guards and behaviours need."""

from __future__ import annotations

from collections.abc import Iterator

from missionkit.behaviors.land_on import LandOn
from missionkit.behaviors.survey import ParallelLines
from missionkit.chart.checks.guard_regions import region_of
from missionkit.chart.checks.guarded_transitions import AnalysedChart
from missionkit.chart.model import guard_expressions as ex
from missionkit.errors import Level, Place, Problem
from missionkit.messages import names_a_track
from missionkit.planning.pad_view import cone_below
from missionkit.plugin import Plugin
from missionkit.plugin_protocols import BoxDetectorProtocol, CompositeGuardProtocol

SEEING = ("servo", "inject", "spiral")  # behaviours that work on what the camera sees


def problems_of(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield everything that waits for a marker that no detector looks for, or for no camera."""
    seen = looked_for(chart)
    camera = chart.mission.camera.use != "none"
    yield from _nothing_to_track(chart)
    tracks = chart.mission.tracking is not None
    for what, target, place in (*_guards(chart), *_behaviors(chart)):
        if target not in seen and not (tracks and names_a_track(target)):
            yield Problem(
                place,
                f"{what} needs to see {target!r}, but 'perception' has no marker for it, so it is "
                "never seen",
                Level.ERROR,
                "no-detector",
                f"perception: [{{use: aruco, target: {target}, id: ..., size: ...}}]",
            )
        elif not camera:
            yield Problem(
                place,
                f"{what} needs to see {target!r}, but 'camera' is 'use: none', so nothing is ever "
                "seen",
                Level.ERROR,
                "no-camera",
                "camera: {use: rendered}",
            )
    yield from _not_below(chart)
    yield from _no_spacing(chart)
    yield from _no_images(chart)
    yield from _nothing_moves(chart)


def _no_spacing(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield each survey of which nothing says how far apart its lines are."""
    camera = chart.mission.camera
    for _, state, _ in chart.tree.states.values():
        use = state.behavior
        if use is None or not isinstance(use.plugin, ParallelLines):
            continue
        blind = camera.use == "none" or use.plugin.with_camera(camera.model()).spacing is None
        if use.plugin.spacing is None and blind:
            yield Problem(
                use.place,
                f"behaviour {use.kind!r} has no 'spacing', and the camera does not see the ground "
                "below, so it is not known how far apart its lines are",
                Level.ERROR,
                "no-view-below",
                "camera: {mount: {tilt_deg: 90}}, or a spacing (m)",
            )


def _no_images(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield a navigator that looks at images, which the camera does not give."""
    mission = chart.mission
    navigator, camera = mission.navigation, mission.camera
    if getattr(navigator.plugin, "images", False) and not camera.drawn:
        yield Problem(
            navigator.place,
            f"navigator {navigator.kind!r} needs images of the ground, but 'camera' is "
            f"'use: {camera.use}', which gives none",
            Level.ERROR,
            "no-images",
            "camera: {use: rendered, mount: {tilt_deg: 90}}",
        )


def _nothing_moves(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield each target that the navigator is to follow and that the mission does not have."""
    mission = chart.mission
    for name in getattr(mission.navigation.plugin, "moving", ()):
        if name not in mission.targets:
            yield Problem(
                mission.navigation.place,
                f"'moving' names {name!r}, which is no target of this mission",
                Level.ERROR,
                "no-target",
                f"targets: {{{name}: {{position: [...]}}}}",
            )


def _nothing_to_track(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield that nothing finds what is to be tracked."""
    mission = chart.mission
    if mission.tracking is None:
        return
    if not any(isinstance(it.plugin, BoxDetectorProtocol) for it in mission.perception):
        yield Problem(
            mission.place("tracking"),
            "'tracking' tracks what detectors of boxes find, but 'perception' has none of them, so "
            "nothing is ever tracked",
            Level.ERROR,
            "no-detector",
            "a detector without a 'target' in 'perception'",
        )


def _not_below(chart: AnalysedChart) -> Iterator[Problem]:
    """Yield each landing that counts on a camera that does not look straight down."""
    if cone_below(chart.mission.camera.model()) > 0.0:
        return
    for _, state, _ in chart.tree.states.values():
        use = state.behavior
        if use is None or not isinstance(use.plugin, LandOn):
            continue
        if use.plugin.sigmas and use.plugin.half_angle_deg is None:
            yield Problem(
                use.place,
                "behaviour 'land_on' waits for the pad below, but the camera does not see "
                "straight down",
                Level.ERROR,
                "no-view-below",
                "camera: {mount: {tilt_deg: 70}}",
            )


def looked_for(chart: AnalysedChart) -> frozenset[str]:
    """Return the targets that a detector of the mission, or its navigator, looks for."""
    mission = chart.mission
    detected = (str(getattr(detector.plugin, "target", "")) for detector in mission.perception)
    return frozenset((*filter(None, detected), *getattr(mission.navigation.plugin, "targets", ())))


def _guards(chart: AnalysedChart) -> Iterator[tuple[str, str, Place]]:
    """Yield each guard that needs to see a target, once for each place where it is written."""
    guards = [guard for _, guard in chart.tree.guards()]
    for part in ex.opened(guards, chart.mission.guards):
        if isinstance(part, ex.Use) and part.place.file:
            for target in sorted(_seen_by(part.plugin)):
                yield f"guard {part.kind!r}", target, part.place


def _seen_by(plugin: Plugin) -> set[str]:
    region = region_of(plugin)
    boxes = () if region is None else region.may
    seen = {quantity.sees for box in boxes for quantity in box if quantity.sees}
    return seen | (plugin.sees() if isinstance(plugin, CompositeGuardProtocol) else set())


def _behaviors(chart: AnalysedChart) -> Iterator[tuple[str, str, Place]]:
    for _, state, _ in chart.tree.states.values():
        if state.behavior is not None and state.behavior.kind in SEEING:
            for target in state.behavior.plugin.targets():
                yield f"behaviour {state.behavior.kind!r}", target, state.behavior.place
