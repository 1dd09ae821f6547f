"""Every state of control authority with every trigger, and whole flights heartbeat by heartbeat."""

import pytest
from vehicle.state_tables import state_table

from missionkit.vehicle.autopilot_dialect import ARDUPILOT, PX4
from missionkit.vehicle.command.control_authority import (
    AUTHORITY_TRANSITIONS,
    GIVEN_UP,
    MISSION_STATES,
    ControlAuthority,
    ends,
)
from missionkit.vehicle.link.heartbeat_check import HeartbeatState
from missionkit.vehicle.link.message_cache import Message
from missionkit.vehicle.telemetry.autopilot_state import UNKNOWN_WHEREABOUTS, Whereabouts

ACTIVE, CRITICAL = 4, 5  # MAV_STATE
PX4_MODES = {word: number for number, word in PX4.modes.items()}
AIR, GROUND = Whereabouts(on_ground=False), Whereabouts(on_ground=True, height=0.0, from_home=0.0)

ROWS = """
from              ground      commanding  doubting    pilot       failsafe    rebooted    stranger
ask               .           .           .           .           .           .           .
hear_ours         commanding  .           commanding  .           .           .           .
hear_disarmed     .           ground      ground      .           .           .           .
hear_doubtful     doubting    doubting    .           .           .           .           .
hear_pilot        pilot       pilot       pilot       .           pilot       pilot       .
hear_failsafe     failsafe    failsafe    failsafe    .           .           .           .
hear_stranger     stranger    stranger    stranger    .           stranger    stranger    .
reboot_in_flight  rebooted    rebooted    rebooted    .           rebooted    .           .
reboot_on_ground  .           ground      ground      .           .           .           .
give_back         .           .           .           commanding  commanding  commanding  commanding
"""
STATES, TABLE = state_table(ROWS)


def heartbeat(mode, *, armed=True, status=ACTIVE):
    base = 0x80 if armed else 1
    fields = {"custom_mode": mode, "base_mode": base, "system_status": status}
    return Message("HEARTBEAT", fields, 0.0)


class Desk:
    """An authority with everything it tells, and the truth it asks for."""

    def __init__(self, dialect=PX4):
        self.sent_events, self.notes, self.where, self.unheard = [], [], UNKNOWN_WHEREABOUTS, False
        self.dialect = dialect
        self.authority = ControlAuthority(
            dialect,
            lambda: self.sent_events.append("let go"),
            self.sent_events.append,
            lambda: self.unheard,
            lambda: self.where,
            self.notes.append,
        )

    def hear(self, *modes, armed=True, status=ACTIVE):
        numbers = {word: number for number, word in self.dialect.modes.items()}
        for mode in modes:
            self.authority.hear(heartbeat(numbers[mode], armed=armed, status=status))
        return self

    def fly(self):
        """Arm, take off to 5 m and follow setpoints."""
        self.hear("position", armed=False)
        self.authority.order("hold")
        self.hear("hold", armed=False).hear("hold")
        self.authority.order("take_off", 5.0)
        self.where = Whereabouts(on_ground=False, height=4.6, from_home=0.0)
        self.hear("take_off", "hold")
        self.authority.order("offboard")
        return self.hear("hold", "offboard", "offboard")


@pytest.mark.parametrize("trigger", TABLE)
@pytest.mark.parametrize("state", STATES)
def test_every_trigger_in_every_state(trigger, state):
    authority = Desk().authority
    authority.state = state
    moved = authority.fire(trigger)
    assert moved or TABLE[trigger][state] == state
    assert authority.state == TABLE[trigger][state]


def test_the_table_is_complete():
    assert TABLE.keys() == {row[0] for row in AUTHORITY_TRANSITIONS}
    assert tuple(STATES) == (*MISSION_STATES, *GIVEN_UP)


@pytest.mark.parametrize("state", STATES)
def test_a_mode_is_requested_only_while_no_heartbeat_is_doubted(state):
    authority = Desk().authority
    authority.state = state
    assert authority.order("land") is (state in {"ground", "commanding"})
    assert authority.aim == ("land" if state in {"ground", "commanding"} else "")
    assert authority.ours is (state in MISSION_STATES)


def test_a_whole_flight_takes_nothing_over():
    desk = Desk().fly()
    desk.authority.order("land")
    desk.hear("offboard", "land", "land")
    desk.where = GROUND
    desk.hear("hold").hear("hold", armed=False)
    assert desk.authority.state == "ground"
    assert desk.sent_events == []


