"""Commands against an autopilot of a few lines that answers, refuses, or loses its commands."""

import threading
import time

import pytest

from missionkit.messages import Action
from missionkit.vehicle.autopilot_dialect import ARDUPILOT, PX4
from missionkit.vehicle.command.autopilot_commands import OFFBOARD_MODE, Commander
from missionkit.vehicle.command.command_transaction import CommandOutcome
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.telemetry.autopilot_state import AutopilotState

PATIENCE = 20.0  # s; only what is broken needs that long

LOITER, TAKEOFF, LAND, OFF = 4 << 16 | 3 << 24, 4 << 16 | 2 << 24, 4 << 16 | 6 << 24, 6 << 16
RETURN = 4 << 16 | 5 << 24


class Autopilot:
    """Carries out its commands, and sends heartbeats, unless `loses` or `denies` says else."""

    def __init__(self, cache, dialect=PX4, loses=(), denies=(), ignores=()):
        self.cache, self.dialect = cache, dialect
        self.loses, self.denies, self.ignores = loses, denies, ignores
        self.received, self.parameters = [], {}
        self.mode, self.armed = 0, False
        self.beat()

    def beat(self):
        self.cache.put(
            "HEARTBEAT",
            {"custom_mode": self.mode, "base_mode": 0x80 if self.armed else 1, "system_status": 3},
        )

    def send(self, name, **fields):
        command = int(fields["command"])
        params = [fields[f"param{n}"] for n in range(1, 8)]
        self.received.append((command, *params))
        if command in self.denies:
            self.answer(command, 2)
            return
        if command not in self.ignores:
            self.obey(command, params)
        if command not in self.loses:
            self.answer(command, 0)
        self.beat()

    def obey(self, command, params):
        if command == 400:
            self.armed = params[0] == 1.0
        elif command == 22 and self.dialect is PX4:
            self.mode = TAKEOFF
        elif command == 20:
            self.mode = RETURN if self.dialect is PX4 else 6
        elif command == 21:
            self.mode = LAND
        elif command == 176 and self.dialect is PX4:
            self.mode = int(params[2]) << 24 | int(params[1]) << 16
        elif command == 176:
            self.mode = int(params[1])

    def answer(self, command, result):
        self.cache.put("COMMAND_ACK", {"command": command, "result": result})

    def parameter(self, name):
        return self.parameters.get(name)

    def set_parameter(self, name, value):
        self.parameters[name] = value
        return True


def desk(dialect=PX4, ours=True, **faults):
    cache = Cache(time.perf_counter)
    autopilot = Autopilot(cache, dialect, **faults)
    orders = []

    def order(mode, height):
        orders.append(mode)
        return ours

    state = AutopilotState(cache, dialect)
    return Commander(autopilot, cache, dialect, state, order, pace=20.0), autopilot, orders


def ids(autopilot):
    return [received[0] for received in autopilot.received]


def test_px4_holds_before_it_arms():
    commander, autopilot, orders = desk()
    assert commander.carry_out((Action.ARM, None)).outcome is CommandOutcome.DONE
    assert autopilot.received[0][:4] == (176, 1.0, 4.0, 3.0)
    assert autopilot.received[1][:3] == (400, 1.0, 0.0)
    assert orders == ["hold"]


def test_ardupilot_arms_in_guided_never_in_brake():
    commander, autopilot, _ = desk(ARDUPILOT)
    assert commander.carry_out((Action.ARM, None)).outcome is CommandOutcome.DONE
    assert autopilot.received[0][:3] == (176, 1.0, 4.0)


def test_arming_is_not_even_tried_when_holding_is_refused():
    commander, autopilot, _ = desk(denies=(176,))
    result = commander.carry_out((Action.ARM, None))
    assert (result.outcome, result.why) == (CommandOutcome.REFUSED, "denied")
    assert ids(autopilot) == [176]


@pytest.mark.parametrize("action", [*Action, OFFBOARD_MODE])
@pytest.mark.parametrize("dialect", [PX4, ARDUPILOT])
def test_nothing_ever_forces_arming_or_disarming(action, dialect):
    commander, autopilot, _ = desk(dialect)
    commander.carry_out((action, 5.0))
    assert autopilot.received
    assert all(received[2] == 0.0 for received in autopilot.received if received[0] == 400)


