"""The vehicle: actions, safe ends, silence, faults, randomness, saving and putting back."""

from __future__ import annotations

import asyncio
import math

import numpy as np
import pytest
from docking import PERFECT, WORLD, Hand, changed, perfect
from rehearsed import plain

from missionkit.errors import UsageError, VehicleError
from missionkit.geometry import conjugate, log, multiply, norm
from missionkit.messages import Action, Command, Setpoint, Wrench
from missionkit.perception.camera_section import Camera
from missionkit.recorder import value_codec
from missionkit.sim.fault_injection import parse_fault
from missionkit.sim.free_flyer.docking_grading import grade_docking
from missionkit.sim.free_flyer.free_flyer import FreeFlyer
from missionkit.sim.simulated_vehicle import SimulatedVehicle
from missionkit.sim.vehicle_snapshot import restore, taken
from missionkit.sim.world import World


def docked(hand: Hand) -> Hand:
    """Arm, fly to the face by way of a place before it, and let the mechanism take hold."""
    hand.arm()
    hand.fly(hand.place(0.15), 60.0)
    hand.fly(hand.place(0.0), 20.0)
    hand.act(Action.DISARM)
    hand.wait(1.0)
    return hand


@pytest.mark.parametrize("face", ["top", "left"])
def test_it_docks_and_is_graded(face):
    hand = docked(Hand(changed(target={**WORLD.target.model_dump(), "face": face})))
    truth = hand.flyer.truth
    assert (truth.armed, truth.on_ground, truth.crashed) == (False, True, False)
    assert norm(truth.velocity) == norm(truth.rates) == 0.0
    grade = grade_docking(hand.flyer.track.rows, hand.flyer.world, hand.flyer.impulse)
    assert grade.docked
    assert grade.position_error < 0.002
    assert grade.attitude_error < 0.02
    assert grade.duration == pytest.approx(80.1, abs=0.2)
    assert grade.separation > 0.0
    assert grade.keep_out_time == 0.0
    assert grade.impulse == hand.flyer.impulse > 0.05
    status = [seen.status for seen in hand.seen if seen.status is not None]
    assert (status[-1].armed, status[-1].in_air) == (False, False)
    assert {it.mode for it in status} == {"hold", "offboard"}


