"""Setpoints of a connected vehicle as they go out, without a wire."""

import numpy as np
import pytest

from missionkit.geometry import vec
from missionkit.messages import PositionSetpoint
from missionkit.vehicle.autopilot_dialect import ARDUPILOT, PX4
from missionkit.vehicle.connected_vehicle import ConnectedVehicle
from missionkit.vehicle.link.clocks import MissionClock, wall
from missionkit.vehicle.link.link_lifecycle import LinkLifecycle
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.link.message_check import MessageCheck
from missionkit.vehicle.link.message_rates import QUEUED
from missionkit.vehicle.telemetry.observer import Datum, Origin

BERN = {"latitude": 469480000, "longitude": 74474000, "altitude": 540000}
HOME = {**BERN, "x": 100.0, "y": -40.0, "z": 0.0}  # in the autopilot's local frame
FAR = PositionSetpoint(vec(50.0, 0.0, -5.0), 0.3)


class Wire:
    """A link that remembers what was sent."""

    def __init__(self):
        self.sent = []

    def send(self, name, **fields):
        self.sent.append((name, fields))


def connected(dialect):
    wire, cache = Wire(), Cache(wall, QUEUED)
    check = MessageCheck(cache, lambda _: None, lambda _: None)
    vehicle = ConnectedVehicle(
        wire,
        LinkLifecycle(),
        dialect,
        cache,
        MissionClock(),
        lambda _: None,
        lambda _: None,
        check,
        1.0,
    )
    vehicle.observer.settle(Datum(Origin(46.948, 7.4474, 540.0)))
    return vehicle, wire, cache


@pytest.mark.parametrize(
    ("dialect", "sent"), [(ARDUPILOT, (112.0, -40.0, -5.0)), (PX4, (150.0, -40.0, -5.0))]
)
def test_a_position_is_sent_in_the_autopilots_frame_and_within_its_leash(dialect, sent):
    vehicle, wire, cache = connected(dialect)
    cache.put("HOME_POSITION", HOME)
    cache.put("LOCAL_POSITION_NED", {"x": 110.0, "y": -40.0, "z": -5.0})
    vehicle._emit(FAR)
    ((_, fields),) = wire.sent
    np.testing.assert_allclose([fields[axis] for axis in "xyz"], sent, atol=1e-3)


@pytest.mark.parametrize("name", ["HOME_POSITION", "LOCAL_POSITION_NED"])
def test_a_position_that_cannot_be_placed_is_sent_as_standing_still(name):
    vehicle, wire, cache = connected(ARDUPILOT)
    cache.put(name, {**HOME, "x": 110.0, "y": -40.0, "z": -5.0})
    vehicle._emit(FAR)
    ((_, fields),) = wire.sent
    assert [fields[axis] for axis in ("vx", "vy", "vz", "yaw_rate")] == [0.0] * 4
    assert fields["type_mask"] == 0x5C7