def test_the_height_goes_to_px4_as_a_parameter_and_to_ardupilot_with_the_command():
    commander, autopilot, _ = desk()
    assert commander.carry_out((Action.TAKE_OFF, 6.0)).good
    assert autopilot.parameters == {"MIS_TAKEOFF_ALT": 6.0}
    assert autopilot.received[-1] == (22, *(None,) * 7)
    commander, autopilot, _ = desk(ARDUPILOT)
    assert commander.carry_out((Action.TAKE_OFF, 6.0)).good
    assert autopilot.received[-1] == (22, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 6.0)


@pytest.mark.parametrize("dialect", [PX4, ARDUPILOT])
def test_a_return_counts_when_the_mode_shows_it(dialect):
    commander, autopilot, orders = desk(dialect)
    assert commander.carry_out((Action.RETURN, None)).outcome is CommandOutcome.DONE
    assert (ids(autopilot), orders) == ([20], ["return"])
    commander, _, _ = desk(dialect, ignores=(20,))
    assert commander.carry_out((Action.RETURN, None)).outcome is CommandOutcome.UNCONFIRMED
    commander, autopilot, _ = desk(dialect, ours=False)
    assert commander.carry_out((Action.RETURN, None)).outcome is CommandOutcome.ABANDONED
    assert autopilot.received == []


def test_lost_acks_do_not_matter_when_telemetry_shows_it():
    commander, autopilot, _ = desk(loses=(176, 400))
    result = commander.carry_out((Action.ARM, None))
    assert (result.outcome, result.took) == (CommandOutcome.DONE, None)
    assert ids(autopilot) == [176, 400]


def test_an_ack_does_not_count_when_telemetry_does_not_show_it():
    commander, _, _ = desk(ignores=(21,))
    assert commander.carry_out((Action.LAND, None)).outcome is CommandOutcome.UNCONFIRMED


def test_silence_means_unknown_after_a_few_repetitions():
    commander, autopilot, _ = desk(loses=(21,), ignores=(21,))
    assert commander.carry_out((Action.LAND, None)).outcome is CommandOutcome.UNKNOWN
    assert ids(autopilot) == [21] * 4


def test_the_pilot_is_not_overruled():
    commander, autopilot, _ = desk(ours=False)
    for wish in ((Action.LAND, None), (Action.ARM, None), (OFFBOARD_MODE, None)):
        assert commander.carry_out(wish).outcome is CommandOutcome.ABANDONED
    assert autopilot.received == []


def test_a_more_urgent_wish_overtakes_one_that_waits_in_vain():
    commander, autopilot, _ = desk(loses=(22,), ignores=(22,))
    asked = threading.Event()
    autopilot.cache.listen(lambda message: message.name == "HEARTBEAT" and asked.set())
    commander.start()
    try:
        assert commander.want((Action.TAKE_OFF, 6.0))
        assert not commander.want((Action.TAKE_OFF, 6.0))
        assert asked.wait(PATIENCE)
        assert commander.want((Action.LAND, None))
        assert autopilot.cache.wait(lambda: autopilot.mode == LAND, PATIENCE)
        assert autopilot.cache.wait(lambda: not commander.busy, PATIENCE)
    finally:
        commander.stop()
    ended = {report.wish[0]: report.result.outcome for report in commander.reports()}
    assert ended == {Action.TAKE_OFF: CommandOutcome.ABANDONED, Action.LAND: CommandOutcome.DONE}


def test_the_link_may_break_without_ending_the_worker():
    commander, autopilot, _ = desk()

    def broken(*_, **__):
        raise RuntimeError("no link")

    autopilot.send = broken
    commander.start()
    try:
        commander.want((Action.LAND, None))
        assert autopilot.cache.wait(lambda: not commander.busy, PATIENCE)
    finally:
        commander.stop()
    (report,) = commander.reports()
    assert (report.result.outcome, report.result.why) == (CommandOutcome.UNKNOWN, "no link")