@pytest.mark.parametrize("mode", ["position", "manual", "hold", "return", "altitude", "land"])
def test_leaving_offboard_unrequested_is_a_takeover(mode):
    desk = Desk().fly().hear(mode)
    assert desk.authority.state == "pilot"
    assert desk.sent_events == ["let go", "pilot_takeover"]
    (why,) = desk.notes
    assert f"mode {mode}, which missionkit did not choose (it had requested offboard)" in why


@pytest.mark.parametrize(
    ("order", "mode", "where", "ours"),
    [
        ("take_off", "hold", Whereabouts(on_ground=False, height=4.1), True),
        ("take_off", "hold", Whereabouts(on_ground=False, height=1.3), False),
        ("take_off", "hold", Whereabouts(on_ground=True, height=4.1), False),
        ("take_off", "hold", UNKNOWN_WHEREABOUTS, False),
        ("land", "hold", GROUND, True),
        ("land", "hold", Whereabouts(on_ground=False, height=0.2), False),
        ("land", "hold", UNKNOWN_WHEREABOUTS, False),
        ("return", "land", Whereabouts(on_ground=False, height=9.0, from_home=1.0), True),
        ("return", "land", Whereabouts(on_ground=False, height=9.0, from_home=9.0), False),
        ("return", "hold", GROUND, True),
        ("return", "hold", UNKNOWN_WHEREABOUTS, False),
        ("land", "position", GROUND, False),
    ],
)
def test_a_command_completes_only_where_the_autopilot_could_complete_it(order, mode, where, ours):
    assert ends(order, 5.0, mode, where) is ours
    desk = Desk().fly()
    desk.authority.order(order, 5.0 if order == "take_off" else None)
    desk.where = AIR
    desk.hear(order)
    desk.where = where
    assert desk.hear(mode).authority.ours is ours


@pytest.mark.parametrize("height", [0.5, 2.0, 10.0])
def test_a_low_take_off_may_end_a_little_early_too(height):
    near = Whereabouts(on_ground=False, height=height - min(1.0, 0.4 * height))
    assert ends("take_off", height, "hold", near)
    assert not ends("take_off", height, "hold", near._replace(height=near.height - 0.01))


def test_a_take_off_broken_off_between_two_heartbeats_is_seen_by_the_height():
    desk = Desk()
    desk.authority.order("hold")
    desk.hear("hold")
    desk.authority.order("take_off", 5.0)
    desk.where = Whereabouts(on_ground=True, height=0.0)
    assert desk.hear("hold").authority.ours
    desk.where = Whereabouts(on_ground=False, height=1.3)
    assert desk.hear("hold").authority.state == "pilot"


def test_an_order_that_is_refused_or_lost_takes_nothing_over():
    desk = Desk().fly()
    desk.authority.order("hold")
    desk.hear("hold")
    desk.authority.order("offboard")
    assert desk.hear("hold", "hold").authority.ours


@pytest.mark.parametrize(("order", "command"), [("land", 21), ("land", 176), ("return", 20)])
def test_an_order_that_was_accepted_and_shows_in_no_heartbeat_was_overridden(order, command):
    desk = Desk().fly()
    desk.authority.order("hold")
    desk.hear("hold")
    desk.where = Whereabouts(on_ground=False, height=4.0, from_home=20.0)
    desk.authority.order(order)
    desk.authority.accepted(400)
    assert desk.hear("hold", "hold").authority.ours
    desk.authority.accepted(command)
    assert desk.hear("hold").authority.ours
    assert desk.authority.unsettled
    assert desk.hear("hold").authority.state == "pilot"
    assert desk.sent_events == ["let go", "pilot_takeover"]


def test_what_was_accepted_before_says_nothing_about_a_new_request():
    desk = Desk().fly()
    desk.authority.order("hold")
    desk.hear("hold")
    desk.where = Whereabouts(on_ground=False, height=4.0, from_home=20.0)
    desk.authority.order("land")
    desk.authority.accepted(21)
    desk.hear("hold")
    desk.authority.order("return")
    assert desk.hear("hold", "hold", "hold").authority.ours
    assert desk.sent_events == []


def test_an_accepted_order_is_not_overridden_on_the_ground_where_it_ended_or_once_it_shows():
    for where, modes in ((GROUND, ("hold",) * 3), (AIR, ("hold", "land", "hold"))):
        desk = Desk().fly()
        desk.authority.order("hold")
        desk.hear("hold")
        desk.authority.order("land")
        desk.where = where
        desk.authority.accepted(21)
        assert desk.hear(*modes[:2]).authority.ours
        assert desk.hear(modes[2]).authority.ours is (where is GROUND)


