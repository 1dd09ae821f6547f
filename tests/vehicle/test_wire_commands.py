"""Commands whose answers are late, missing or "no"; setpoints do not wait for any of them."""

import asyncio
import threading

import pytest
from vehicle.flying import over_the_wire, until
from vehicle.ticked_flight import ARM, NORTH

LATE = 0.33  # s of the wall: a command is sent twice before the answer to the first arrives


@pytest.mark.parametrize("dialect", ["px4", "ardupilot"])
def test_with_late_acknowledgements_a_flight_is_a_flight(dialect, tmp_path):
    async def script(flight, autopilot):
        await flight.ready()
        autopilot.ask(fault=f"acks_delayed={autopilot.speed * LATE}")
        await flight.take_off()
        await flight.until(lambda: autopilot.truth["velocity"][0] > 1.5, NORTH)
        await flight.land()
        assert autopilot.truth["on_ground"]
        assert not [it for it in flight.events if it.endswith(("_refused", "_unconfirmed"))]
        arming = [it for it in autopilot.notes("command") if it["which"].startswith("400 ")]
        assert len(arming) <= 4

    over_the_wire(tmp_path, script, dialect)


def test_setpoints_and_the_last_hold_do_not_wait_for_unanswered_calls(tmp_path):
    async def script(flight, autopilot):
        await flight.cruise(autopilot)
        since, answered = autopilot.now, threading.Event()
        calls = [asyncio.ensure_future(flight.vehicle.call(answered.wait, 20)) for _ in range(8)]
        await flight.run(3.0, NORTH)
        assert not any(call.done() for call in calls)
        assert len(autopilot.notes("setpoint", since)) > 30
        assert autopilot.truth["velocity"][0] > 1.5
        closing = asyncio.ensure_future(flight.vehicle.close())
        await asyncio.to_thread(until, lambda: autopilot.truth["mode"] == "LOITER")
        assert not closing.done()
        answered.set()
        await closing

    over_the_wire(tmp_path, script)


def test_a_vehicle_that_refuses_to_hold_is_not_armed(tmp_path):
    async def script(flight, autopilot):
        await flight.ready()
        autopilot.ask(fault="command_denied=176")
        await flight.until(lambda: "arm_refused" in flight.events, ARM)
        commands = [note["which"].split()[0] for note in autopilot.notes("command")]
        assert "176" in commands
        assert "400" not in commands
        assert not autopilot.truth["armed"]

    over_the_wire(tmp_path, script)


def test_healthy_sensors_are_not_enough_to_be_ready(tmp_path):
    async def script(flight, autopilot):
        state = flight.vehicle.state
        await flight.until(lambda: state.placed and state.sensor("GNSS"))
        await flight.run(2.0)
        assert not flight.status.ready
        autopilot.ask(clear="arming_denied")
        await flight.ready()

    over_the_wire(tmp_path, script, faults=("arming_denied",))
