"""Reports between the processes of a fleet: over loopback, each from an origin of its own."""

from __future__ import annotations

import json
import select
import socket

import numpy as np
import pytest
from samples import calm

from missionkit.engine.clock import stopwatch
from missionkit.errors import UsageError
from missionkit.geodesy import Origin
from missionkit.messages import Command, Health, Mode, Record, VehicleStatus
from missionkit.vehicle.link import traffic_link
from missionkit.vehicle.link.fleet_monitor import FleetMonitor
from missionkit.vehicle.link.traffic_link import FleetPlace, TrafficLink

HERE = Origin(47.397742, 8.545594, 488.0)
NORTH = Origin(*HERE.place(np.array([100.0, 0.0, 0.0])))


def record(position=(0.0, 0.0, -5.0), velocity=(1.0, 2.0, 0.0), now=10.0, **changes):
    seen = calm(now=now, position=np.array(position), velocity=np.array(velocity), **changes)
    return Record(now, "s", ("s",), Mode.GPS, (), (), Command(), "", (), seen, done=False)


@pytest.fixture
def fleet(monkeypatch):
    """Two vehicles and whoever started them, on a clock that the test sets."""
    monkeypatch.setattr(traffic_link, "REPORTS_EVERY", 0.0)
    monitor = FleetMonitor(["west", "east"], 5.0)
    sockets = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(2)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    west = TrafficLink(FleetPlace("west", sockets[0].detach(), {"east": ports[1]}, monitor.port))
    east = TrafficLink(FleetPlace("east", sockets[1].detach(), {"west": ports[0]}, monitor.port))
    yield west, east, monitor, ports
    for each in (west, east, monitor):
        each.close()


def arrived(link):
    """Wait for what is under way on loopback."""
    assert select.select([link._socket], [], [], 10.0)[0]


def said(port, message):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as stranger:
        data = message if isinstance(message, bytes) else json.dumps(message).encode()
        stranger.sendto(data, ("127.0.0.1", port))


def test_a_place_survives_the_command_line():
    place = FleetPlace("west", 5, {"east": 4711}, 4712)
    assert FleetPlace.read(place.write()) == place
    with pytest.raises(UsageError, match="--fleet-place is for `missionkit fleet` to give"):
        FleetPlace.read("{}")


def test_a_report_is_seen_from_the_receivers_own_origin(fleet):
    west, east, _, _ = fleet
    assert east.others(0.0, NORTH)[0].report is None
    west.tell(record(position=(30.0, 4.0, -7.0)), HERE)
    arrived(east)
    (other,) = east.others(77.0, NORTH)
    assert other.name == "west"
    assert other.report.position == pytest.approx([-70.0, 4.0, -7.0], abs=1e-3)
    assert other.report.velocity == pytest.approx([1.0, 2.0, 0.0])
    assert 76.0 < other.report.at <= 77.0


def test_a_report_that_waited_is_as_old_as_it_is(fleet, monkeypatch):
    west, east, _, _ = fleet
    west.tell(record(), HERE)
    arrived(east)
    later = stopwatch() + 30.0
    monkeypatch.setattr(traffic_link, "wall", lambda: later)
    assert east.others(100.0, HERE)[0].report.at == pytest.approx(70.0, abs=1.0)


@pytest.mark.parametrize(
    "lost",
    [
        {"health": Health(True, True, 10.0, None, 0.3, 0)},  # diverged
        {"health": Health(False, False, None, None, 0.3, 0)},
        {"status": VehicleStatus(8.0, True, True, True, "offboard")},  # its link is silent
        {"status": None},
    ],
)
def test_who_does_not_know_where_it_is_says_nothing(fleet, lost):
    west, east, _, _ = fleet
    west.tell(record(**lost), HERE)
    west.tell(record(), None)
    west.end()
    arrived(east)
    (other,) = east.others(0.0, HERE)
    assert other.report is None
    assert other.ended


def test_what_comes_late_or_from_a_stranger_changes_nothing(fleet):
    west, east, _, ports = fleet
    west.tell(record(position=(1.0, 0.0, -5.0)), HERE)
    arrived(east)
    before = east.others(10.0, HERE)[0].report
    fields = {"name": "west", "stamp": 0.0, "latitude": 1, "longitude": 1, "altitude": 1}
    good = {**fields, "stamp": 1e12, "velocity": [0, 0, 0], "in_air": True}
    for wrong in (
        *(b"\xff", b"[]", b"{", {"report": 3}, {"report": {}}, {"ended": "north"}),
        *({"ended": ["west"]}, {"report": {**good, "name": "north"}}),
        {"report": {**good, "latitude": float("nan")}},
        {"report": {**good, "stamp": 0.0}},
    ):
        said(ports[1], wrong)
        arrived(east)
        (other,) = east.others(10.0, HERE)
        assert other.report.position == pytest.approx(before.position)
        assert not other.ended


def test_all_begin_when_whoever_started_them_says_so(fleet):
    west, east, monitor, ports = fleet
    west.ready()
    east.ready()
    assert select.select([monitor.socket], [], [], 10.0)[0]
    while monitor.ready != {"west", "east"}:
        monitor.listen()
    assert not west.started
    monitor.let_begin(ports)
    for link in (west, east):
        arrived(link)
        link.ready()
        assert link.started


def test_the_starter_counts_conflicts_by_what_is_reported(fleet):
    west, east, monitor, _ = fleet
    for place in (9.0, 4.0, 3.0, 9.0, 4.5, 12.0):
        for link, at in ((west, (0.0, 0.0, -5.0)), (east, (0.0, place, -5.0))):
            link.tell(record(at, velocity=(0.0, 0.0, 0.0)), HERE)
            assert select.select([monitor.socket], [], [], 10.0)[0]
            monitor.listen()
    (met,) = monitor.encounters()
    assert (met.first, met.second, met.conflicts) == ("west", "east", 2)
    assert met.least == pytest.approx(3.0, abs=0.01)
