"""Converts the filter's memory to the estimate that the rest of missionkit sees."""

from __future__ import annotations

import math
from collections.abc import Mapping

from missionkit.estimation import mahalanobis
from missionkit.estimation.navigator import NavState
from missionkit.estimation.tandem_ekf.filter_memory import FlyerMemory
from missionkit.estimation.tandem_ekf.measurement_rows import MeasurementRows
from missionkit.estimation.tandem_ekf.parameters import FlyerEkf
from missionkit.estimation.tandem_ekf.state_layout import D_ANGLE, D_VELOCITY, QUATERNION, RATE
from missionkit.geometry import Vec3, vec
from missionkit.messages import Health, Target


def state(
    known: FlyerMemory,
    sources: MeasurementRows,
    surveyed: Mapping[str, tuple[Vec3, float]],
    settings: FlyerEkf,
) -> NavState:
    """Return the estimate, of the centre of mass, in the mother-ship's frame.

    Args:
        known: the memory.
        sources: anchors and targets.
        surveyed: where the mission file says each target is: (3,), m, and its sd (m).
        settings: the parameters.
    """
    variances = known.covariance.diagonal().tolist()
    sd = math.sqrt(max(variances[:D_VELOCITY]))
    angle_sd = math.sqrt(max(variances[D_ANGLE : D_ANGLE + 3]))
    return NavState(
        position=known.centre[:3],
        velocity=known.centre[3:],
        attitude=known.x[QUATERNION:RATE],
        rates=known.last[4:7],
        health=_health(known, sd, settings),
        targets=_targets(known, sd, angle_sd, sources, surveyed),
        covariance=known.covariance,
        correction=vec(0.0, 0.0, 0.0),
        late=known.late,
    )


def _health(known: FlyerMemory, sd: float, s: FlyerEkf) -> Health:
    began = math.isfinite(float(known.last[0]))
    cause = _cause(known, sd, s) if began else ""
    newest = max(known.ranges.at or -math.inf, known.frames.at or -math.inf)
    return Health(
        aligned=began,
        diverged=bool(cause),
        gnss_at=known.ranges.at,
        vision_at=known.frames.at,
        position_sd=sd,
        rejected=known.rejected,
        placed=known.now - newest <= s.unplaced_after,
        height_sd=sd,
        cause=cause,
        mahalanobis=mahalanobis.current(known.distance, known.now),
    )


def _cause(known: FlyerMemory, sd: float, s: FlyerEkf) -> str:
    """Say why the estimate must not be trusted; empty if it may be."""
    silence = known.now - float(known.last[0])
    if silence > s.silent_after:
        return f"no inertial samples for {silence:.1f} s"
    for what, it in (("ranges", known.ranges), ("camera frames", known.frames)):
        if it.diverged:
            return f"{it.refused:.0%} of the {what} are refused{it.why and ': '}{it.why}"
    return f"position is uncertain by {sd:.2f} m" if sd > s.max_position_sd else ""


def _targets(
    known: FlyerMemory,
    sd: float,
    angle_sd: float,
    sources: MeasurementRows,
    surveyed: Mapping[str, tuple[Vec3, float]],
) -> dict[str, Target]:
    """Return the targets: those with features where `navigation` has them, others as surveyed."""
    found = {
        name: Target(name, place.copy(), math.hypot(own, sd), None, None, None)
        for name, (place, own) in surveyed.items()
    }
    for name, pose in sources.targets.items():
        found[name] = Target(
            name, pose.translation.copy(), sd, pose.rotation, angle_sd, known.frames.at
        )
    return found