def test_thrusters_are_switched_off_in_a_safe_end_alone():
    hand = Hand(perfect())
    hand.arm()
    hand.push((0.01, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0)  # 7.5 mm/s
    hand.act(Action.DISARM)
    assert hand.flyer.truth.armed
    hand.push((-0.01, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0)
    hand.push((0.0, 0.0, 0.0), (1e-5, 0.0, 0.0), 1.0)  # 0.26 deg/s
    hand.act(Action.DISARM)
    assert hand.flyer.truth.armed
    hand.push((0.0, 0.0, 0.0), (-1e-5, 0.0, 0.0), 1.0)
    hand.act(Action.DISARM)
    hand.wait(0.1)
    assert not hand.flyer.truth.armed
    assert hand.events == ["disarm_refused", "disarm_refused"]
    grade = grade_docking(hand.flyer.track.rows, hand.flyer.world, hand.flyer.impulse)
    assert grade.safe
    assert not grade.docked


def test_within_the_keep_out_sphere_it_is_not_clear():
    hand = Hand(perfect(keep_out=0.5))
    hand.arm()
    hand.fly(hand.place(0.2), 60.0)
    hand.act(Action.DISARM)
    hand.wait(0.1)
    assert hand.flyer.truth.armed
    assert hand.events == ["disarm_refused"]


def test_silence_stops_the_thrust_and_it_drifts():
    hand = Hand(perfect())
    hand.arm()
    hand.flyer.apply(Command(setpoint=Wrench(np.array([0.01, 0, 0]), np.zeros(3))))
    hand.wait(3.0)
    assert hand.flyer.truth.velocity[0] == pytest.approx(0.01 / 1.33 * 0.505, rel=1e-3)
    assert hand.flyer.truth.mode == "hold"


@pytest.mark.parametrize("quiet", [Command(), Command(action=Action.HOLD)])
def test_without_a_wrench_it_stops_thrusting(quiet):
    hand = Hand(perfect())
    hand.arm()
    hand.push((0.01, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0)
    speed = hand.flyer.truth.velocity[0]
    hand.wait(0.3, lambda: quiet)
    assert hand.flyer.truth.velocity[0] == pytest.approx(speed, rel=0.11)
    assert hand.flyer.truth.mode == "hold"


def test_nothing_moves_before_it_is_armed():
    hand = Hand(perfect())
    hand.act(Action.ARM)  # its sensors have not settled
    hand.push((0.1, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0)
    assert norm(hand.flyer.truth.velocity) == 0.0
    assert hand.events == ["arm_refused"]


@pytest.mark.parametrize("action", [Action.TAKE_OFF, Action.RETURN])
def test_what_it_cannot_do_is_refused(action):
    hand = Hand(perfect())
    hand.arm()
    hand.act(action)
    hand.wait(0.1)
    assert hand.events == [f"{action}_refused"]


def test_setpoints_of_other_vehicles_are_refused():
    flyer = FreeFlyer(WORLD, 1)
    with pytest.raises(VehicleError, match="flies a wrench, not a Setpoint"):
        flyer.apply(Command(setpoint=Setpoint(np.zeros(3), 0.0)))
    with pytest.raises(VehicleError, match="not finite"):
        flyer.apply(Command(setpoint=Wrench(np.array([0.0, np.nan, 0.0]), np.zeros(3))))


def test_it_is_a_vehicle_of_the_port():
    async def session() -> float:
        flyer = FreeFlyer(WORLD, 1)
        await flyer.connect()
        await flyer.send(Command(action=Action.ARM))
        seen = await flyer.observe(0.5)
        await flyer.close()
        return seen.now

    assert asyncio.run(session()) == 0.5


def tour(hand: Hand) -> np.ndarray:
    hand.arm()
    hand.fly((0.7, 1.7, 0.9), 15.0, speed=0.1)
    return hand.flyer.track.rows


def test_two_runs_are_identical_to_the_bit():
    first, again, other = Hand(WORLD), Hand(WORLD), Hand(WORLD, seed=2)
    assert np.array_equal(tour(first), tour(again))
    assert [plain(it) for it in first.seen] == [plain(it) for it in again.seen]
    assert not np.array_equal(first.flyer.track.rows, tour(other))


def test_the_start_is_drawn_around_its_place():
    world = changed(start={**WORLD.start.model_dump(), "position_sd": 0.1, "attitude_sd_deg": 5.0})
    truths = [FreeFlyer(world, seed).truth for seed in range(300)]
    places = np.array([it.position for it in truths])
    assert places.mean(axis=0) == pytest.approx([0.0, 1.0, 0.0], abs=0.025)
    assert places.std(axis=0) == pytest.approx([0.1] * 3, rel=0.15)
    turns = np.array([log(it.attitude) for it in truths])
    assert np.degrees(turns.std(axis=0)) == pytest.approx([5.0] * 3, rel=0.15)


def test_a_sensor_that_fails_leaves_the_others_as_they_were():
    plainly, without = Hand(WORLD), Hand(WORLD, "uwb_lost@3+2", "gyro_biased=0.02@4")
    for hand in (plainly, without):
        hand.wait(6.0)
    ranges = {it.at: it.distance for seen in plainly.seen for it in seen.ranges}
    heard = {it.at: it.distance for seen in without.seen for it in seen.ranges}
    lost = [at for at in ranges if at not in heard]
    assert lost == pytest.approx([3.0 + 0.02 * n for n in range(1, 101)])
    assert all(ranges[at] == heard[at] for at in heard)
    rates = [np.array([it.gyro for s in h.seen for it in s.imu]) for h in (plainly, without)]
    off = rates[1] - rates[0]
    assert np.abs(off[:400]).max() == 0.0
    assert off[400:] == pytest.approx(np.tile([0.02, 0.0, 0.0], (200, 1)))


@pytest.mark.parametrize(("fault", "share"), [((), 0.02), (("uwb_outliers=0.3",), 0.3)])
def test_ranges_have_their_noise_and_outliers(fault, share):
    start = {"position": (0.0, 1.0, 0.0)}
    hand = Hand(changed(start=start), *fault)
    exact = Hand(perfect(start=start))
    for it in (hand, exact):
        it.wait(60.0)
    errors = np.array(
        [
            a.distance - b.distance
            for seen, true in zip(hand.seen, exact.seen, strict=True)
            for a, b in zip(seen.ranges, true.ranges, strict=True)
        ]
    )
    far = errors > 0.08
    long = math.erfc(0.08 / 0.5 / math.sqrt(2.0))  # share of the detours that are above 8 cm
    assert far.mean() == pytest.approx(long * share, rel=0.25)
    assert errors.min() > -0.08
    assert errors[np.abs(errors) < 0.06].std() == pytest.approx(0.02, rel=0.1)


def test_the_inertial_unit_has_the_data_sheet_s_noise():
    hand = Hand(changed(sensors={"accelerometer": {"bias": 0.0}, "gyro": {"bias": 0.0}}))
    hand.wait(30.0)
    samples = [it for seen in hand.seen for it in seen.imu]
    gyro, accel = (np.array([getattr(it, key) for it in samples]) for key in ("gyro", "accel"))
    assert gyro.std() == pytest.approx(6.1e-5 * 10.0, rel=0.05)
    assert accel.std() == pytest.approx(1.4e-3 * 10.0, rel=0.05)
    assert np.abs(gyro.mean(axis=0)).max() < 4.0 * gyro.std() / math.sqrt(len(gyro))


def test_nozzles_fail_by_name():
    speeds = {}
    for fault in ((), ("nozzle_weak=0.25",), ("nozzle_stuck=1",), ("nozzle_stuck=6",)):
        hand = Hand(perfect(), *fault)
        hand.arm()
        hand.push((-0.01, 0.0, 0.0), (0.0, 0.0, 0.0), 1.0)  # by the middle of the front, nozzle 1
        speeds[fault] = float(hand.flyer.truth.velocity[0])
    assert speeds[()] == pytest.approx(-0.01 / 1.33)
    assert speeds["nozzle_weak=0.25",] == pytest.approx(-0.0025 / 1.33)
    assert speeds["nozzle_stuck=1",] == 0.0
    assert speeds["nozzle_stuck=6",] == speeds[()]


def test_faults_of_another_vehicle_are_refused():
    with pytest.raises(UsageError, match="a free flyer has no fault 'gnss_lost'"):
        FreeFlyer(WORLD, 1, (parse_fault("gnss_lost"),))
    with pytest.raises(UsageError, match="a multicopter has no fault 'uwb_lost'"):
        SimulatedVehicle(World(world="w"), Camera(use="none"), 1, (parse_fault("uwb_lost"),))
    with pytest.raises(UsageError, match=r"nozzle_stuck takes a whole number, got 1\.5"):
        parse_fault("nozzle_stuck=1.5")
    with pytest.raises(UsageError, match="nozzle_stuck takes 1 to 10, got 11"):
        parse_fault("nozzle_stuck=11")


@pytest.mark.parametrize("at", [10, 31, 130])
def test_a_restored_vehicle_flies_on_bit_by_bit(at):
    faults = ("camera_frozen@4+1", "uwb_outliers@flying:1+2", "battery_sag=0.1@3")

    def flown(flyer: FreeFlyer, first: int, last: int) -> list[object]:
        seen: list[object] = []
        for n in range(first, last):
            seen.append(plain(flyer.advance(0.05 * n)))
            if n == 30:
                flyer.apply(Command(action=Action.ARM))
            elif n > 30:
                flyer.entered("flying", 0.05 * n)
                push = Wrench(np.array([0.01, 0.002, 0.0]), np.array([0.0, 1e-5, 0.0]))
                flyer.apply(Command(push, payload="camera"))
        return [*seen, plain(flyer.truth), flyer.impulse]

    def built() -> FreeFlyer:
        start = {"position": (1.0, 1.5, 1.0), "attitude_deg": (-90.0, 0.0, -90.0)}
        return FreeFlyer(changed(start=start), 5, tuple(map(parse_fault, faults)))

    flyer, other = built(), built()
    flown(flyer, 1, at)
    saved = value_codec.written(taken(flyer))
    rows = flyer.track.rows.copy()
    restore(other, value_codec.read(saved))
    other.track.restore(rows)
    assert flown(other, at, 180) == flown(flyer, at, 180)
    assert plain(other.track.rows) == plain(flyer.track.rows)


def test_the_cutting_of_time_does_not_change_the_flight():
    ends = []
    for parts in (20, 50, 7):
        flyer = FreeFlyer(WORLD, 1)
        flyer.advance(1.5)
        flyer.apply(Command(action=Action.ARM))
        flyer.apply(Command(setpoint=Wrench(np.array([0.02, 0, 0.01]), np.array([1e-4, 0, 0]))))
        ranges = [
            it for n in range(1, parts + 1) for it in flyer.advance(1.5 + 2.8 * n / parts).ranges
        ]
        ends.append((flyer.truth.position.tolist(), flyer.truth.attitude.tolist(), ranges))
    assert all(end == ends[0] for end in ends)
    assert norm(multiply(conjugate(np.array(ends[0][1])), FreeFlyer(WORLD, 1).truth.attitude)[1:])


def test_perfect_sensors_are_perfect():
    hand = Hand(perfect())
    hand.arm()
    hand.push((0.013, 0.0, -0.02), (0.0, 2e-4, 0.0), 1.0)
    assert hand.seen[-1].imu[-1].accel == pytest.approx([0.013 / 1.33, 0.0, -0.02 / 1.33])
    assert hand.seen[-1].imu[-1].gyro[1] == pytest.approx(2e-4 / 0.0022 * 0.995)
    assert PERFECT.gyro.noise == 0.0
