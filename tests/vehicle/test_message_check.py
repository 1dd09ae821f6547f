"""One odd packet is not believed; several that agree are."""

import numpy as np
import pytest

from missionkit.vehicle.autopilot_dialect import PX4 as PX4_DIALECT
from missionkit.vehicle.command.control_authority import ControlAuthority
from missionkit.vehicle.link.boot_epoch import SEVERAL, BootEpoch, Stamp
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.link.message_check import MessageCheck
from missionkit.vehicle.telemetry.autopilot_state import Whereabouts

QUADROTOR, FIXED_WING, PX4, ARDUPILOT = 2, 1, 12, 3
OFFBOARD, POSITION = 6 << 16, 3 << 16
STANDBY, ACTIVE, CRITICAL = 3, 4, 5  # MAV_STATE
HOLD, LAND = 3 << 24 | 4 << 16, 6 << 24 | 4 << 16
MODES = {word: number for number, word in PX4_DIALECT.modes.items()}
ON_GROUND = Whereabouts(on_ground=True)


def beat(mode=OFFBOARD, armed=True, kind=QUADROTOR, autopilot=PX4, status=ACTIVE):
    return {
        "custom_mode": mode,
        "base_mode": 0x80 if armed else 1,
        "system_status": status if armed else STANDBY,
        "type": kind,
        "autopilot": autopilot,
    }


class Autopilot:
    """A check, what passes it, and what it says."""

    def __init__(self, expected=lambda _: False, pace=1.0):
        self.now, self.expected = 1000.0, expected
        self.cache = Cache(lambda: self.now)
        self.sent_events, self.notes, self.judged, self.believed = [], [], [], []
        self.check = MessageCheck(self.cache, self.sent_events.append, self.notes.append, pace)
        self.report_to(self)

    def report_to(self, judge):
        self.check.report_to(
            judge, lambda: self.judged.append("rebooted"), lambda: self.judged.append("asked")
        )

    def expects(self, now):
        return self.expected(now)

    def doubt(self, message):
        self.judged.append("doubt")

    unsettled = False

    def accepted(self, command):
        self.judged.append(command)

    def replaced(self, by):
        self.judged.append(by)

    def hear(self, message):
        self.believed.append(message["custom_mode"])

    def send(self, *beats):
        for each in beats:
            self.now += 1.0
            self.check("HEARTBEAT", each)
        return self

    def stamp(self, boot, wait=0.02, name="LOCAL_POSITION_NED"):
        self.now += wait
        self.check(name, {"time_boot_ms": round(1e3 * boot)})

    def fly(self, seconds, boot=50.0):
        for n in range(round(50 * seconds)):
            self.stamp(boot + 0.02 * n)
        return boot + seconds

    @property
    def mode(self):
        return self.cache.latest("HEARTBEAT")["custom_mode"]


def watched(order="offboard", *, unheard=False):
    """Return an autopilot that follows our order, an authority that judges it, and its events."""
    autopilot, events = Autopilot(), []
    authority = ControlAuthority(
        PX4_DIALECT, lambda: None, events.append, lambda: unheard, lambda: ON_GROUND
    )
    authority.order(order)
    autopilot.report_to(authority)
    autopilot.send(beat(MODES[order]))
    return autopilot, authority, events


def test_a_surprising_mode_is_accepted_when_the_next_heartbeat_confirms_it():
    autopilot = Autopilot().send(beat(), beat(HOLD))
    assert autopilot.mode == OFFBOARD
    assert autopilot.judged == ["doubt", "asked"]
    assert autopilot.cache.latest("HEARTBEAT").arrived == autopilot.now
    assert autopilot.send(beat(HOLD)).mode == HOLD
    assert autopilot.notes == []


@pytest.mark.parametrize("odd", [beat(HOLD), beat(armed=False), beat(LAND, armed=False)])
def test_an_unconfirmed_heartbeat_is_ignored_and_reported(odd):
    autopilot = Autopilot().send(beat(), odd, beat())
    assert autopilot.mode == OFFBOARD
    (why,) = autopilot.notes
    assert "was ignored: the next one did not confirm it" in why
    assert autopilot.send(odd, beat(HOLD | 1), beat(HOLD | 1)).mode == HOLD | 1


