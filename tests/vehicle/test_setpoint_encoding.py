import math

import numpy as np
import pytest

from missionkit.geometry import from_euler, vec
from missionkit.messages import AttitudeSetpoint, PositionSetpoint, Setpoint
from missionkit.sitl.pymavlink_dialect import mavlink
from missionkit.vehicle.autopilot_dialect import PX4
from missionkit.vehicle.command.setpoint_encoding import leashed, message, sound
from missionkit.vehicle.command.setpoint_stream import (
    ZERO_VELOCITY,
    Streamer,
    TimedSetpoint,
    due,
)
from missionkit.vehicle.link.clocks import MissionClock
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.link.message_rates import QUEUED
from missionkit.vehicle.telemetry.autopilot_state import AutopilotState
from missionkit.vehicle.telemetry.observer import Observer

PLACE = PositionSetpoint(vec(3.0, -4.0, -5.0), 0.5)
LEAN = AttitudeSetpoint(from_euler(0.1, -0.2, 0.3), 0.4)
FAST = Setpoint(vec(2.0, 0.0, -1.0), 0.1)
START = vec(10.0, 20.0, 1.0)
NAN, INF = math.nan, math.inf


def numbers(fields):
    return np.hstack([np.ravel(value) for value in fields.values()]).astype(float)


def test_a_position_is_moved_to_the_autopilots_origin_and_nothing_else_counts():
    name, fields = message(PLACE, 1.0, START)
    assert name == "SET_POSITION_TARGET_LOCAL_NED"
    assert (fields["coordinate_frame"], fields["type_mask"]) == (1, 0x9F8)
    assert (fields["x"], fields["y"], fields["z"], fields["yaw"]) == (13.0, 16.0, -4.0, 0.5)
    assert fields["vx"] == fields["vy"] == fields["vz"] == fields["yaw_rate"] == 0.0


def test_an_attitude_goes_out_with_its_thrust():
    name, fields = message(LEAN, 1.0, START)
    assert (name, fields["type_mask"], fields["thrust"]) == ("SET_ATTITUDE_TARGET", 0x07, 0.4)
    assert fields["q"] == LEAN.attitude.tolist()


def test_a_velocity_does_not_depend_on_the_origin():
    _, fields = message(FAST, 1.0, START)
    assert fields["type_mask"] == 0x5C7
    assert (fields["vx"], fields["vz"], fields["yaw_rate"], fields["x"]) == (2.0, -1.0, 0.1, 0.0)


@pytest.mark.parametrize("setpoint", [PLACE, LEAN, FAST, ZERO_VELOCITY])
def test_every_field_is_one_of_the_message_and_finite(setpoint):
    name, fields = message(setpoint, 5e6, START)
    kind = getattr(mavlink, f"MAVLink_{name.lower()}_message")
    assert set(fields) <= set(kind.fieldnames)
    assert {"target_system", "target_component"} == set(kind.fieldnames) - set(fields) - {
        "thrust_body"
    }
    assert np.isfinite(numbers(fields)).all()


@pytest.mark.parametrize(
    "bad",
    [
        PositionSetpoint(vec(NAN, 0.0, 0.0), 0.0),
        PositionSetpoint(vec(0.0, 0.0, 0.0), INF),
        AttitudeSetpoint(LEAN.attitude * NAN, 0.5),
        AttitudeSetpoint(0.0 * LEAN.attitude, 0.5),
        AttitudeSetpoint(2.0 * LEAN.attitude, 0.5),
        AttitudeSetpoint(LEAN.attitude, NAN),
        AttitudeSetpoint(LEAN.attitude, 1.1),
        Setpoint(vec(0.0, -INF, 0.0), 0.0),
        Setpoint(vec(0.0, 0.0, 0.0), NAN),
    ],
)
def test_setpoints_that_cannot_be_flown_are_sent_as_zero_velocity(bad):
    sent = []
    streamer = Streamer(sent.append, lambda: True, lambda: 10.0)
    streamer.tell(bad, 10.0)
    streamer.once()
    assert not sound(bad)
    assert sent == [ZERO_VELOCITY]


@pytest.mark.parametrize("setpoint", [PLACE, LEAN])
@pytest.mark.parametrize(("age", "still"), [(0.49, False), (0.51, True), (1.49, True)])
def test_a_stale_one_becomes_zero_velocity_and_then_silence(setpoint, age, still):
    assert sound(setpoint)
    assert due(TimedSetpoint(setpoint, 10.0), 10.0 + age) is (ZERO_VELOCITY if still else setpoint)
    assert due(TimedSetpoint(setpoint, 10.0), 11.6) is None


def test_a_leash_gives_a_point_on_the_way_and_the_place_itself_when_near():
    here = vec(3.0, -4.0, 5.0)
    assert leashed(PLACE, here, None) is PLACE
    assert leashed(PLACE, here, 10.0) is PLACE
    near = leashed(PLACE, here, 2.0)
    assert near.position == pytest.approx([3.0, -4.0, 3.0])
    assert near.yaw == PLACE.yaw


def test_the_missions_origin_stays_where_home_was_first():
    cache = Cache(lambda: 0.0, QUEUED)
    observer = Observer(cache, AutopilotState(cache, PX4), MissionClock())
    assert observer.start is None
    home = {"latitude": 473977420, "longitude": 85455940, "altitude": 488000}
    cache.put("HOME_POSITION", {**home, "x": 1.0, "y": 2.0, "z": -0.5})
    observer.observe(0.0, None, ())
    assert observer.start == pytest.approx([1.0, 2.0, -0.5])
    moved = {**home, "altitude": 489000, "x": 1.0, "y": 2.0, "z": -1.5}
    cache.put("HOME_POSITION", moved)  # set again on arming, 1 m higher
    assert observer.start == pytest.approx([1.0, 2.0, -0.5])
