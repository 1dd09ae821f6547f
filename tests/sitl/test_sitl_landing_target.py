"""Precision landings of the simulated autopilot on LANDING_TARGET, in both dialects."""

from __future__ import annotations

import math

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missionkit.geometry import conjugate, rotate, vec

QUIET = True
PAD = vec(2.0, -1.5, 0.0)


def told(station, frame=None):
    """LANDING_TARGET of the pad as the dialect takes it, or in another frame."""
    body = station.state.body
    local = station.px4 if frame is None else frame == mavlink.MAV_FRAME_LOCAL_NED
    ray = rotate(conjugate(body.attitude), PAD - body.position)
    place = PAD if local else ray
    used = mavlink.MAV_FRAME_LOCAL_NED if local else mavlink.MAV_FRAME_BODY_FRD
    return mavlink.MAVLink_landing_target_message(
        0, 0, used, 0.0, 0.0, 0.0, 0.0, 0.0, *place, (1.0, 0.0, 0.0, 0.0), 2, 1
    )


def landed(station, make):
    """Land from 4 m, and return how far from the pad it stands (m)."""
    station.take_off(4.0)
    assert station.mode("PRECLAND" if station.px4 else "LAND") == 0
    station.until(lambda: station.state.body.on_ground, 60.0, make)
    return math.dist(station.state.body.truth.position[:2], PAD[:2])


def test_it_lands_on_the_pad(either):
    if not either.px4:
        either.state.parameters.set("PLND_ENABLED", 1)
    assert landed(either, lambda: told(either)) < 0.2


@pytest.mark.parametrize("why", ["nothing is heard", "another frame"])
def test_otherwise_it_lands_where_it_is(either, why):
    if not either.px4:
        either.state.parameters.set("PLND_ENABLED", 1)
    other = mavlink.MAV_FRAME_BODY_FRD if either.px4 else mavlink.MAV_FRAME_LOCAL_NED
    make = None if why == "nothing is heard" else lambda: told(either, other)
    assert landed(either, make) > 2.0