def test_old_heartbeats_that_were_overtaken_on_the_way_confirm_nothing():
    autopilot = Autopilot().send(beat(), beat(HOLD))
    autopilot.now += 0.05
    autopilot.check("HEARTBEAT", beat(HOLD))
    assert autopilot.mode == OFFBOARD
    assert autopilot.judged == ["doubt", "asked", "doubt"]
    assert autopilot.believed == [OFFBOARD]
    assert autopilot.send(beat(), beat(HOLD)).mode == OFFBOARD
    assert autopilot.send(beat(HOLD)).mode == HOLD


@pytest.mark.parametrize(("cut", "event"), [(5.0, "failsafe"), (1.0, "pilot")])
def test_a_burst_of_heartbeats_does_not_change_who_took_over(cut, event):
    autopilot, heard, events = Autopilot(), [0.0, 0.0], []
    authority = ControlAuthority(
        PX4_DIALECT, lambda: None, events.append, lambda: heard[-1] - heard[-2] > 2.0
    )
    authority.order("offboard")
    autopilot.send(beat())
    autopilot.cache.listen(lambda message: heard.append(message.arrived))
    autopilot.report_to(authority)
    autopilot.send(beat(), beat())
    for wait in (cut, 0.05, 0.05):
        autopilot.now += wait
        autopilot.check("HEARTBEAT", beat(POSITION))
        assert authority.state == "doubting"
    autopilot.send(beat(POSITION))
    assert events == [f"{event}_takeover"]


@pytest.mark.parametrize(
    ("status", "unheard", "landed", "sent_events"),
    [
        (CRITICAL, False, LAND, ["failsafe_takeover"]),
        (ACTIVE, False, LAND, ["pilot_takeover"]),
        (ACTIVE, True, LAND, ["failsafe_takeover"]),
        (CRITICAL, False, HOLD, ["failsafe_takeover"]),
    ],
)
def test_a_landing_by_another_that_is_over_before_it_is_confirmed_is_a_takeover(
    status, unheard, landed, sent_events
):
    """A stalled process hears all of it at once: no heartbeat confirms another in time."""
    autopilot, authority, events = watched(unheard=unheard)
    for _ in range(4):
        autopilot.now += 0.03
        autopilot.check("HEARTBEAT", beat(LAND, status=status))
    assert events == []
    autopilot.send(beat(landed, armed=False), beat(landed, armed=False))
    assert events == sent_events
    assert not authority.ours
    assert not any("was ignored" in it for it in autopilot.notes)


@pytest.mark.parametrize(
    ("order", "mode", "sent_events"),
    [
        ("offboard", LAND, ["pilot_takeover"]),
        ("offboard", OFFBOARD, []),
        ("offboard", POSITION, []),
        ("land", LAND, []),
        ("land", HOLD, []),
        ("return", LAND, []),
    ],
)
def test_a_landing_seen_only_at_its_end_belongs_to_whoever_ordered_it(order, mode, sent_events):
    autopilot, authority, events = watched(order)
    autopilot.send(beat(mode, armed=False))
    assert events == sent_events
    assert authority.ours is (sent_events == [])


def test_a_stray_mode_before_our_own_landing_ended_takes_nothing_over():
    autopilot, authority, events = watched("land")
    autopilot.send(beat(LAND), beat(POSITION), beat(LAND, armed=False))
    assert events == []
    assert authority.state == "ground"


@pytest.mark.parametrize("pace", [1.0, 4.0])
def test_heartbeats_are_requested_at_most_five_times_a_second(pace):
    autopilot = Autopilot(pace=pace).send(beat())
    for n in range(100):  # 2 s of the vehicle
        autopilot.now += 0.02 / pace
        autopilot.check("HEARTBEAT", beat(HOLD | n))
    assert 9 <= autopilot.judged.count("asked") <= 10
    assert autopilot.judged.count("doubt") == 100


