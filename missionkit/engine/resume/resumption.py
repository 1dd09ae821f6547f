"""Going on with a flight whose process died: listen first, command later."""

from __future__ import annotations

from typing import NamedTuple

from missionkit.engine.clock import Pace
from missionkit.engine.flight_state import FlightMemory, FlightState
from missionkit.engine.prepared_mission import PreparedMission
from missionkit.engine.resume.reconciliation import ResumedFlight, reconciled
from missionkit.engine.sense import sense
from missionkit.plugin_containment import Containment
from missionkit.ports import Vehicle

HEARTBEAT_WAIT = 2.0  # s to wait for a heartbeat
SETTLING_TIMEOUT = 10.0  # s to wait, in the air, until the estimate is sound again
FIX_TAKEN_WITHIN = 2.0  # s before the end in which a fix was taken
SOUND_AFTER = 1.0  # s without a refused measurement: it is


class Resumption(NamedTuple):
    """State from which a flight resumes, and when."""

    course: FlightState  # as it was saved
    now: float  # s, mission time, which advanced during the gap
    changed: bool = False  # the mission is not the one that was flown
    notes: tuple[str, ...] = ()  # further messages


async def resume_flight(
    plan: PreparedMission, vehicle: Vehicle, pace: Pace, since: Resumption
) -> ResumedFlight:
    """Listen until the vehicle has reported its state, then adapt the memory to it.

    The filter uses the new data; the chart and its guards do not change. In the air it is given
    time to get over the hole in its data, while the autopilot holds.

    Args:
        plan: what flies.
        vehicle: connected, in any state.
        pace: of the ticks meanwhile.
        since: the saved flight.

    Raises:
        VehicleError: the vehicle is to be left alone; nothing was commanded.
    """
    saved, heard = since.course, since.course.memory
    count, calm = round(since.now / plan.period), 0.0
    while not _enough(saved.memory, heard, waited=heard.now - since.now, calm=calm):
        count += 1
        now = count * plan.period
        await pace.until(now)
        senses, _ = sense(plan, heard, await vehicle.observe(now), Containment())
        heard = heard._replace(now=now, senses=senses)
        calm = calm + plan.period if _sound(plan, saved.memory, heard) else 0.0
    resumed = reconciled(plan, saved, heard, changed=since.changed)
    return resumed._replace(notes=resumed.notes + since.notes)


def _enough(before: FlightMemory, heard: FlightMemory, *, waited: float, calm: float) -> bool:
    status = heard.senses.status
    if status is None or status.at <= before.now:
        return waited >= HEARTBEAT_WAIT
    return not status.in_air or calm >= SOUND_AFTER or waited >= SETTLING_TIMEOUT


def _sound(plan: PreparedMission, before: FlightMemory, heard: FlightMemory) -> bool:
    """Say whether the filter accepts its measurements, fixes among them; not needed until aligned.

    A flight without recent fixes does not need any.
    """
    health = plan.navigator.read(heard.senses.navigation).health
    last = plan.navigator.read(before.senses.navigation).health.gnss_at
    without = last is None or before.now - last > FIX_TAKEN_WITHIN
    fixed = without or (health.gnss_at is not None and health.gnss_at > before.now)
    return not health.aligned or (fixed and not health.diverged and not health.rejected)
