from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from missionkit.messages import Action, Command, Setpoint
from missionkit.sim.world import Cylinder, Marker, Wind, World

Make = Callable[..., Any]
WORLD = World(
    world="windy",
    wind=Wind(mean=(1.0, 1.0, 0.0), gust=1.0),
    obstacles=(Cylinder(use="cylinder", at=(12.0, 0.0), radius=1.0, height=9.0),),
    markers=(Marker(dictionary="DICT_4X4_50", id=3, size=0.5, position=(10.9, 0.0, -3.0)),),
)


def tour(flight: Any) -> np.ndarray:
    flight.rise()
    flight.fly((1.0, 0.3, 0.0), 4.0, spin=0.1)
    flight.act(Action.LAND)
    flight.wait(4.0)
    return flight.vehicle.track.rows


def test_two_runs_are_identical_to_the_bit(pilot: Make) -> None:
    first, again = pilot(WORLD, use="corners"), pilot(WORLD, use="corners")
    assert np.array_equal(tour(first), tour(again))
    for one, two in zip(first.seen, again.seen, strict=True):
        assert [s.accel.tolist() for s in one.imu] == [s.accel.tolist() for s in two.imu]
        assert (one.baro, one.battery, one.status) == (two.baro, two.battery, two.status)
        assert repr(one.frame) == repr(two.frame)
    other = tour(pilot(WORLD, seed=2, use="corners"))
    assert not np.array_equal(first.vehicle.track.rows, other)


def test_the_camera_does_not_change_the_flight(pilot: Make) -> None:
    assert np.array_equal(tour(pilot(WORLD, use="corners")), tour(pilot(WORLD, use="none")))


def test_the_cutting_of_time_does_not_change_the_flight(pilot: Make) -> None:
    ends = []
    for parts in (20, 50, 200, 7):
        vehicle = pilot(WORLD).vehicle
        vehicle._plant.order(Action.ARM, None, ready=True)
        vehicle._plant.order(Action.TAKE_OFF, 4.0, ready=True)
        for n in range(1, parts + 1):
            vehicle.advance(2.8 * n / parts)
        ends.append((vehicle.truth.position.tolist(), vehicle.truth.attitude.tolist()))
    assert ends[0][0][2] < -1.0
    assert all(end == ends[0] for end in ends)


def test_rendered_camera_delivers_images_of_the_marker(perfect: World, pilot: Make) -> None:
    pytest.importorskip("missionkit.sim.camera_renderer")
    board = Marker(dictionary="DICT_4X4_50", id=3, size=0.6, position=(2.0, 0.0, 0.0))
    lens = {"width": 160, "height": 120, "focal": 140, "latency": 0.05}
    flight = pilot(perfect.model_copy(update={"markers": (board,)}), use="rendered", **lens)
    flight.wait(0.3)
    image = flight.seen[-1].frame.image
    assert image.shape == (120, 160)
    assert int(image.max()) - int(image.min()) > 100


def test_an_obstacle_ends_the_flight(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect.model_copy(update={"obstacles": WORLD.obstacles}))
    flight.rise()
    flight.fly((4.0, 0.0, 0.0), 6.0)
    truth = flight.vehicle.truth
    assert truth.crashed
    assert truth.on_ground
    assert truth.clearance <= 0.0
    assert truth.position[0] == pytest.approx(10.65, abs=0.2)
    flight.act(Action.ARM)
    assert flight.events == ["arm_refused"]


def test_clearance_is_from_the_vehicle_surface(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect.model_copy(update={"obstacles": WORLD.obstacles}))
    flight.wait(0.1)
    assert flight.vehicle.truth.clearance == pytest.approx(12.0 - 1.0 - 0.35)


def test_frames_are_late_and_at_the_rate_of_the_camera(pilot: Make) -> None:
    flight = pilot(WORLD, use="corners", rate=30.0, latency=0.06)
    flight.wait(5.0)
    frames = [(seen.now, seen.frame.at) for seen in flight.seen if seen.frame]
    ats = [at for _, at in frames]
    assert ats == sorted(set(ats))
    assert all(0.06 <= now - at + 1e-9 < 0.06 + 0.05 + 0.04 for now, at in frames)
    assert np.diff(ats).max() < 0.071


def test_status_follows_the_flight(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect)
    flight.rise()
    statuses = [s for seen in flight.seen if (s := seen.status)]
    assert np.diff([s.at for s in statuses]) == pytest.approx(0.2)
    assert [statuses[0].armed, statuses[0].in_air, statuses[0].ready] == [False, False, False]
    assert statuses[5].ready
    assert [statuses[-1].armed, statuses[-1].in_air, statuses[-1].mode] == [True, True, "hold"]
    assert "take_off" in {s.mode for s in statuses}


def test_setpoints_faster_than_the_link_still_arrive(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect)
    flight.rise()
    vehicle, now = flight.vehicle, flight.vehicle.now
    for n in range(1, 301):
        vehicle.advance(now + 0.01 * n)
        vehicle.apply(Command(setpoint=Setpoint(np.array([2.0, 0.0, 0.0]), 0.0)))
    assert vehicle.truth.velocity[0] == pytest.approx(2.0, abs=0.2)


def test_an_action_is_not_undone_by_an_older_setpoint(perfect: World, pilot: Make) -> None:
    flight = pilot(perfect)
    flight.rise()
    flight.fly((1.0, 0.0, 0.0), 1.0)
    flight.act(Action.HOLD)
    flight.wait(1.0)
    assert flight.vehicle.truth.mode == "hold"


def test_the_port_is_the_same_vehicle(perfect: World, pilot: Make) -> None:
    async def use() -> None:
        vehicle = pilot(perfect).vehicle
        await vehicle.connect()
        seen = await vehicle.observe(1.5)
        await vehicle.send(Command(action=Action.ARM, payload="injector"))
        await vehicle.observe(1.6)
        assert vehicle.truth.armed
        assert vehicle.payload == "injector"
        assert len(seen.imu) == 150
        await vehicle.close()

    asyncio.run(use())
