from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink
from sitl_station import EXACT

from missionkit.sim.world import Cylinder
from missionkit.sitl.wire_faults import read_fault

Make = Callable[..., Any]
QUIET = True
GCS = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)


def trouble(vehicle: Any, text: str) -> None:
    found = read_fault(text, vehicle.state.dialect)
    vehicle.state.troubles.add(found._replace(start=vehicle.state.now))


def flying(vehicle: Any, seconds: float = 3.0) -> None:
    vehicle.take_off()
    vehicle.run(seconds, vehicle.velocity(2.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("action", "mode"),
    [
        (0, "POSCTL"),
        (1, "ALTCTL"),
        (2, "STABILIZED"),
        (3, "RTL"),
        (4, "LAND"),
        (5, "LOITER"),
    ],
)
def test_px4_takes_over_when_setpoints_stop(station: Make, action: int, mode: str) -> None:
    px4 = station("px4")
    px4.state.parameters.set("COM_OBL_RC_ACT", action)
    flying(px4)
    last = px4.state.target.at
    px4.until(lambda: px4.state.mode.name != "OFFBOARD", 2.0)
    assert px4.state.mode.name == mode
    assert px4.state.now - last == pytest.approx(1.0, abs=0.1)
    assert px4.last("STATUSTEXT").severity <= mavlink.MAV_SEVERITY_CRITICAL
    px4.run(2.5)
    assert px4.truth.velocity[0] < 0.2


@pytest.mark.parametrize(("action", "mode"), [(1, "LOITER"), (2, "RTL"), (3, "LAND")])
def test_px4_without_its_remote_control_holds_and_then_acts(
    station: Make, action: int, mode: str
) -> None:
    px4 = station("px4")
    px4.state.parameters.set("NAV_RCL_ACT", action)
    flying(px4)
    trouble(px4, "rc_lost")
    waited = px4.until(lambda: px4.state.mode.name != "OFFBOARD", 2.0)
    assert waited == pytest.approx(0.5, abs=0.05)
    assert px4.state.mode.name == "LOITER"
    px4.run(5.2)
    assert px4.state.mode.name == mode
    assert px4.state.failsafe == "RC lost"


@pytest.mark.parametrize(
    ("dialect", "parameter", "value"),
    [
        ("px4", "COM_RCL_EXCEPT", 4),
        ("px4", "NAV_RCL_ACT", 0),
        ("ardupilot", "FS_OPTIONS", 4),
        ("ardupilot", "FS_THR_ENABLE", 0),
    ],
)
def test_one_that_is_commanded_may_do_without_a_remote_control(
    station: Make, dialect: str, parameter: str, value: int
) -> None:
    vehicle = station(dialect)
    vehicle.state.parameters.set(parameter, value)
    flying(vehicle)
    trouble(vehicle, "rc_lost")
    vehicle.run(3.0, vehicle.velocity(2.0, 0.0, 0.0))
    assert vehicle.state.mode.does == "commanded"
    assert vehicle.truth.velocity[0] > 1.8


@pytest.mark.parametrize(("action", "mode"), [(1, "RTL"), (3, "LAND")])
def test_ardupilot_without_its_remote_control_acts(station: Make, action: int, mode: str) -> None:
    copter = station("ardupilot")
    copter.state.parameters.set("FS_THR_ENABLE", action)
    flying(copter)
    trouble(copter, "rc_lost")
    waited = copter.until(lambda: copter.state.mode.name != "GUIDED", 2.0)
    assert waited == pytest.approx(1.0, abs=0.05)
    assert copter.state.mode.name == mode


def test_px4_waits_as_long_as_its_parameter_says(station: Make) -> None:
    px4 = station("px4")
    px4.state.parameters.set("COM_OF_LOSS_T", 0.3)
    flying(px4)
    assert px4.until(lambda: px4.state.mode.name == "POSCTL", 1.0) < 0.45


def test_px4_follows_slow_setpoints(station: Make) -> None:
    px4 = station("px4")
    flying(px4)
    px4.run(4.0, px4.velocity(2.0, 0.0, 0.0), every=0.8)
    assert px4.state.mode.name == "OFFBOARD"
    assert px4.truth.velocity[0] == pytest.approx(2.0, abs=0.15)


def test_ardupilot_stops_and_stays_guided_when_setpoints_stop(station: Make) -> None:
    copter = station("ardupilot")
    flying(copter)
    copter.run(2.7)
    assert copter.truth.velocity[0] == pytest.approx(2.0, abs=0.15)
    copter.run(2.5)
    assert copter.speed < 0.2
    assert copter.state.mode.name == "GUIDED"


def test_ardupilot_flies_on_to_its_last_position_setpoint(station: Make) -> None:
    copter = station("ardupilot")
    copter.take_off()
    copter.send(
        mavlink.MAVLink_set_position_target_local_ned_message(
            0, 1, 1, 1, 0xDF8, 40.0, 0, -5, 0, 0, 0, 0, 0, 0, 0, 0
        )
    )
    copter.run(15.0)
    assert copter.truth.position[0] == pytest.approx(40.0, abs=0.5)


@pytest.mark.parametrize(("action", "mode"), [(1, "LOITER"), (2, "RTL"), (3, "LAND")])
def test_px4_waits_then_acts_when_the_ground_station_is_lost(
    station: Make, action: int, mode: str
) -> None:
    px4 = station("px4")
    px4.state.parameters.set("NAV_DLL_ACT", action)
    px4.run(0.1)
    px4.send(GCS)
    flying(px4, 1.0)
    px4.send(GCS)
    px4.run(9.0, px4.velocity(0, 0, 0))
    assert px4.state.mode.name == "OFFBOARD"
    px4.run(1.2, px4.velocity(0, 0, 0))
    assert px4.state.mode.name == "LOITER"
    px4.run(5.2)
    assert px4.state.mode.name == mode
    assert px4.last("HEARTBEAT").system_status == mavlink.MAV_STATE_CRITICAL


@pytest.mark.parametrize(("action", "mode"), [(0, "GUIDED"), (1, "RTL"), (5, "LAND"), (7, "BRAKE")])
def test_ardupilot_acts_when_its_ground_station_is_lost(
    station: Make, action: int, mode: str
) -> None:
    copter = station("ardupilot", who=(255, 190))
    flying(copter, 1.0)
    copter.send(GCS)
    copter.state.parameters.set("FS_GCS_ENABLE", action)
    copter.run(4.8, copter.velocity(0, 0, 0))
    assert copter.state.mode.name == "GUIDED"
    copter.run(0.5, copter.velocity(0, 0, 0))
    assert copter.state.mode.name == mode


def test_a_pilot_flies_on_without_the_ground_station(station: Make) -> None:
    copter = station("ardupilot", who=(255, 190))
    flying(copter, 1.0)
    copter.state.parameters.set("FS_GCS_ENABLE", 1)
    copter.send(GCS)
    assert copter.mode("LOITER") == 0
    copter.run(6.0)
    assert copter.state.mode.name == "LOITER"


def test_guided_begins_standing_still(station: Make) -> None:
    copter = station("ardupilot")
    flying(copter)
    assert copter.mode("LOITER") == 0
    assert copter.mode("GUIDED") == 0
    copter.run(2.5)
    assert copter.speed < 0.2


def test_px4_holds_returns_and_lands_as_the_battery_drains(station: Make) -> None:
    px4 = station("px4")
    flying(px4)
    trouble(px4, "battery_sag=0.91")
    px4.run(0.5, px4.velocity(0, 0, 0))
    assert px4.state.mode.name == "LOITER"
    px4.run(5.2)
    assert px4.state.mode.name == "RTL"
    px4.state.troubles.clear()
    trouble(px4, "battery_sag=0.95")
    px4.run(0.5)
    assert px4.state.mode.name == "LAND"


def test_ardupilot_acts_at_its_configured_charge(station: Make) -> None:
    copter = station("ardupilot")
    copter.state.parameters.set("BATT_LOW_MAH", 600)
    copter.state.parameters.set("BATT_FS_LOW_ACT", 2)
    flying(copter)
    trouble(copter, "battery_sag=0.7")
    copter.run(1.5, copter.velocity(0, 0, 0))
    assert copter.state.mode.name == "RTL"


@pytest.mark.parametrize("monitor", [0, 3])
def test_ardupilot_does_not_act_at_a_charge_that_is_not_measured(
    station: Make, monitor: int
) -> None:
    copter = station("ardupilot")
    for name, value in (("MONITOR", monitor), ("LOW_MAH", 600), ("FS_LOW_ACT", 2)):
        copter.state.parameters.set(f"BATT_{name}", value)
    flying(copter)
    trouble(copter, "battery_sag=0.7")
    copter.run(1.5, copter.velocity(0, 0, 0))
    assert copter.state.mode.name == "GUIDED"


def test_without_fixes_it_lands_where_it_is(either: Any) -> None:
    flying(either, 1.0)
    trouble(either, "gnss_lost")
    patience = 5.0 if either.px4 else 10.0
    either.run(patience - 0.2, either.velocity(0, 0, 0))
    assert either.state.mode.name in {"OFFBOARD", "GUIDED"}
    either.run(0.5, either.velocity(0, 0, 0))
    assert either.state.mode.name == "LAND"
    either.until(lambda: not either.state.armed, 20)


@pytest.mark.parametrize("fault", ["arming_denied", "gnss_lost", "battery_sag=0.9"])
def test_arming_is_denied_with_a_reason(either: Any, fault: str) -> None:
    either.run(1.6)
    trouble(either, fault)
    either.run(0.1)
    assert either.mode("LOITER" if either.px4 else "GUIDED") in {0, 4}
    assert either.command(400, 1) == (1 if either.px4 else 4)
    assert not either.state.armed
    assert "Arm" in either.said[-1]


def test_px4_with_a_data_link_action_arms_only_with_a_ground_station(station: Make) -> None:
    px4 = station("px4")
    px4.state.parameters.set("NAV_DLL_ACT", 2)
    px4.run(1.6)
    assert px4.command(400, 1) == mavlink.MAV_RESULT_TEMPORARILY_REJECTED
    assert "ground control station" in "".join(px4.said)
    px4.send(GCS)
    assert px4.command(400, 1) == 0


def test_a_crash_is_reported_and_disarms(station: Make) -> None:
    pole = Cylinder(use="cylinder", at=(8.0, 0.0), radius=1.0, height=9.0)
    px4 = station("px4", world=EXACT.model_copy(update={"obstacles": (pole,)}))
    flying(px4, 4.0)
    assert px4.truth.crashed
    px4.run(5.0, px4.velocity(2.0, 0.0, 0.0))
    assert not px4.state.armed
    assert "Crash" in px4.said[-1]


@pytest.mark.parametrize("action", [0, 1, 2])
@pytest.mark.parametrize("without", ["rc_lost", "COM_RC_IN_MODE"])
def test_px4_without_a_remote_control_returns_instead_of_waiting_for_a_pilot(
    station: Make, action: int, without: str
) -> None:
    px4 = station("px4")
    px4.state.parameters.set("COM_OBL_RC_ACT", action)
    if without == "rc_lost":
        px4.state.parameters.set("COM_RCL_EXCEPT", 4)  # offboard continues
        px4.state.parameters.set("COM_OF_LOSS_T", 2.0)
    else:
        px4.state.parameters.set("COM_RC_IN_MODE", 4)
    flying(px4)
    if without == "rc_lost":
        trouble(px4, "rc_lost")
    px4.until(lambda: px4.state.mode.name != "OFFBOARD", 3.0)
    assert px4.state.mode.name == "RTL"
