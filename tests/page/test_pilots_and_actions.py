"""One pilot at a time, and actions that are refused, taken, acknowledged and observed."""

from types import SimpleNamespace

import pytest
from samples import calm

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.engine.flight_loop import Operator
from missionkit.engine.prepared_mission import prepare
from missionkit.messages import Command, Fired, Mode, Observation, Record, VehicleStatus
from missionkit.page.live.action_desk import ActionDesk
from missionkit.page.live.offered_actions import Offer, offered
from missionkit.page.live.pilot_seat import PilotSeat
from missionkit.page.server.page_source import PageError
from missionkit.page.server.sessions import Role, Sessions, Tokens

CHART = """\
missionkit: 1
mission: desk
camera: {use: none}
initial: idle
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: 2}
    transitions: [{to: wait, when: done}]
  wait:
    kind: gps
    behavior: {use: hold}
    transitions: [{to: land, event: go}, {to: land, after: 60}]
  land: {kind: land}
"""


@pytest.fixture(scope="module")
def chart():
    catalogue = builtin()
    return prepare(parse(CHART, "desk.yaml", catalogue), catalogue).chart


@pytest.fixture
def desk(chart):
    clock = SimpleNamespace(now=100.0)
    it = ActionDesk(chart, Operator(), lambda: clock.now)
    it.offers = (Offer("hold"), Offer("event", "go"), Offer("land", dangerous=True))
    return SimpleNamespace(desk=it, clock=clock)


def press(it, action, number="1", event=None, age=0.1, received=None):
    message = {"kind": "action", "id": number, "action": action, "event": event, "who": "pilot 1",
               "address": "::1", "age": age, "received": received or it.clock.now}  # fmt: skip
    it.desk.heard(message, 7, 0.4)
    return it.desk.recent[-1]


def tick(state="wait", now=1.0, fired=(), mode="offboard", paused=False, in_air=True):
    status = VehicleStatus(now, in_air, in_air, True, mode)
    seen = calm(now=now, status=status)
    kind = Mode.NONE if state == "land" else Mode.GPS
    return Record(now, state, (state,), kind, (), fired, Command(), "", (), seen, paused=paused)


def test_an_action_is_taken_once_and_reported_with_the_next_tick(desk):
    taken = press(desk, "event", event="go")
    assert (taken.stage, taken.tick) == ("taken", 8)
    assert desk.desk.operator.take() == ("go",)
    (said,) = desk.desk.report().actions
    assert said.said() == "pilot 1 at ::1: event go"
    assert desk.desk.report().actions == ()
    assert press(desk, "event", event="go").says == "this was sent before: press again"
    assert desk.desk.operator.take() == ()


@pytest.mark.parametrize(
    ("action", "event", "age", "delay", "says"),
    [
        ("return", None, 0.1, 0.0, "return is not possible now"),
        ("event", "stop", 0.1, 0.0, "event stop is not possible now"),
        ("hold", None, 0.9, 0.2, "it arrived 1.1 s after the press, later than 1 s: press again"),
    ],
)
def test_what_is_late_or_not_offered_is_refused(desk, action, event, age, delay, says):
    received = desk.clock.now - delay
    refused = press(desk, action, event=event, age=age, received=received)
    assert (refused.stage, refused.says, refused.tick) == ("refused", says, None)
    assert desk.desk.operator.take() == ()
    assert desk.desk.report().actions == ()


def test_an_action_is_observed_where_the_record_shows_it(desk):
    press(desk, "hold")
    desk.desk.follow(tick(paused=False), [], in_control=True)
    assert desk.desk.recent[-1].stage == "taken"
    desk.desk.follow(tick(paused=True), [], in_control=True)
    assert desk.desk.recent[-1].stage == "observed"
    press(desk, "event", "2", event="go")
    desk.desk.follow(tick(now=1.6), [], in_control=True)
    assert desk.desk.recent[-1].says == "the chart heard it, and no transition was taken"
    desk.desk.follow(tick(now=1.7), [{"reason": "on go"}], in_control=True)
    assert (desk.desk.recent[-1].stage, desk.desk.recent[-1].says) == ("observed", "")
    press(desk, "land", "3")
    assert desk.desk.operator.wants_down
    desk.desk.follow(tick(mode="land"), [], in_control=True)
    assert desk.desk.recent[-1].stage == "acknowledged"
    desk.desk.follow(tick("land"), [], in_control=True)
    assert desk.desk.recent[-1].stage == "observed"


def test_silence_is_known_once_a_pilot_has_lived(desk):
    assert desk.desk.report().silent_for is None
    desk.desk.heard({"kind": "alive"}, 7, 0.4)
    desk.clock.now += 3.5
    assert desk.desk.report().silent_for == pytest.approx(3.5)


def names(chart, record, in_control=True, raised=frozenset()):
    seen = Observation(record.now, in_control=in_control)
    return [it.event or it.action for it in offered(chart, raised, record, seen, controls=True)]


def test_only_what_is_possible_now_is_offered(chart):
    assert names(chart, tick()) == ["hold", "land", "go"]  # no way home in this chart
    assert names(chart, tick(), raised=frozenset(("go",))) == ["hold", "land"]
    assert names(chart, tick(paused=True)) == ["continue", "land", "go"]
    assert names(chart, tick(), in_control=False) == ["give_back", "hold", "land", "go"]
    assert names(chart, tick("land")) == []
    assert names(chart, tick("idle", in_air=False)) == ["hold"]


def test_a_seat_changes_by_consent_or_after_silence():
    clock, said = SimpleNamespace(now=0.0), []
    seat = PilotSeat(lambda: clock.now, lambda what, who: said.append((who.name, what)))
    sessions = Sessions(Tokens("fly", "look"))
    first, second, viewer = (sessions.enter(it, "::1") for it in ("fly", "fly", "look"))
    assert viewer.role is Role.VIEWER
    for each in (viewer, first, second):
        seat.arrived(each)
    assert seat.pilot is first
    seat.change("ask", second)
    seat.change("refuse", first)
    assert (seat.pilot, seat.asking) == (first, None)
    with pytest.raises(PageError, match="only the pilot"):
        seat.change("grant", second)
    clock.now = 9.0
    assert seat.alive(first)
    assert not seat.alive(second)
    clock.now = 18.0
    seat.change("ask", second)
    assert seat.pilot is first
    clock.now = 20.0
    seat.change("ask", second)
    assert seat.pilot is second
    seat.change("release", second)
    assert seat.silent_for is None
    assert [what for _, what in said] == [
        "took the controls",
        "asked for the controls",
        "kept the controls",
        "asked for the controls",
        "took the controls from pilot 1, silent",
        "released the controls",
    ]


def test_a_fired_transition_is_no_event_of_the_operator(desk):
    press(desk, "event", event="go")
    record = tick(fired=(Fired("wait", "land", "after 60 s", (), ()),))
    desk.desk.follow(record, [{"reason": "after 60 s"}], in_control=True)
    assert desk.desk.recent[-1].stage == "taken"
