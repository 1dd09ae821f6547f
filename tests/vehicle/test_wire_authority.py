"""Control authority: a pilot's HOLD does not end a flight, and one odd packet is not a takeover."""

import pytest
from vehicle.flying import over_the_wire
from vehicle.message_filter import MessageFilter
from vehicle.ticked_flight import LAND, NORTH

from missionkit.messages import Action, Command
from missionkit.vehicle.failsafe_parameters import FailsafeLevel
from missionkit.vehicle.preflight.inspection import inspect

HIGH = Command(action=Action.TAKE_OFF, height=8.0)
BACK = Command(action=Action.RETURN)
HOLD = "pilot_mode=LOITER"
LEFT_ALONE = 1.5  # s
TAKEN = {"pilot_takeover", "failsafe_takeover"}  # after a stall of this machine, either


async def left_to_the_pilot(flight, autopilot, wish):
    """Wait until the takeover is noticed; see that nothing more is asked for."""
    await flight.until(lambda: TAKEN & set(flight.events), wish)
    assert not flight.vehicle.in_control
    await flight.run(0.5)  # what was on its way
    since = autopilot.now
    for command in (wish, LAND, NORTH):
        await flight.run(LEFT_ALONE, command)
    commands = {it["which"][:3] for it in autopilot.notes("command", since)}
    assert commands <= {"511", "512"}  # streams and messages
    assert autopilot.notes("mode", since) + autopilot.notes("setpoint", since) == []
    assert autopilot.truth["mode"] == "LOITER"
    (why,) = [it for it in flight.vehicle.take_remarks() if "control given up" in it]
    assert "a pilot commands" in why or "it had stopped receiving missionkit" in why


@pytest.mark.parametrize("dialect", ["px4", "ardupilot"])
def test_a_pilots_hold_does_not_count_as_the_end_of_a_landing(dialect, tmp_path):
    async def land(flight, autopilot):
        await flight.take_off()
        await flight.until(lambda: autopilot.truth["mode"] == "LAND", LAND)
        autopilot.ask(fault=HOLD)
        await left_to_the_pilot(flight, autopilot, LAND)
        assert not autopilot.truth["on_ground"]

    over_the_wire(tmp_path, land, dialect)


@pytest.mark.parametrize("dialect", ["px4", "ardupilot"])
def test_a_pilots_hold_does_not_count_as_the_end_of_a_take_off(dialect, tmp_path):
    async def climb(flight, autopilot):
        await flight.arm()
        await flight.until(lambda: autopilot.truth["position"][2] < -1.0, HIGH)
        autopilot.ask(fault=HOLD)
        await left_to_the_pilot(flight, autopilot, HIGH)
        assert -autopilot.truth["position"][2] < 4.0

    over_the_wire(tmp_path, climb, dialect)


def test_a_pilots_hold_does_not_count_as_the_end_of_a_return(tmp_path):
    async def turn_back(flight, autopilot):
        await flight.cruise(autopilot)
        await flight.until(lambda: autopilot.truth["position"][0] > 8.0, NORTH)
        await flight.until(lambda: autopilot.truth["mode"] == "RTL", BACK)
        autopilot.ask(fault=HOLD)
        await left_to_the_pilot(flight, autopilot, BACK)

    over_the_wire(tmp_path, turn_back)


def spoofed(message, changes):
    """Return a message of the autopilot with other contents."""
    fields = {name: getattr(message, name) for name in message.fieldnames}
    return type(message)(**(fields | changes))


ODD = [
    {"custom_mode": 3 << 16},
    {"base_mode": 29},  # disarmed
    {"type": 1},
]


def test_one_odd_heartbeat_is_not_a_takeover_and_is_reported(tmp_path):
    async def fly(flight, autopilot):
        link = MessageFilter(autopilot)
        await flight.cruise(autopilot)
        await flight.until(lambda: "HEARTBEAT" in link.passed, NORTH)
        for odd in ODD:
            flight.vehicle.take_remarks()
            since = autopilot.now
            link.inject(spoofed(link.passed["HEARTBEAT"], odd))
            await flight.run(2.5, NORTH)
            assert flight.vehicle.in_control, odd
            assert autopilot.notes("mode", since) == []
            assert autopilot.truth["velocity"][0] > 1.5
            assert any("ignored" in it for it in flight.vehicle.take_remarks()), odd
            assert all(seen.status is None or seen.status.in_air for seen in flight.seen[-50:])

    over_the_wire(tmp_path, fly)


def test_a_stamp_from_the_future_or_the_past_ends_nothing(tmp_path):
    async def fly(flight, autopilot):
        link = MessageFilter(autopilot)
        await flight.cruise(autopilot)
        for ahead in (3.6e6, -20000):
            flight.vehicle.take_remarks()
            now = link.passed["LOCAL_POSITION_NED"]
            link.inject(spoofed(now, {"time_boot_ms": max(1, int(now.time_boot_ms + ahead))}))
            await flight.run(3.0, NORTH)
            assert flight.vehicle.in_control, ahead
            assert "autopilot_rebooted" not in flight.events
            assert len([s for seen in flight.seen[-40:] for s in seen.imu]) > 100
            assert any("stamp" in it for it in flight.vehicle.take_remarks()), ahead

    over_the_wire(tmp_path, fly)


def test_two_vehicles_with_one_id_are_reported(tmp_path):
    async def look(flight, autopilot):
        link = MessageFilter(autopilot)
        await flight.ready()

        def twice(message):
            link.inject(spoofed(message, {"time_boot_ms": message.time_boot_ms + 30_000, "x": 5.0}))
            return [message]

        link.on("LOCAL_POSITION_NED", twice)
        await flight.until(lambda: "two_vehicles" in flight.events)
        assert any("same system id" in it for it in flight.vehicle.take_remarks())
        report = await inspect(flight.vehicle, pace=autopilot.speed)
        assert "system" in {
            check.what for check in report.checks if check.level is FailsafeLevel.BAD
        }

    over_the_wire(tmp_path, look)


@pytest.mark.parametrize("answers", [True, False])
def test_a_pilot_wins_within_two_heartbeats_even_if_the_second_is_not_sent_early(answers, tmp_path):
    async def fly(flight, autopilot):
        beats = []
        await flight.cruise(autopilot)
        if not answers:
            autopilot.ask(fault="command_denied=512")
        autopilot.ask(fault="pilot_mode=POSCTL")
        MessageFilter(autopilot).on("HEARTBEAT", lambda it: beats.append(it) or [it])
        await flight.until(lambda: not flight.vehicle.in_control, NORTH)
        assert len(beats) <= 4  # two, and those sent before the second was looked at

    over_the_wire(tmp_path, fly)
