"""Whose takeover it was, and what a heartbeat alone tells; without a wire."""

import pytest

from missionkit.vehicle.autopilot_dialect import PX4
from missionkit.vehicle.command.control_authority import ControlAuthority
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.telemetry.autopilot_state import AutopilotState

ACTIVE, CRITICAL = 4, 5  # MAV_STATE
POSITION, OFFBOARD = 3 << 16, 6 << 16
HOLD, RETURN, LAND = (sub << 24 | 4 << 16 for sub in (3, 5, 6))
IN_AIR = 2  # MAV_LANDED_STATE


def beat(mode, status=ACTIVE, armed=True):
    return {"custom_mode": mode, "base_mode": 0x80 if armed else 1, "system_status": status}


@pytest.mark.parametrize(
    ("mode", "status", "unheard", "event"),
    [
        (POSITION, ACTIVE, False, "pilot_takeover"),
        (POSITION, CRITICAL, False, "pilot_takeover"),
        (LAND, ACTIVE, False, "pilot_takeover"),
        (HOLD, CRITICAL, False, "failsafe_takeover"),
        (RETURN, CRITICAL, False, "failsafe_takeover"),
        (LAND, CRITICAL, False, "failsafe_takeover"),
        (POSITION, ACTIVE, True, "failsafe_takeover"),
    ],
)
def test_a_mode_of_a_critical_autopilot_is_its_own_unless_only_a_pilot_flies_it(
    mode, status, unheard, event
):
    events, cache = [], Cache(lambda: 0.0)
    authority = ControlAuthority(
        PX4, lambda: events.append("let go"), events.append, lambda: unheard
    )
    cache.listen(authority.hear)
    authority.order("offboard")
    cache.put("HEARTBEAT", beat(OFFBOARD))
    cache.put("HEARTBEAT", beat(mode, status))
    assert events == ["let go", event]


@pytest.mark.parametrize(("armed", "flies"), [(True, True), (False, False)])
def test_a_disarmed_vehicle_is_not_flying_whatever_it_last_reported(armed, flies):
    cache = Cache(lambda: 0.0)
    cache.put("EXTENDED_SYS_STATE", {"landed_state": IN_AIR})
    cache.put("HEARTBEAT", beat(LAND, armed=armed))
    assert AutopilotState(cache, PX4).in_air is flies


@pytest.mark.parametrize(("status", "flies"), [(3, False), (ACTIVE, True), (CRITICAL, True)])
def test_under_power_counts_as_flying_without_a_landed_state(status, flies):
    cache = Cache(lambda: 0.0)
    cache.put("HEARTBEAT", beat(LAND, status))
    assert AutopilotState(cache, PX4).in_air is flies
