"""How the measurements fared, and what that says about the estimate."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from missionkit.estimation import layout
from missionkit.estimation.consistency import Scatter, averaged, misfit
from missionkit.estimation.history import Outcome
from missionkit.estimation.layout import FIX, FIX_VELOCITY, SIGHT
from missionkit.geometry import Mat, Vec3
from missionkit.messages import Health

if TYPE_CHECKING:
    from missionkit.estimation.visual_inertial import VisualInertialEkf

MEMORY = 50
"""How many refused fixes in a row are remembered."""
PLACED_FOR = 3.0
"""For how long after a fix or a sighting (s) it is known where the vehicle is."""
STRAY = [layout.AT, *range(layout.Z, layout.NOISE), *range(layout.RESIDUAL, layout.LOG_WIDTH)]
"""What is remembered of them."""
AGREEING = 10
"""How many refused fixes in a row have to agree before anything is made of them."""


class Tally(NamedTuple):
    """Counts by kind of measurement (`layout`); a value, never changed."""

    accepted_at: tuple[float, ...]  # s, of the last accepted, -inf if none
    refused_since: tuple[float, ...]  # s, first of the refused in a row, inf if none
    refused: tuple[int, ...]  # in a row
    strays: Mat  # (n, 7), s and m, NED: time, place and innovation of the fixes refused in a row
    late: int  # measurements that arrived too late, in all
    resets: int = 0  # of the position, in all
    scatter: Scatter = Scatter()  # of sightings


def begin() -> Tally:
    """Return the counts before the first measurement."""
    n = layout.KINDS
    return Tally((-math.inf,) * n, (math.inf,) * n, (0,) * n, np.empty((0, len(STRAY))), 0)


def stood(tally: Tally, fixes: Mat) -> Tally:
    """Return the counts after an alignment that took fixes (n, 7), time first, for its place."""
    if not len(fixes):
        return tally
    accepted = list(tally.accepted_at)
    accepted[FIX] = float(fixes[-1, 0])
    return tally._replace(accepted_at=tuple(accepted))


def counted(tally: Tally, out: Outcome, bad: list[Vec3], now: float) -> Tally:
    """Return the counts after the filter decided on some rows; `bad` ones never reached it."""
    if not (len(out.decided) or out.late or bad):
        return tally
    accepted, since = list(tally.accepted_at), list(tally.refused_since)
    refused, strays, scatter = list(tally.refused), tally.strays, tally.scatter
    for r in out.decided:
        kind, at = int(r[layout.KIND]), float(r[layout.AT])
        if r[layout.OUTCOME] == layout.ACCEPTED:
            accepted[kind], since[kind], refused[kind] = max(accepted[kind], at), math.inf, 0
        else:
            since[kind] = min(since[kind], at)
            refused[kind] += 1
        if kind == FIX:
            strays = _strayed(strays, r)
        elif kind == SIGHT:
            scatter = averaged(scatter, float(r[layout.NIS]))
    for r in bad:
        kind = int(r[layout.KIND])
        since[kind] = min(since[kind], now)
        refused[kind] += 1
    late = tally.late + out.late
    counts = tuple(accepted), tuple(since), tuple(refused)
    return Tally(*counts, strays, late, tally.resets, scatter)


def _strayed(strays: Mat, fix: Vec3) -> Mat:
    if fix[layout.OUTCOME] == layout.ACCEPTED:
        return strays[:0]
    if not math.isfinite(fix[layout.NIS]):
        return strays
    return np.concatenate((strays[1 - MEMORY :], fix[None, STRAY]))


def refused_for(tally: Tally, kinds: tuple[int, ...], now: float) -> float:
    """Return how long (s) one of `kinds` has been refused while none of them was accepted."""
    started = min(tally.refused_since[k] for k in kinds)
    return now - max(started, *(tally.accepted_at[k] for k in kinds))


def horizontal_sd(P: Mat, shared: float) -> float:
    """Return the standard deviation (m) of the horizontal position along its worst direction.

    `shared` (m) is the error that all fixes have in common, which the filter cannot see.
    """
    (north, both), (_, east) = P[:2, :2].tolist()
    mean, half = 0.5 * (north + east), 0.5 * (north - east)
    return math.sqrt(max(mean + math.hypot(half, both), 0.0) + shared**2)


def divergence(tally: Tally, sd: float, silence: float, now: float, s: VisualInertialEkf) -> str:
    """Return why the estimate must not be flown on, "" if it may be.

    Args:
        tally: the counts.
        sd: horizontal position (m).
        silence: since the last inertial sample (s).
        now: the time (s).
        s: the limits.
    """
    if silence > s.silent_after:
        return f"no inertial samples for {silence:.1f} s"
    if sd > s.max_position_sd:
        return f"the position is known to {sd:.0f} m only"
    if not any(tally.refused):
        return ""
    astray = refused_for(tally, (FIX, SIGHT), now)
    if astray > s.reset_after and (jump := lasting_jump(tally)) is not None:
        return f"GNSS jumped {jump:.0f} m"
    if refused_for(tally, (FIX, FIX_VELOCITY, SIGHT), now) > s.blind_after:
        return "every fix and sighting was refused"
    return "every position was refused" if astray > s.stray_after else ""


def lasting_jump(tally: Tally) -> float | None:
    """Return by how much (m) the fixes refused last lie beside the filter's flight, all alike.

    None if they do not agree, or if their velocity was refused as well: then it may be the filter.
    """
    missed = tally.strays[-AGREEING:, 4:]
    if len(missed) < AGREEING or tally.refused[FIX_VELOCITY]:
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


def placed(tally: Tally, now: float, s: VisualInertialEkf) -> bool:
    """Say whether something tells where the vehicle is: it could take off."""
    latest = max(tally.accepted_at[FIX], tally.accepted_at[SIGHT])
    return s.flow or now - latest <= PLACED_FOR


def health(tally: Tally, sd: float, height_sd: float, *, cause: str, placed: bool) -> Health:
    """Return the health of an aligned filter: sds (m), horizontal and of the height.

    `cause` says why it has diverged, "" if it has not.
    """
    return Health(
        aligned=True,
        diverged=bool(cause),
        gnss_at=_known(tally.accepted_at[FIX]),
        vision_at=_known(tally.accepted_at[SIGHT]),
        position_sd=sd,
        rejected=max(tally.refused),
        placed=placed,
        height_sd=height_sd,
        resets=tally.resets,
        misfit=misfit(tally.scatter),
        cause=cause,
    )


def _known(at: float) -> float | None:
    return at if math.isfinite(at) else None
