import asyncio
import math
import threading
from types import SimpleNamespace

import numpy as np
import pytest
from pymavlink import mavutil
from vehicle.flying import free_port

from missionkit.geometry import from_euler, vec
from missionkit.messages import Action, Command, Estimate, Health, LandingTarget, Target
from missionkit.vehicle.adapter import MavsdkVehicle
from missionkit.vehicle.autopilot_dialect import (
    ARDUPILOT,
    BODY_FRD,
    LOCAL_NED,
    PX4,
)
from missionkit.vehicle.command.estimate_sharing import (
    SHARE_NOTHING,
    Share,
    Sharing,
    pose_fields,
    target_fields,
)
from missionkit.vehicle.link.connection import Link
from missionkit.vehicle.link.link_address import parse
from missionkit.vehicle.link.link_lock import LinkLock

START = vec(1.0, 2.0, 0.5)
STILL = Command()
BOTH = Share(pose=True, target="pad")


def seen(now=5.0, vision_at=5.0, seen_at=4.9, **health):
    trust = {"aligned": True, "diverged": False, "position_sd": 0.2, **health}
    return Estimate(
        now,
        vec(10.0, 0.0, -5.0),
        vec(0.0, 0.0, 0.0),
        from_euler(0.0, 0.0, math.pi / 2),
        vec(0.0, 0.0, 0.0),
        Health(gnss_at=None, vision_at=vision_at, rejected=0, **trust),
        targets={"pad": Target("pad", vec(11.0, 2.0, 0.0), 0.1, None, None, seen_at)},
    )


class Station:
    """Takes what is shared."""

    def __init__(self, share, frame=LOCAL_NED, start=START):
        self.sent = []
        self.sharing = Sharing(share, self.send, lambda: start, lambda at: at + 100.0, frame)

    def send(self, name, **fields):
        self.sent.append((name, fields))

    def tick(self, estimate, command=STILL):
        self.sharing(SimpleNamespace(estimate=estimate, command=command), None)
        return [name for name, _ in self.sent]


def test_the_pose_says_how_sure_the_height_is_and_how_often_the_position_was_reset():
    fields = pose_fields(seen(height_sd=0.5, resets=3), 0, START)
    assert [fields["covariance"][n] for n in (0, 6, 11)] == pytest.approx([0.04, 0.04, 0.25])
    assert fields["reset_counter"] == 3
    assert pose_fields(seen(resets=256 + 7), 0, START)["reset_counter"] == 7
    assert pose_fields(seen(), 0, START)["covariance"][11] == pytest.approx(0.04)


def test_nothing_is_shared_unless_wanted():
    assert Station(SHARE_NOTHING).tick(seen()) == []


def test_both_messages_carry_the_time_of_their_data():
    station = Station(BOTH)
    assert station.tick(seen()) == ["VISION_POSITION_ESTIMATE", "LANDING_TARGET"]
    assert station.sent[0][1]["usec"] == 105_000_000
    assert station.sent[1][1]["time_usec"] == 104_900_000


@pytest.mark.parametrize(
    "blind",
    [
        {"vision_at": None},
        {"vision_at": 4.4},
        {"aligned": False},
        {"diverged": True},
        {"position_sd": math.nan},
    ],
)
def test_a_pose_that_vision_does_not_carry_stays_at_home(blind):
    assert Station(Share(pose=True)).tick(seen(**blind)) == []


def test_a_target_goes_out_once_each_time_it_is_seen():
    station = Station(Share(target="pad"))
    station.tick(seen())
    assert len(station.tick(seen(now=5.05))) == 1
    assert len(station.tick(seen(now=5.1, seen_at=5.08))) == 2
    assert Station(Share(target="pad")).tick(seen(seen_at=None)) == []
    assert Station(Share(target="tree")).tick(seen()) == []


@pytest.mark.parametrize("frame", [LOCAL_NED, BODY_FRD])
def test_the_pad_of_a_precision_landing_goes_out_at_every_tick(frame):
    station = Station(SHARE_NOTHING, frame)
    pad = LandingTarget("pad", vec(1.0, 2.0, 5.0))
    landing = Command(action=Action.PRECISION_LAND, landing_target=pad)
    for n in range(3):
        station.tick(seen(now=5.0 + 0.05 * n), landing)
    station.tick(seen(now=5.15), landing._replace(landing_target=None))
    assert [name for name, _ in station.sent] == ["LANDING_TARGET"] * 3
    fields = station.sent[-1][1]
    assert fields["time_usec"] == 105_100_000
    place = vec(12.0, 4.0, 0.5) if frame == LOCAL_NED else vec(2.0, -1.0, 5.0)  # it heads east
    assert [fields[axis] for axis in "xyz"] == pytest.approx(place)


