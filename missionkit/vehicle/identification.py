"""Which vehicle answers on a link, and whether missionkit flies its kind."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from typing import Any

from missionkit.errors import VehicleError
from missionkit.vehicle.link.connection import Link, listed
from missionkit.vehicle.link.link_address import Address
from missionkit.vehicle.link.message_cache import Cache, Message
from missionkit.vehicle.link.vehicle_type import unfit


async def identified(
    link: Link,
    cache: Cache,
    address: Address,
    system: int | None,
    within: float,
    call: Callable[..., Awaitable[Any]],
) -> Message | None:
    """Return a heartbeat of a vehicle that missionkit flies, None if it is silent.

    Args:
        link: to the autopilot.
        cache: where its messages are.
        address: of the link.
        system: MAVLink system id that was asked for; None: the only one there.
        within: s, wall, to wait for a second heartbeat.
        call: runs a blocking function beside the event loop.

    Raises:
        VehicleError: it flies no such vehicle, or there are several and none was named.
    """
    systems = await link.systems()
    if system is None and len(systems) > 1:
        raise VehicleError(
            f"{address.url}: several vehicles share this link: {listed(systems)}; "
            f"name yours, such as --system {min(systems)}"
        )
    beat = cache.latest("HEARTBEAT")
    if beat is not None and unfit(beat.fields):  # one packet alone is not trusted
        await call(cache.wait, lambda: cache.latest("HEARTBEAT") is not beat, within)
        beat = cache.latest("HEARTBEAT")
    if beat is not None and (why := unfit(beat.fields)):
        raise VehicleError(f"{address.url}: system {link.system_id} is not flown: {why}")
    return beat