def test_the_climb_may_end_while_offboard_is_being_requested():
    desk = Desk()
    desk.authority.order("take_off", 5.0)
    desk.where = Whereabouts(on_ground=False, height=5.0)
    desk.hear("take_off")
    desk.authority.order("offboard")
    assert desk.hear("hold", "offboard").authority.ours
    assert not desk.hear("hold").authority.ours


def test_the_pilot_keeps_control_until_giving_it_back_even_in_offboard_or_on_the_ground():
    desk = Desk().fly().hear("position", "offboard")
    assert not desk.authority.ours
    assert not desk.hear("hold", armed=False).authority.ours
    assert desk.authority.resume()
    assert desk.authority.ours
    assert not desk.authority.resume()
    desk = Desk().fly().hear("position")
    desk.authority.resume()
    assert desk.hear("position").authority.ours


def test_on_the_ground_any_mode_is_fine():
    desk = Desk()
    assert desk.hear("manual", "position", "mission", armed=False).authority.state == "ground"


@pytest.mark.parametrize(("mode", "ours"), [("hold", True), ("offboard", True), ("manual", False)])
def test_a_vehicle_found_flying_is_a_pilots_unless_it_holds(mode, ours):
    assert Desk().hear(mode).authority.ours is ours


@pytest.mark.parametrize("flying", [True, False])
def test_a_reboot_in_flight_resumes_nothing(flying):
    desk = Desk().fly()
    desk.authority.rebooted(flying=flying)
    assert desk.authority.state == ("rebooted" if flying else "ground")
    assert desk.sent_events[-1] == "autopilot_rebooted"
    assert desk.hear("hold").authority.ours is not flying


def test_a_pilot_beats_the_autopilots_failsafe_and_its_own_next_mode_does_not():
    desk = Desk().fly().hear("hold", status=CRITICAL)
    assert desk.authority.state == "failsafe"
    assert desk.hear("return", "land").authority.state == "failsafe"
    assert desk.hear("position").authority.state == "pilot"
    assert desk.sent_events == ["let go", "failsafe_takeover", "let go", "pilot_takeover"]


def test_another_kind_of_vehicle_is_not_commanded():
    desk = Desk().fly()
    desk.authority.replaced("fixed wing")
    assert desk.authority.state == "stranger"
    assert desk.sent_events == ["let go", "vehicle_changed"]
    assert "it is a fixed wing" in desk.notes[0]


@pytest.mark.parametrize("unheard", [True, False])
def test_link_loss_counts_from_the_first_doubt(unheard):
    desk = Desk().fly()
    desk.unheard = unheard
    desk.authority.doubt(heartbeat(PX4_MODES["position"]))
    desk.unheard = False
    assert desk.authority.state == "doubting"
    assert desk.hear("position").authority.state == ("failsafe" if unheard else "pilot")


@pytest.mark.parametrize(
    ("mode", "armed", "where", "expected"),
    [
        ("offboard", True, AIR, True),
        ("hold", True, AIR, False),
        ("offboard", False, AIR, False),
        ("offboard", False, UNKNOWN_WHEREABOUTS, False),
        ("offboard", False, GROUND, True),
    ],
)
def test_expected_modes_are_not_surprises(mode, armed, where, expected):
    desk = Desk().fly()
    desk.where = where
    assert desk.authority.expects(HeartbeatState(PX4_MODES[mode], armed)) is expected


def test_arming_is_a_surprise_unless_a_mode_was_requested():
    desk = Desk().hear("hold", armed=False)
    assert not desk.authority.expects(HeartbeatState(PX4_MODES["hold"], armed=True))
    desk.authority.order("hold")
    assert desk.authority.expects(HeartbeatState(PX4_MODES["hold"], armed=True))


def test_in_ardupilots_guided_a_take_off_ends_without_a_change_of_mode():
    desk = Desk(ARDUPILOT)
    desk.authority.order("guided")
    desk.hear("guided")
    desk.authority.order("guided", 5.0)
    desk.where = Whereabouts(on_ground=False, height=1.0)
    assert desk.hear("guided").authority.ours
    assert not desk.hear("loiter").authority.ours


def test_a_guardian_that_holds_ends_commanding_until_a_person_resumes():
    desk = Desk().fly()
    desk.authority.overruled()
    desk.authority.overruled()
    assert desk.authority.state == "failsafe"
    assert desk.sent_events == ["let go", "failsafe_takeover"]
    assert "its guardian made the vehicle hold" in desk.notes[0]
    assert desk.authority.resume()
