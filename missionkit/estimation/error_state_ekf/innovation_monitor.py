"""How the measurements fared, and what that says about the estimate."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from missionkit.estimation import mahalanobis
from missionkit.estimation.error_state_ekf import state_layout
from missionkit.estimation.error_state_ekf.consistency import NisAverage, averaged, misfit
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.estimation.error_state_ekf.replay_buffer import ReplayResult
from missionkit.estimation.error_state_ekf.state_layout import (
    EXTERNAL,
    FIX,
    FIX_VELOCITY,
    FLOW,
    RANGE,
    SIGHT,
)
from missionkit.estimation.mahalanobis import MeanDistance
from missionkit.geometry import Mat, Vec3
from missionkit.messages import Health

MEMORY = 50
"""How many refused fixes in a row are remembered."""
PLACED_FOR = 3.0
"""For how long after a fix or a sighting (s) it is known where the vehicle is."""
STRAY = [
    state_layout.AT,
    *range(state_layout.Z, state_layout.NOISE),
    *range(state_layout.RESIDUAL, state_layout.LOG_WIDTH),
]
"""Columns of the log that are kept of refused fixes."""
AGREEING = 10
"""How many refused fixes in a row have to agree before anything is made of them."""


PLACING = (FIX, SIGHT, EXTERNAL)
"""Measurements that say where the vehicle is."""
POSITIONING = {FIX: 3, FIX_VELOCITY: 3, SIGHT: 3, FLOW: 2, RANGE: 1, EXTERNAL: 3}
"""Components of the measurements that say where the vehicle is, or how fast over ground."""


class InnovationMonitor(NamedTuple):
    """Counts by kind of measurement (`state_layout`); a value, never changed."""

    accepted_at: tuple[float, ...]  # s, of the last accepted, -inf if none
    refused_since: tuple[float, ...]  # s, first of the refused in a row, inf if none
    refused: tuple[int, ...]  # in a row
    strays: Mat  # (n, 7), s and m, NED: time, place and innovation of the fixes refused in a row
    late: int  # measurements that arrived too late, in all
    resets: int = 0  # of the position, in all
    scatter: NisAverage = NisAverage()  # of sightings
    distance: MeanDistance = MeanDistance()  # of all that say where the vehicle is


def begin() -> InnovationMonitor:
    """Return the counts before the first measurement."""
    n = state_layout.KINDS
    return InnovationMonitor(
        (-math.inf,) * n, (math.inf,) * n, (0,) * n, np.empty((0, len(STRAY))), 0
    )


def stood(monitor: InnovationMonitor, fixes: Mat) -> InnovationMonitor:
    """Return the counts after an alignment that took fixes (n, 7), time first, for its place."""
    if not len(fixes):
        return monitor
    accepted = list(monitor.accepted_at)
    accepted[FIX] = float(fixes[-1, 0])
    return monitor._replace(accepted_at=tuple(accepted))


def counted(
    monitor: InnovationMonitor, out: ReplayResult, bad: list[Vec3], now: float
) -> InnovationMonitor:
    """Return the counts after the filter decided on some rows; `bad` ones never reached it.

    Args:
        monitor: counts so far.
        out: rows that the filter accepted or refused.
        bad: log rows that were not finite.
        now: s.
    """
    if not (len(out.decided) or out.late or bad):
        return monitor
    accepted, since = list(monitor.accepted_at), list(monitor.refused_since)
    refused, strays, scatter = list(monitor.refused), monitor.strays, monitor.scatter
    distances: list[float] = []
    for r in out.decided:
        kind, at = int(r[state_layout.KIND]), float(r[state_layout.AT])
        if r[state_layout.OUTCOME] == state_layout.ACCEPTED:
            accepted[kind], since[kind], refused[kind] = max(accepted[kind], at), math.inf, 0
        else:
            since[kind] = min(since[kind], at)
            refused[kind] += 1
        if kind in POSITIONING:
            nis = float(r[state_layout.NIS])
            distances.append(mahalanobis.distance(nis, POSITIONING[kind]))
        if kind == FIX:
            strays = _strayed(strays, r)
        elif kind == SIGHT:
            scatter = averaged(scatter, float(r[state_layout.NIS]))
    for r in bad:
        kind = int(r[state_layout.KIND])
        since[kind] = min(since[kind], now)
        refused[kind] += 1
    late = monitor.late + out.late
    counts = tuple(accepted), tuple(since), tuple(refused)
    distance = mahalanobis.averaged(monitor.distance, distances, now)
    return InnovationMonitor(*counts, strays, late, monitor.resets, scatter, distance)


def _strayed(strays: Mat, fix: Vec3) -> Mat:
    if fix[state_layout.OUTCOME] == state_layout.ACCEPTED:
        return strays[:0]
    if not math.isfinite(fix[state_layout.NIS]):
        return strays
    return np.concatenate((strays[1 - MEMORY :], fix[None, STRAY]))


def refused_for(monitor: InnovationMonitor, kinds: tuple[int, ...], now: float) -> float:
    """Return how long (s) one of `kinds` has been refused while none of them was accepted.

    Args:
        monitor: counts of the filter.
        kinds: measurement kinds, as in the log.
        now: s.
    """
    started = min(monitor.refused_since[k] for k in kinds)
    return now - max(started, *(monitor.accepted_at[k] for k in kinds))


def horizontal_sd(P: Mat, shared: float) -> float:
    """Return the standard deviation (m) of the horizontal position along its worst direction.

    `shared` (m) is the error that all fixes have in common, which the filter cannot see.
    """
    (north, both), (_, east) = P[:2, :2].tolist()
    mean, half = 0.5 * (north + east), 0.5 * (north - east)
    return math.sqrt(max(mean + math.hypot(half, both), 0.0) + shared**2)


def divergence(
    monitor: InnovationMonitor, sd: float, silence: float, now: float, s: VisualInertialEkf
) -> str:
    """Return why the estimate must not be flown on, "" if it may be.

    Args:
        monitor: the counts.
        sd: horizontal position (m).
        silence: since the last inertial sample (s).
        now: the time (s).
        s: the limits.
    """
    if silence > s.silent_after:
        return f"no inertial samples for {silence:.1f} s"
    if sd > s.max_position_sd:
        return f"the position is only known to {sd:.0f} m"
    if not any(monitor.refused):
        return ""
    astray = refused_for(monitor, PLACING, now)
    if astray > s.reset_after and (jump := lasting_jump(monitor)) is not None:
        return f"GNSS jumped {jump:.0f} m"
    if refused_for(monitor, (*PLACING, FIX_VELOCITY), now) > s.blind_after:
        return "every fix, sighting and external pose was rejected"
    return "every position was rejected" if astray > s.stray_after else ""


def lasting_jump(monitor: InnovationMonitor) -> float | None:
    """Return by how much (m) the fixes refused last lie beside the filter's flight, all alike.

    None if they do not agree, or if their velocity was refused as well: then it may be the filter.
    """
    missed = monitor.strays[-AGREEING:, 4:]
    if len(missed) < AGREEING or monitor.refused[FIX_VELOCITY]:
        return None
    mean = missed.mean(axis=0)
    jump = math.sqrt(float(mean @ mean))
    scatter = math.sqrt(float(np.square(missed - mean).sum(axis=1).mean()))
    return jump if scatter <= jump / 3.0 else None


def unaligned(settings: VisualInertialEkf) -> Health:
    """Return the health before the alignment has succeeded."""
    return Health(
        aligned=False,
        diverged=False,
        gnss_at=None,
        vision_at=None,
        position_sd=settings.origin_sd,
        rejected=0,
        placed=False,
    )


def placed(monitor: InnovationMonitor, now: float, s: VisualInertialEkf) -> bool:
    """Say whether something tells where the vehicle is: it could take off.

    Args:
        monitor: counts of the filter.
        now: s.
        s: settings of the filter.
    """
    latest = max(monitor.accepted_at[kind] for kind in PLACING)
    return s.flow or now - latest <= PLACED_FOR


def health(
    monitor: InnovationMonitor,
    sd: float,
    height_sd: float,
    now: float,
    *,
    cause: str,
    placed: bool,
) -> Health:
    """Return the health of an aligned filter.

    Args:
        monitor: the counts.
        sd: of the horizontal position (m).
        height_sd: of the height (m).
        now: the time (s).
        cause: why it has diverged, "" if it has not.
        placed: the position has a source.
    """
    return Health(
        aligned=True,
        diverged=bool(cause),
        gnss_at=_known(monitor.accepted_at[FIX]),
        vision_at=_known(monitor.accepted_at[SIGHT]),
        position_sd=sd,
        rejected=max(monitor.refused),
        placed=placed,
        height_sd=height_sd,
        resets=monitor.resets,
        misfit=misfit(monitor.scatter),
        cause=cause,
        mahalanobis=mahalanobis.current(monitor.distance, now),
    )


def _known(at: float) -> float | None:
    return at if math.isfinite(at) else None