def test_without_an_origin_nothing_can_be_placed():
    assert Station(BOTH, start=None).tick(seen()) == []


def test_nan_and_infinity_are_never_sent():
    broken = seen()._replace(position=vec(math.nan, 0.0, 0.0))
    assert "VISION_POSITION_ESTIMATE" not in Station(BOTH).tick(broken)


def test_the_pose_is_of_the_autopilots_frame_and_says_how_sure_it_is():
    fields = pose_fields(seen(), 7, START)
    assert (fields["x"], fields["y"], fields["z"]) == (11.0, 2.0, -4.5)
    assert fields["yaw"] == pytest.approx(math.pi / 2)
    assert [fields["covariance"][n] for n in (0, 1, 6, 11, 20)] == pytest.approx(
        [0.04, 0.0, 0.04, 0.04, 0.0]
    )


def test_the_target_is_where_the_dialect_wants_it():
    estimate = seen()
    target = estimate.targets["pad"]  # from the vehicle: 1 m north, 2 m east, 5 m down
    px4 = target_fields(target, estimate, 7, START, PX4.target_frame)
    ardupilot = target_fields(target, estimate, 7, START, ARDUPILOT.target_frame)
    assert (px4["frame"], ardupilot["frame"]) == (LOCAL_NED, BODY_FRD)
    assert [px4[n] for n in "xyz"] == pytest.approx([12.0, 4.0, 0.5])
    assert [ardupilot[n] for n in "xyz"] == pytest.approx([2.0, -1.0, 5.0])
    for fields in (px4, ardupilot):
        assert -math.tan(fields["angle_y"]) == pytest.approx(0.4)
        assert math.tan(fields["angle_x"]) == pytest.approx(-0.2)
        assert fields["distance"] == pytest.approx(math.sqrt(30.0))


class Peer:
    """An autopilot that only beats its heart and listens, by pymavlink's own parser."""

    def __init__(self, port):
        self.line = mavutil.mavlink_connection(
            f"udpout:127.0.0.1:{port}", source_system=1, source_component=1, dialect="common"
        )
        self.heard, self.over = {}, threading.Event()
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def run(self):
        while not self.over.is_set():
            self.line.mav.heartbeat_send(2, 12, 1, 0, 3)
            message = self.line.recv_match(blocking=True, timeout=0.05)
            if message is not None:
                self.heard.setdefault(message.get_type(), message)

    def close(self):
        self.over.set()
        self.thread.join()
        self.line.close()


def test_both_messages_are_what_pymavlink_reads(tmp_path):
    port = free_port()
    address = parse(f"udpin://127.0.0.1:{port}")

    async def share(peer):
        link = await Link.open(address, 5.0)
        try:
            sharing = Sharing(BOTH, link.send, lambda: START, lambda at: at, LOCAL_NED)
            for n in range(200):
                if {"VISION_POSITION_ESTIMATE", "LANDING_TARGET"} <= set(peer.heard):
                    break
                ticked = seen(5.0 + n, 5.0 + n, 5.0 + n)
                sharing(SimpleNamespace(estimate=ticked, command=STILL), None)
                await asyncio.sleep(0.02)
        finally:
            link.close()

    peer = Peer(port)
    try:
        asyncio.run(share(peer))
    finally:
        peer.close()
    pose, target = peer.heard["VISION_POSITION_ESTIMATE"], peer.heard["LANDING_TARGET"]
    assert (pose.x, pose.y, pose.z) == (11.0, 2.0, -4.5)
    assert pose.covariance[0] == pytest.approx(0.04)
    assert (target.x, target.y, target.z) == (12.0, 4.0, 0.5)
    assert (target.frame, target.type, target.position_valid) == (1, 2, 1)
    assert np.isfinite([*pose.covariance, target.angle_x, target.angle_y, *target.q]).all()
    assert pose.get_srcComponent() == target.get_srcComponent()


def test_an_adapter_that_is_not_connected_shares_nothing(tmp_path):
    address = parse("udpin://127.0.0.1:14999")
    vehicle = MavsdkVehicle(address, lock=LinkLock(address, tmp_path), share=BOTH)
    vehicle.tell(SimpleNamespace(estimate=seen(), command=STILL), None)
