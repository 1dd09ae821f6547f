"""First part of the tick: from sensor readings to the estimate."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from missionkit.engine.contained_navigator import ContainedNavigator
from missionkit.engine.feature_search import with_features
from missionkit.engine.flight_state import FlightMemory, SensorState
from missionkit.engine.ground_below import ground_below
from missionkit.engine.prepared_mission import PreparedMission
from missionkit.engine.target_tracks import (
    TrackingMemory,
    begin_tracking,
    chosen,
    observed,
    targets_at,
    with_chosen,
    with_detected,
)
from missionkit.estimation.navigator import Navigator, NavState
from missionkit.geometry import Transform, to_matrix
from missionkit.messages import (
    Estimate,
    Look,
    Observation,
    Points,
    Target,
)
from missionkit.perception.ground_plane import ViewNoise
from missionkit.perception.marker_search import Priors
from missionkit.perception.vision_pipeline import Seen
from missionkit.perception.vision_warning import begun
from missionkit.plugin_containment import Containment

STALE_SCAN = 0.5  # s; an older scan says nothing about what is near


def sense(
    plan: PreparedMission, memory: FlightMemory, seen: Observation, contain: Containment
) -> tuple[SensorState, Estimate]:
    """Fuse one observation.

    Args:
        plan: what flies.
        memory: as the last tick left it.
        seen: all that was sensed since.
        contain: keeps what went wrong in a plug-in.

    Returns:
        The filters' next memories, and the estimate that guards and behaviours see.
    """
    if isinstance(plan.navigator, ContainedNavigator):
        plan = plan._replace(navigator=plan.navigator.within(contain))
    before = memory.senses
    navigation = plan.navigator.propagate(before.navigation, seen)
    navigation = with_features(plan.navigator, navigation, seen.frame, plan.eye, plan.camera)
    state = plan.navigator.read(navigation)
    found = _look(plan, memory, navigation, state, seen, contain)
    if found.sightings:
        navigation = plan.navigator.fuse(navigation, found.sightings)
        state = plan.navigator.read(navigation)
    tracking, tracks = _tracking(plan, memory, found, state, seen.now, contain)
    targets = {**_known(plan, state), **tracks}
    if found.looks:
        looks = (with_detected(_believed(look, state), tracks) for look in found.looks)
        found = found._replace(looks=tuple(looks))
    status = seen.status or before.status
    home = before.home
    if home is None and status is not None and status.armed:
        home = state.position
    senses = SensorState(
        navigation,
        found.memory,
        seen.battery or before.battery,
        status,
        seen.scan or before.scan,
        home,
        seen.range or before.range,
        before.misfit or state.health.misfit,
        tracking,
        seen.gimbal or before.gimbal,
    )
    return senses, _estimate(plan, memory, senses, state, seen, found, targets)


def _look(
    plan: PreparedMission,
    memory: FlightMemory,
    navigation: Any,
    state: NavState,
    seen: Observation,
    contain: Containment,
) -> Seen:
    goal = memory.acting.goal
    ground, noise = 0.0, ViewNoise()
    if seen.frame is not None and plan.eye.finds_boxes:
        distance = seen.range or memory.senses.range
        ground, noise = ground_below(plan.navigator, navigation, state, distance, seen.now)
    priors = Priors(
        body=lambda at: plan.navigator.pose_at(navigation, at),
        targets={} if seen.frame is None else _known(plan, state),
        goal=None if goal is None else goal.position,
        ground=ground,
        noise=noise,
    )
    return plan.eye.look(memory.senses.eye, seen, priors, contain)


def _tracking(
    plan: PreparedMission,
    memory: FlightMemory,
    found: Seen,
    state: NavState,
    now: float,
    contain: Containment,
) -> tuple[TrackingMemory | None, Mapping[str, Target]]:
    """Return the memory of the tracks after this tick, and the tracked targets by name."""
    tracker = plan.tracker
    if tracker is None:
        return None, {}
    known = memory.senses.tracking or begin_tracking(tracker, contain)
    if known is None:
        return None, {}
    known = observed(tracker, known, found.ground, contain)
    targets = targets_at(tracker, known, now, contain)
    known = chosen(known, memory.acting.chosen, targets, state.position)
    return known, with_chosen(targets, known)


def _estimate(
    plan: PreparedMission,
    memory: FlightMemory,
    senses: SensorState,
    state: NavState,
    seen: Observation,
    found: Seen,
    targets: Mapping[str, Target],
) -> Estimate:
    chart, acting = memory.chart, memory.acting
    return Estimate(
        now=seen.now,
        position=state.position,
        velocity=state.velocity,
        attitude=state.attitude,
        rates=state.rates,
        health=state.health,
        battery=senses.battery,
        status=senses.status,
        home=senses.home,
        targets=targets,
        looks=found.looks,
        sightings=found.sightings,
        ground=found.ground,
        obstacles=_around(plan.navigator, senses, state, seen.now),
        scanned_at=None if senses.scan is None else senses.scan.at,
        scan_range=math.inf if senses.scan is None else senses.scan.range,
        events=seen.events + acting.events + _warned(senses, memory.senses),
        cycle=seen.cycle,
        map=plan.map,
        range=senses.range,
        failing=acting.failing,
        traffic=seen.traffic,
        gimbal=senses.gimbal,
        operator_silence=None if seen.operator is None else seen.operator.silent_for,
        utc=seen.utc,
        state=chart.state,
        entered_at=chart.entered_at,
        done=acting.done,
        goal=acting.goal,
    )


def _warned(now: SensorState, before: SensorState) -> tuple[str, ...]:
    """Return the events of what the camera shows although it should not."""
    return tuple(dict.fromkeys(it.event for it in begun(now.eye.warnings, before.eye.warnings)))


def _believed(look: Look, state: NavState) -> Look:
    """Keep only what the filter accepted: a decoy does not raise the confidence."""
    if not look.seen:
        return look
    accepted = (name for name in look.seen if state.targets[name].seen_at == look.at)
    return look._replace(seen=frozenset(accepted))


def _known(plan: PreparedMission, state: NavState) -> dict[str, Target]:
    """Return the targets, turned as surveyed until the camera has measured how they are turned."""
    return {
        name: target
        if target.attitude is not None or name not in plan.facing
        else target._replace(attitude=plan.facing[name])
        for name, target in state.targets.items()
    }


def _around(
    navigator: Navigator, senses: SensorState, state: NavState, now: float
) -> Points | None:
    """Return the obstacle points (N, 3), m, NED, of a fresh scan, from where it was measured.

    A scan that is newer than the last inertial sample is placed from where the vehicle is now.
    """
    scan = senses.scan
    if scan is None or now - scan.at > STALE_SCAN:
        return None
    if not len(scan.points):
        return scan.points
    body = navigator.pose_at(senses.navigation, scan.at)
    if body is None:
        body = Transform(state.attitude, state.position)
    return scan.points @ to_matrix(body.rotation).T + body.translation
