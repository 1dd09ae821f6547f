"""What a vehicle reports of itself to the others of its fleet."""

from __future__ import annotations

from missionkit.messages import Estimate, TrafficReport

FRESH_STATUS = 1.0  # s since the vehicle was last heard: then nothing is known of it


def own_report(seen: Estimate) -> TrafficReport | None:
    """Return where a vehicle is; None if it does not know: the others then hear nothing.

    Args:
        seen: its estimate.
    """
    health, status = seen.health, seen.status
    known = health.aligned and health.placed and not health.diverged
    if not known or status is None or seen.now - status.at > FRESH_STATUS:
        return None
    return TrafficReport(seen.now, seen.position, seen.velocity, status.in_air)