def test_an_early_heartbeat_request_is_repeated_later():
    autopilot = Autopilot().send(beat(), beat(HOLD))
    autopilot.now += 0.05
    autopilot.check("COMMAND_ACK", {"command": 176, "result": 0})
    assert autopilot.judged.count("asked") == 1
    autopilot.stamp(50.0, 0.1)
    assert autopilot.judged.count("asked") == 1
    autopilot.stamp(50.1, 0.1)
    assert autopilot.judged.count("asked") == 2


def test_an_expected_mode_is_accepted_at_once():
    autopilot = Autopilot(lambda now: now.mode == LAND).send(beat(), beat(LAND))
    assert (autopilot.mode, autopilot.judged) == (LAND, [])


@pytest.mark.parametrize("stranger", [beat(kind=FIXED_WING), beat(HOLD, autopilot=ARDUPILOT)])
def test_another_kind_of_vehicle_is_ignored_unless_it_is_the_only_one(stranger):
    autopilot = Autopilot().send(beat(), stranger, stranger, beat())
    assert (autopilot.mode, autopilot.judged) == (OFFBOARD, [])
    assert len(autopilot.notes) == 1
    autopilot.send(stranger, stranger, stranger)
    assert autopilot.mode == OFFBOARD
    assert len(autopilot.judged) == 1


def test_two_kinds_in_turn_are_two_vehicles_with_one_id():
    autopilot = Autopilot().send(*[beat(), beat(kind=FIXED_WING)] * 4)
    assert autopilot.sent_events == ["two_vehicles"]
    assert any("give each its own" in it for it in autopilot.notes)
    assert autopilot.check.contested
    assert not autopilot.send(*[beat()] * 11).check.contested


@pytest.mark.parametrize("odd", [4000.0, 0.5, -1.5])
def test_a_timestamp_off_the_clock_is_ignored_and_reported(odd):
    autopilot = Autopilot()
    boot = autopilot.fly(1.0)
    for _ in range(3):
        autopilot.stamp(boot + odd)
        assert autopilot.cache.latest("LOCAL_POSITION_NED")["time_boot_ms"] < 1e3 * boot
        boot = autopilot.fly(0.2, boot)
    assert autopilot.judged == []
    assert "its timestamp does not fit the autopilot's clock" in autopilot.notes[0]


def test_a_clock_that_begins_again_is_a_reboot_once_several_messages_agree():
    autopilot = Autopilot()
    autopilot.fly(1.0)
    for n in range(SEVERAL):
        assert autopilot.judged == []
        autopilot.stamp(0.3 + 0.02 * n)
    assert autopilot.judged == ["rebooted"]
    autopilot.fly(1.0, 0.5)
    assert autopilot.judged == ["rebooted"]


def test_a_clock_jump_ahead_is_followed_and_is_not_a_reboot():
    epoch = BootEpoch()
    worth = [epoch.judge(0.02 * n, 100.0 + 0.02 * n) for n in range(50)]
    worth += [epoch.judge(60.0 + 0.02 * n, 101.0 + 0.02 * n) for n in range(50)]
    assert worth.count(Stamp.ODD) == SEVERAL - 1
    assert worth.count(Stamp.CHANGED) == 1
    assert worth.count(Stamp.REBOOTED) == 0


@pytest.mark.parametrize("apart", [3.0, 40.0])
def test_two_clocks_at_once_are_two_vehicles_with_one_id(apart):
    autopilot = Autopilot()
    for n in range(100):
        autopilot.stamp(50.0 + 0.02 * n, 0.01)
        autopilot.stamp(50.0 + apart + 0.02 * n, 0.01)
    assert autopilot.sent_events == ["two_vehicles"]
    assert autopilot.judged == []
    autopilot.fly(6.0, 52.0)
    assert not autopilot.check.contested


