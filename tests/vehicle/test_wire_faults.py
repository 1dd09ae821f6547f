"""The pilot, the link and the autopilot itself misbehave; judged by what the autopilot did."""

import numpy as np
import pytest
from vehicle.flying import over_the_wire
from vehicle.ticked_flight import CLIMB, LAND, NORTH

STREAMS = "511 "  # MAV_CMD_SET_MESSAGE_INTERVAL commands nothing


@pytest.mark.parametrize(("dialect", "mode"), [("px4", "POSCTL"), ("ardupilot", "LOITER")])
def test_the_pilot_wins_within_a_heartbeat_until_giving_control_back(dialect, mode, tmp_path):
    async def script(flight, autopilot):
        await flight.cruise(autopilot)
        since = autopilot.now
        autopilot.ask(fault=f"pilot_mode={mode}")
        await flight.until(lambda: not flight.vehicle.in_control, NORTH, limit=1.3)
        taken = autopilot.now
        await flight.run(3.0, NORTH)
        assert "pilot_takeover" in flight.events
        assert autopilot.notes("setpoint", taken + 0.1) == []
        assert [note["which"] for note in autopilot.notes("mode", since)] == [mode]
        autopilot.ask(clear=True)
        flight.vehicle.resume_control()
        await flight.until(lambda: flight.status.mode == "offboard", NORTH)

    over_the_wire(tmp_path, script, dialect)


@pytest.mark.parametrize(
    ("dialect", "low", "mode"),
    [
        ("px4", {"NAV_RCL_ACT": 3}, "LAND"),
        ("ardupilot", {"RTL_ALT": 400, "RTL_LOIT_TIME": 0}, "RTL"),
    ],
)
def test_without_a_remote_control_the_autopilots_failsafe_has_its_way(dialect, low, mode, tmp_path):
    async def script(flight, autopilot):
        for name, value in low.items():
            autopilot.ask(parameter=name, value=value)
        await flight.cruise(autopilot)
        autopilot.ask(fault="rc_lost")
        await flight.until(lambda: "failsafe_takeover" in flight.events, NORTH)
        since = autopilot.now
        await flight.until(lambda: not flight.status.armed, NORTH, 120.0)
        assert "pilot_takeover" not in flight.events
        assert autopilot.notes("setpoint", since + 1.5) == []
        assert autopilot.notes("mode")[-1]["which"] == mode
        assert autopilot.truth["on_ground"]
        assert not autopilot.truth["crashed"]

    over_the_wire(tmp_path, script, dialect)


def test_a_landing_is_not_forced_on_a_pilot(tmp_path):
    async def script(flight, autopilot):
        await flight.cruise(autopilot)
        autopilot.ask(fault="pilot_mode=POSCTL")
        await flight.until(lambda: not flight.vehicle.in_control, NORTH, limit=1.3)
        since = autopilot.now
        await flight.run(2.0, LAND)
        notes = autopilot.notes("command", since + 0.1)
        assert [note for note in notes if not note["which"].startswith(STREAMS)] == []

    over_the_wire(tmp_path, script)


def test_a_long_link_loss_ends_in_the_failsafe_and_is_reported(tmp_path):
    async def script(flight, autopilot):
        await flight.cruise(autopilot)
        autopilot.patient(1.0)
        since = autopilot.now
        autopilot.ask(fault="link_cut+5")
        await flight.run(4.5, NORTH)
        age = flight.now - flight.status.at
        assert age > 3.5
        await flight.run(2.0, NORTH)
        assert "failsafe_takeover" in flight.events
        assert autopilot.truth["flying"] == "pilot"
        assert flight.now - flight.status.at < 1.2
        times, speeds = autopilot.speeds(since)
        assert np.all(speeds[times > since + 2.7] < 0.5)

    over_the_wire(tmp_path, script)


def test_a_short_cut_is_flown_through(tmp_path):
    async def script(flight, autopilot):
        await flight.cruise(autopilot)
        autopilot.ask(fault="link_cut+1.5")
        await flight.run(3.0, NORTH)
        assert flight.vehicle.in_control
        assert flight.status.mode == "offboard"
        assert autopilot.truth["velocity"][0] > 1.5

    over_the_wire(tmp_path, script)


def test_rates_are_requested_again_after_a_reboot_in_flight_and_nothing_is_resumed(tmp_path):
    async def script(flight, autopilot):
        await flight.cruise(autopilot)
        autopilot.ask(fault="reboot=2")
        await flight.run(6.0, NORTH)
        assert "autopilot_rebooted" in flight.events
        assert not flight.vehicle.in_control
        flight.seen.clear()
        await flight.run(2.0)
        imu = [sample.at for seen in flight.seen for sample in seen.imu]
        assert len(imu) > 150
        assert np.all(np.diff(imu) > 0.0)
        assert abs(autopilot.truth["velocity"][0]) < 0.5

    over_the_wire(tmp_path, script)


@pytest.mark.parametrize("dialect", ["px4", "ardupilot"])
def test_with_all_acknowledgements_lost_a_flight_is_a_flight(dialect, tmp_path):
    async def script(flight, autopilot):
        await flight.ready()
        autopilot.ask(fault="acks_lost")
        await flight.take_off()
        await flight.run(2.0, NORTH)
        await flight.land()
        assert autopilot.truth["on_ground"]
        assert max(row for row in autopilot.speeds(0.0)[1]) > 1.0

    over_the_wire(tmp_path, script, dialect)


def test_lost_delayed_and_reordered_packets_are_flown_through(tmp_path):
    async def script(flight, autopilot):
        await flight.ready()
        for fault in ("packets_lost=0.2", "packets_reordered=0.2", "packets_delayed=0.1"):
            autopilot.ask(fault=fault)
        await flight.take_off()
        await flight.run(4.0, NORTH)
        assert flight.vehicle.in_control
        assert "autopilot_rebooted" not in flight.events

    over_the_wire(tmp_path, script)


def test_unanswered_rate_requests_are_repeated(tmp_path):
    async def script(flight, autopilot):
        await flight.until(lambda: autopilot.now > 12.0)
        flight.seen.clear()
        await flight.run(3.0)
        assert sum(len(seen.imu) for seen in flight.seen) > 250
        assert sum(seen.gnss is not None for seen in flight.seen) > 10

    over_the_wire(tmp_path, script, "ardupilot", faults=("packets_lost=0.8@0+10",))


def test_a_denied_take_off_is_reported_and_can_be_landed(tmp_path):
    async def script(flight, autopilot):
        await flight.arm()
        autopilot.ask(fault="command_denied=22")
        await flight.until(lambda: "take_off_refused" in flight.events, CLIMB)
        assert not flight.status.in_air

    over_the_wire(tmp_path, script)
