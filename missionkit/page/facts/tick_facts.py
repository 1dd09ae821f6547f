"""What the page shows of one tick."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from missionkit.engine import pause
from missionkit.messages import TRACKED, BoxDetection, Fired, Observation, Record, Target
from missionkit.page.facts.chart_ids import FiredIds
from missionkit.page.facts.guard_facts import guard_rows
from missionkit.page.facts.plain_values import number, points, vector
from missionkit.page.facts.requirement_facts import requirement_rows

POINTS_SHOWN = 200
PAUSES = (pause.BY_OPERATOR, pause.BY_PILOT)


class Followed(NamedTuple):
    """What is remembered from tick to tick."""

    number: int  # of the tick
    reason: str  # of the last transition
    guards_since: Mapping[str, float]  # s
    guards_need: Mapping[tuple[str | None, str], float]  # s
    battery: Mapping[str, object] | None


def tick_facts(record: Record, seen: Observation, known: Followed) -> dict[str, object]:
    """Return what a tick shows, but for what depends on the kind of page.

    Args:
        record: of the tick.
        seen: its observation.
        known: from the ticks before, and this one.
    """
    est, now = record.estimate, record.now
    setpoint = None if est.goal is None else vector(est.goal.position)
    return {
        "tick": known.number,
        "now": now,
        "state": record.state,
        "active": list(record.active),
        "reason": known.reason,
        "entered_at": est.entered_at,
        "note": record.step_note,
        "mode": record.mode.value,
        "vehicle_mode": None if est.status is None else est.status.mode,
        "armed": None if est.status is None else bool(est.status.armed),
        "in_air": None if est.status is None else bool(est.status.in_air),
        "in_control": bool(seen.in_control),
        "pilot_flies": not seen.in_control,
        "paused": record.step_note if record.step_note in PAUSES else "",
        "position": vector(est.position),
        "velocity": vector(est.velocity),
        "yaw": number(est.yaw),
        "position_sd": number(est.health.position_sd),
        "diverged": bool(est.health.diverged),
        "goal": setpoint,
        "home": vector(est.home),
        "targets": [_target(it, now) for name, it in est.targets.items() if name != TRACKED],
        "obstacles": _obstacles(record),
        "battery": known.battery,
        "link_age": None if est.status is None else round(max(0.0, now - est.status.at), 3),
        "cycle_ms": round(1000.0 * (record.cycle.total or seen.cycle.total), 3),
        "guards": guard_rows(record, known.guards_since, known.guards_need),
        "requirements": requirement_rows(record),
        "detections": _detections(record, seen),
    }


def fired_facts(fired: Fired, now: float, tick: int, ids: FiredIds) -> dict[str, object]:
    """Return a transition that was taken.

    Args:
        fired: the transition.
        now: s.
        tick: number of the tick.
        ids: of the chart.
    """
    return {
        "at": now,
        "tick": tick,
        "id": ids.of(fired),
        "source": fired.source,
        "to": fired.to,
        "reason": fired.reason,
    }


def _target(it: Target, now: float) -> dict[str, object]:
    return {
        "name": it.name,
        "at": vector(it.position),
        "sd": number(it.position_sd),
        "seen_ago": None if it.seen_at is None else round(now - it.seen_at, 3),
    }


def _obstacles(record: Record) -> list[list[float]]:
    found = record.estimate.obstacles
    if found is None or not len(found):
        return []
    return points(found[:: 1 + (len(found) - 1) // POINTS_SHOWN, :2].round(2).tolist())


def _detections(record: Record, seen: Observation) -> list[dict[str, object]]:
    markers: list[dict[str, object]] = [
        {
            "name": f"{it.target} ({it.id})",
            "corners": points(it.detection.corners.round(1).tolist()),
            "box": None,
            "score": 1.0,
        }
        for it in record.estimate.sightings
    ]
    boxes = () if seen.frame is None else seen.frame.boxes or ()
    return markers + [_box(it) for it in boxes]


def _box(it: BoxDetection) -> dict[str, object]:
    x, y = (float(part) for part in it.centre)
    wide, high = it.size
    return {
        "name": it.kind or it.detector,
        "corners": None,
        "box": [x - wide / 2, y - high / 2, wide, high],
        "score": number(it.score),
    }