@pytest.mark.parametrize("apart", [0.05, 0.2, 0.8, -0.8])
def test_two_vehicles_started_together_are_reported_within_a_second(apart):
    autopilot = Autopilot()
    for n in range(30):
        autopilot.stamp(50.0 + 0.033 * n, 0.02)
        autopilot.stamp(50.02 + apart + 0.033 * n, 0.013)
    assert autopilot.check.contested
    assert autopilot.sent_events == ["two_vehicles"]
    assert autopilot.judged == []
    autopilot.fly(6.0, 52.0)
    assert not autopilot.check.contested


def test_two_vehicles_that_answer_in_bursts_are_reported():
    """Enough of the other clock in a row to be believed, and then again of this one."""
    autopilot = Autopilot()
    for n in range(20):
        for each in range(6):
            autopilot.stamp(50.0 + 40.0 * (n % 2) + 0.12 * n + 0.02 * each)
    assert "two_vehicles" in autopilot.sent_events


def test_a_link_that_reorders_one_in_five_is_not_two_vehicles():
    rng, autopilot = np.random.default_rng(5), Autopilot()
    order = np.argsort(np.arange(400) + 1.5 * (rng.random(400) < 0.2))
    for n in order:
        autopilot.stamp(50.0 + 0.033 * n, 0.033)
    assert autopilot.sent_events == []


@pytest.mark.parametrize("rate", [0.985, 1.0, 1.01])
def test_jitter_stalls_and_drift_of_a_link_are_accepted(rate):
    rng, epoch = np.random.default_rng(3), BootEpoch(pace=4.0)
    boots = np.arange(0.0, 200.0, 0.05)
    late = rng.exponential(0.02, boots.size) + np.where(boots % 20.0 < 3.0, 3.0 - boots % 20.0, 0)
    worth = {epoch.judge(rate * b, 77.0 + (b + d) / 4.0) for b, d in zip(boots, late, strict=True)}
    assert worth == {Stamp.SOUND}


def test_a_late_message_is_not_a_reboot():
    epoch, arrivals = BootEpoch(), (10.0, 10.9, 10.95, 11.0)
    for boot, arrived in zip((5.0, 5.9, 5.1, 6.0), arrivals, strict=True):
        assert epoch.judge(boot, arrived) is Stamp.SOUND


def test_messages_without_a_stamp_or_of_other_clocks_pass():
    autopilot = Autopilot()
    autopilot.fly(1.0)
    autopilot.check("LOCAL_POSITION_NED", {"time_boot_ms": 0})
    autopilot.check("GPS_RAW_INT", {"time_usec": 7_000_000_000})
    assert autopilot.cache.latest("GPS_RAW_INT") is not None
    assert autopilot.cache.latest("LOCAL_POSITION_NED")["time_boot_ms"] == 0


def answers(autopilot, first, count, *boots):
    for n in range(first, first + count):
        for boot in boots:
            autopilot.check("TIMESYNC", {"tc1": boot + n, "ts1": n, "target_system": 0})


def test_two_answers_to_one_request_are_two_vehicles_even_with_close_clocks():
    autopilot = Autopilot()
    answers(autopilot, 1, 20, 5_000)
    answers(autopilot, 21, 20, 0, 0)  # a question of its own; and a packet that came twice
    assert not autopilot.check.contested
    answers(autopilot, 41, 2, 5_000, 5_001)
    assert not autopilot.check.contested  # a stray packet or two
    answers(autopilot, 43, 1, 5_000, 5_001)
    assert autopilot.check.contested
    assert autopilot.sent_events == ["two_vehicles"]
    answers(autopilot, 44, 10, 5_000)
    assert not autopilot.check.contested


def test_an_accepted_command_counts_from_the_first_heartbeat_that_can_show_it():
    it = Autopilot(lambda _: True)
    it.check("COMMAND_ACK", {"command": 21, "result": 0})
    it.check("HEARTBEAT", beat())
    assert 21 not in it.judged
    it.check("COMMAND_ACK", {"command": 20, "result": 4})
    it.send(beat(), beat())
    assert [each for each in it.judged if isinstance(each, int)] == [21]
