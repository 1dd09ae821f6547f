"""Every state of a link with every trigger, and when an autopilot counts as silent."""

import asyncio

import pytest
from vehicle.state_tables import state_table

from missionkit.errors import VehicleError
from missionkit.vehicle.adapter import MavsdkVehicle
from missionkit.vehicle.link.link_address import parse
from missionkit.vehicle.link.link_lifecycle import (
    LINK_LOST_AFTER,
    STATES,
    TRANSITIONS,
    LinkLifecycle,
)
from missionkit.vehicle.link.link_lock import LinkLock
from missionkit.vehicle.link.message_cache import Message

COLUMNS, TABLE = state_table("""
from      unconnected  connecting   identifying  live    silent  refused     closed
connect   connecting   .            .            .       .       connecting  .
answer    .            identifying  .            .       .       .           .
identify  .            .            live         .       .       .           .
refuse    .            refused      refused      .       .       .           .
lose      .            .            .            silent  .       .           .
hear      .            .            .            .       live    .           .
close     closed       closed       closed       closed  closed  closed      .
""")


@pytest.mark.parametrize("trigger", TABLE)
@pytest.mark.parametrize("state", COLUMNS)
def test_every_trigger_in_every_state(trigger, state):
    link = LinkLifecycle()
    link.state = state
    assert link.fire(trigger) is (TABLE[trigger][state] != state)
    assert link.state == TABLE[trigger][state]


def test_the_table_is_complete():
    assert TABLE.keys() == {row[0] for row in TRANSITIONS}
    assert tuple(COLUMNS) == STATES


def heard(link, *times):
    for at in times:
        link.hear(Message("HEARTBEAT", {}, at))
    return link


def live(pace=1.0):
    """Return a link whose autopilot is identified at 100 s, and how often it came back."""
    link, returns = LinkLifecycle(pace), []
    link.fire("connect")
    link.fire("answer")
    heard(link, 90.0, 100.0).identified(lambda: returns.append(link.state))
    return link, returns


@pytest.mark.parametrize("pace", [1.0, 8.0])
def test_without_a_heartbeat_it_falls_silent_in_time_of_the_vehicle(pace):
    link, returns = live(pace)
    last = 100.0 + LINK_LOST_AFTER / pace
    assert (link.at(last), link.at(last + 1e-6), link.at(100.0)) == ("live", "silent", "silent")
    assert heard(link, last + 1.0).at(last + 1.0) == "live"
    assert returns == ["live"]


def test_a_silence_that_nobody_saw_is_noticed_by_the_next_heartbeat():
    link, returns = live()
    assert heard(link, 101.0, 104.0).gap == pytest.approx(3.0)
    assert returns == []
    assert heard(link, 107.1).gap == pytest.approx(3.1)
    assert (link.state, returns) == ("live", ["live"])


def test_a_gap_before_it_was_identified_says_nothing_about_our_setpoints():
    link, _ = live()
    assert link.gap == 0.0
    link.hear(Message("ATTITUDE_QUATERNION", {}, 100.5))
    assert heard(link, 100.5).gap == pytest.approx(0.5)


@pytest.mark.parametrize("state", ["unconnected", "connecting", "identifying", "closed"])
def test_only_a_live_link_falls_silent(state):
    link = LinkLifecycle()
    link.state = state
    assert heard(link, 10.0).at(100.0) == state


def test_a_vehicle_that_is_refused_can_be_tried_again_and_a_closed_one_cannot(tmp_path):
    address = parse("udpout://127.0.0.1:9")

    async def script():
        with LinkLock(address, tmp_path):
            vehicle = MavsdkVehicle(address, lock=LinkLock(address, tmp_path), guard=None)
            for _ in range(2):
                with pytest.raises(VehicleError, match="in use by another missionkit"):
                    await vehicle.connect()
                assert vehicle.link_state == "refused"
        await vehicle.close()
        with pytest.raises(VehicleError, match="the link is closed"):
            await vehicle.connect()

    asyncio.run(script())
