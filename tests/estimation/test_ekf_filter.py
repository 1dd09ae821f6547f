"""The navigator over whole flights: faults, recovery, purity."""

from __future__ import annotations

import dataclasses
import math
import pickle

import numpy as np
import pytest
from flights import MOUNT, TICK, TRUNK, Flight, attitude, position, sighting, velocity

from missionkit.estimation.builder import build
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.geometry import Transform, conjugate, exp, log, multiply, vec
from missionkit.messages import Observation, VehicleStatus

SETTINGS = VisualInertialEkf(fix_drift_sd=0.0, mag_sd=0.05)
SURVEY = TRUNK.translation + vec(0.6, -0.5, 0.4)


def navigator(**changes):
    settings = SETTINGS.model_copy(update=changes)
    return build(settings, {"trunk": (SURVEY, 1.0)}, MOUNT)


def fly(nav, until, *, since=0.0, memory=None, change=lambda o: o, seen=None, seed=0):
    """Fly from `since` to `until` (s); `seen(flight, t)` gives the sighting of each tick."""
    flight = Flight(np.random.default_rng(seed), SETTINGS)
    memory = memory or nav.begin()
    for n in range(round(since / TICK) + 1, round(until / TICK) + 1):
        memory = nav.propagate(memory, change(flight.tick(n)))
        if seen is not None:
            memory = nav.fuse(memory, (seen(flight, n * TICK - 0.08),))
    return memory


def look(flight, t):
    return flight.sighting(t)


def jumped(offset):
    """A satellite receiver whose position is off by `offset`, but not its velocity."""
    return lambda o: (
        o
        if o.gnss is None
        else dataclasses.replace(o, gnss=o.gnss._replace(position=o.gnss.position + offset))
    )


def without(*names):
    return lambda o: dataclasses.replace(o, **dict.fromkeys(names))


def off_by(state, t):
    return float(np.linalg.norm(state.position - position(t)))


@pytest.fixture(scope="module")
def flown():
    """Ten seconds with everything in order, the last four with the target in view."""
    nav = navigator()
    return nav, fly(nav, 10.0, since=6.0, memory=fly(nav, 6.0), seen=look)


def test_a_good_flight(flown):
    nav, memory = flown
    state = nav.read(memory)
    assert state.health.aligned
    assert not state.health.diverged
    assert state.health.rejected == 0
    assert state.health.gnss_at == pytest.approx(9.9)
    assert state.health.vision_at == pytest.approx(9.92)
    assert off_by(state, 10.0) < 3.5 * state.health.position_sd
    np.testing.assert_allclose(state.velocity, velocity(10.0), atol=0.15)
    trunk = state.targets["trunk"]
    relative = trunk.position - state.position - (TRUNK.translation - position(10.0))
    assert trunk.position_sd < 0.15
    assert np.linalg.norm(relative) < 4 * trunk.position_sd
    assert trunk.seen_at == pytest.approx(9.92)
    turn = log(multiply(conjugate(trunk.attitude), TRUNK.rotation))
    assert np.linalg.norm(turn) < 4 * trunk.angle_sd < 0.1


def test_relative_certainty_exceeds_absolute_certainty():
    """Without satellites the place of the pair is unknown, yet each knows where the other is."""
    nav = navigator()
    memory = fly(nav, 14.0, change=without("gnss"), seen=look)
    state = nav.read(memory)
    assert state.targets["trunk"].position_sd < 0.2 < state.health.position_sd


def test_a_landmark_bounds_the_drift_without_satellites():
    nav = navigator()
    start = fly(nav, 8.0, seen=look)
    blind = fly(nav, 30.0, since=8.0, memory=start, change=without("gnss"))
    sighted = fly(nav, 30.0, since=8.0, memory=start, change=without("gnss"), seen=look)
    assert off_by(nav.read(sighted), 30.0) < 0.5
    assert nav.read(blind).health.position_sd > 4 * nav.read(sighted).health.position_sd


def test_memory_is_never_changed_and_can_be_saved(flown):
    nav, memory = flown
    saved = pickle.dumps(memory)
    flight = Flight(np.random.default_rng(9), SETTINGS)
    one = nav.fuse(nav.propagate(memory, flight.tick(201)), (flight.sighting(9.95),))
    assert pickle.dumps(memory) == saved
    flight = Flight(np.random.default_rng(9), SETTINGS)
    two = nav.propagate(pickle.loads(saved), flight.tick(201))  # noqa: S301
    two = nav.fuse(two, (flight.sighting(9.95),))
    np.testing.assert_array_equal(one.past.Ps, two.past.Ps)
    nav.read(memory).position[:] = 99.0
    nav.read(memory).targets["trunk"].position[:] = 99.0
    assert pickle.dumps(memory) == saved


def test_frames_agree_with_pose_at(flown):
    nav, memory = flown
    tree = nav.frames(memory)
    found, expected = tree.lookup("world", "base", 9.873), nav.pose_at(memory, 9.873)
    np.testing.assert_allclose(found.translation, expected.translation, atol=1e-12)
    np.testing.assert_allclose(expected.translation, position(9.873), atol=0.3)
    turn = log(multiply(conjugate(expected.rotation), attitude(9.873)))
    assert np.linalg.norm(turn) < 0.05


BAD = [np.nan, np.inf, -np.inf, 1e300]


@pytest.mark.parametrize("bad", BAD)
def test_numbers_that_are_not_finite_are_refused(flown, bad):
    nav, memory = flown
    flight = Flight(np.random.default_rng(3), SETTINGS)
    o = flight.tick(204)
    v = vec(bad, 0, 0)
    spoilt = Observation(
        o.now,
        imu=(o.imu[0]._replace(accel=v), o.imu[1]._replace(gyro=v), o.imu[2]._replace(at=bad)),
        gnss=o.gnss._replace(position=v, velocity=v),
        baro=flight.baro(o.now)._replace(height=bad),
        mag=o.mag._replace(field=v),
    )
    after = nav.propagate(memory, spoilt)
    seen = flight.sighting(10.1)
    turn = Transform(np.full(4, bad), seen.pose.translation)
    for pose in (Transform(seen.pose.rotation, v), turn):
        after = nav.fuse(after, (seen._replace(pose=pose),))
    after = nav.fuse(after, (seen._replace(position_sd=bad), seen._replace(angle_sd=bad)))
    state = nav.read(nav.propagate(after, flight.tick(205)))
    assert state.health.rejected >= 1
    flat = [state.position, state.velocity, state.attitude, state.rates, state.covariance]
    assert all(np.isfinite(part).all() for part in flat)
    assert off_by(state, 10.25) < 1.0


@pytest.mark.parametrize("bad", BAD)
def test_bad_numbers_do_not_spoil_the_alignment(bad):
    nav = navigator()
    v = vec(0, bad, 0)

    def spoil(o):
        if round(o.now / TICK) % 8:
            return o
        return dataclasses.replace(
            o,
            imu=(o.imu[0]._replace(accel=v), *o.imu[1:]),
            gnss=None if o.gnss is None else o.gnss._replace(position_sd=v),
            mag=None if o.mag is None else o.mag._replace(field=v),
        )

    state = nav.read(fly(nav, 3.0, change=spoil))
    assert state.health.aligned
    assert off_by(state, 3.0) < 1.5


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_measurement_without_a_time_is_refused(flown, bad):
    nav, memory = flown
    flight = Flight(np.random.default_rng(3), SETTINGS)
    o = flight.tick(201)
    after = nav.propagate(memory, dataclasses.replace(o, baro=o.baro._replace(at=bad)))
    assert nav.read(after).health.rejected == 1
    np.testing.assert_allclose(nav.read(after).position, position(10.05), atol=0.5)


def test_one_wild_fix_is_refused(flown):
    nav, memory = flown
    before = nav.read(memory)
    after = fly(nav, 10.2, since=10.0, memory=memory, change=jumped(vec(30, 0, 0)))
    state = nav.read(after)
    assert state.health.rejected == 1
    assert state.health.gnss_at == before.health.gnss_at
    assert off_by(state, 10.2) < 0.5


def standing(change=lambda o: o, *, armed=False, in_air=False):
    """The autopilot says that the vehicle stands on the ground, or does not."""
    return lambda o: dataclasses.replace(
        change(o), status=VehicleStatus(o.now, armed=armed, in_air=in_air, ready=True, mode="hold")
    )


@pytest.mark.parametrize("states", [None, (True, True), (True, False)])
def test_a_lasting_jump_is_a_lost_position_until_it_ends(states):
    """In the air, armed, or where nothing is said of it, fixes that jumped are never believed."""
    nav, change = navigator(), jumped(vec(0, 20, 0))
    if states is not None:
        change = standing(change, armed=states[0], in_air=states[1])
    memory = fly(nav, 8.0)
    memory = fly(nav, 12.6, since=8.0, memory=memory, change=change)
    assert not nav.read(memory).health.diverged
    memory = fly(nav, 14.0, since=12.6, memory=memory, change=change)
    assert nav.read(memory).health.diverged
    assert nav.read(memory).health.cause == "GNSS jumped 20 m"
    memory = fly(nav, 45.0, since=14.0, memory=memory, change=change)
    held = nav.read(memory)
    assert off_by(held, 45.0) < 2.0
    assert held.health.diverged
    assert held.health.cause.startswith("GNSS jumped ")
    assert held.health.resets == 0
    np.testing.assert_array_equal(held.correction, 0)
    memory = fly(nav, 46.0, since=45.0, memory=memory)
    after = nav.read(memory)
    assert (after.health.diverged, after.health.cause, after.health.rejected) == (False, "", 0)
    assert off_by(after, 46.0) < 1.0


def test_on_the_ground_a_jump_is_waited_out_then_accepted():
    """8 m for good: refused for five seconds, then the position moves and world <- odom says so."""
    nav = navigator()
    jump = vec(0, 8, 0)
    change = standing(jumped(jump))
    memory = fly(nav, 8.0)
    memory = fly(nav, 12.6, since=8.0, memory=memory, change=change)
    held = nav.read(memory)
    assert off_by(held, 12.6) < 1.0
    assert not held.health.diverged
    assert held.health.resets == 0
    np.testing.assert_array_equal(held.correction, 0)
    flight, n = Flight(np.random.default_rng(0), SETTINGS), round(12.6 / TICK)
    while nav.read(memory).health.resets == 0:
        n += 1
        memory = nav.propagate(memory, change(flight.tick(n)))
    reset = nav.read(memory).health
    assert reset.rejected == 0  # the fix that was refused before counts as accepted at once
    assert reset.gnss_at == pytest.approx(n * TICK, abs=2 * TICK)
    memory = fly(nav, 16.0, since=n * TICK, memory=memory, change=change)
    state = nav.read(memory)
    assert np.linalg.norm(state.position - position(16.0) - jump) < 1.0
    np.testing.assert_allclose(state.correction, jump, atol=1.5)
    assert state.health.rejected == 0
    assert state.health.resets == 1
    assert state.health.height_sd == pytest.approx(np.sqrt(state.covariance[2, 2]))
    assert not state.health.diverged
    np.testing.assert_allclose(state.velocity, velocity(16.0), atol=0.3)
    tree = nav.frames(memory)
    assert np.linalg.norm(tree.lookup("odom", "base", 15.9).translation - position(15.9)) < 1.5


@pytest.mark.parametrize("seed", [0, 1])
def test_after_an_outage_fixes_are_weighted_by_the_filters_uncertainty(seed):
    nav = navigator()
    memory = fly(nav, 8.0, seed=seed)
    memory = fly(nav, 40.0, since=8.0, memory=memory, change=without("gnss"), seed=seed)
    blind = nav.read(memory)
    assert blind.health.position_sd > 1.0
    memory = fly(nav, 41.0, since=40.0, memory=memory, seed=seed)
    state = nav.read(memory)
    assert (state.health.rejected, state.health.resets) == (0, 0)
    assert not state.health.diverged
    assert off_by(state, 41.0) < 1.5


def test_fixes_stamped_just_after_the_newest_inertial_sample_are_accepted():
    """They wait for the sample that reaches their time, which comes with a later observation."""
    nav, jump = navigator(), vec(0, 8, 0)
    change = standing(jumped(jump))
    flight = Flight(np.random.default_rng(0), SETTINGS)
    memory = nav.begin()
    for n in range(1, round(16.0 / TICK) + 1):
        seen = flight.tick(n, delay=-0.004)
        memory = nav.propagate(memory, seen if n * TICK < 8.0 else change(seen))
    state = nav.read(memory)
    assert np.linalg.norm(state.position - position(16.0) - jump) < 1.0
    assert state.health.rejected == 0


def velocity_known(*axes):
    """A receiver that knows its velocity along some axes only."""

    def change(o):
        if o.gnss is None:
            return o
        if not axes:
            return dataclasses.replace(o, gnss=o.gnss._replace(velocity=None))
        said, sd = vec(0, 0, 0), np.full(3, np.inf)
        for axis in axes:
            said[axis], sd[axis] = o.gnss.velocity[axis], o.gnss.velocity_sd
        return dataclasses.replace(o, gnss=o.gnss._replace(velocity=said, velocity_sd=sd))

    return change


@pytest.mark.parametrize("axes", [(), (0, 1)])
def test_a_fix_with_part_of_the_velocity_still_holds_the_position(axes):
    nav = navigator()
    state = nav.read(fly(nav, 20.0, change=velocity_known(*axes)))
    assert state.health.rejected == 0
    assert state.health.gnss_at == pytest.approx(19.9)
    assert off_by(state, 20.0) < 1.0
    np.testing.assert_allclose(state.velocity, velocity(20.0), atol=0.4)


def test_on_the_ground_a_jump_is_accepted_without_a_velocity_too():
    nav, jump = navigator(), vec(0, 8, 0)
    silent = velocity_known()
    change = standing(lambda o: silent(jumped(jump)(o)))
    memory = fly(nav, 8.0, change=silent)
    memory = fly(nav, 18.0, since=8.0, memory=memory, change=change)
    assert np.linalg.norm(nav.read(memory).position - position(18.0) - jump) < 1.5


def test_it_is_placed_while_fixes_or_sightings_are_accepted(flown):
    nav, memory = flown
    assert nav.read(memory).health.placed
    blind = fly(nav, 14.0, since=10.0, memory=memory, change=without("gnss"))
    assert not nav.read(blind).health.placed
    sighted = fly(nav, 14.0, since=10.0, memory=memory, change=without("gnss"), seen=look)
    assert nav.read(sighted).health.placed


def test_while_the_target_is_in_view_a_jump_is_never_accepted():
    nav = navigator()
    memory = fly(nav, 8.0, seen=look)
    memory = fly(nav, 16.0, since=8.0, memory=memory, change=jumped(vec(0, 8, 0)), seen=look)
    state = nav.read(memory)
    assert off_by(state, 16.0) < 1.0
    assert not state.health.diverged
    assert state.health.rejected > 30


def test_a_reset_takes_a_target_seen_before_along():
    nav = navigator()
    memory = fly(nav, 8.0, seen=look)
    memory = fly(nav, 16.0, since=8.0, memory=memory, change=standing(jumped(vec(0, 8, 0))))
    state = nav.read(memory)
    trunk = state.targets["trunk"]
    assert np.linalg.norm(state.position - position(16.0) - vec(0, 8, 0)) < 1.0
    gap = trunk.position - state.position - (TRUNK.translation - position(16.0))
    assert np.linalg.norm(gap) < 4 * trunk.position_sd < 2.0


def test_a_reset_leaves_a_target_never_seen_where_it_was_surveyed():
    nav = navigator()
    memory = fly(nav, 8.0)
    memory = fly(nav, 16.0, since=8.0, memory=memory, change=standing(jumped(vec(0, 8, 0))))
    np.testing.assert_array_equal(nav.read(memory).targets["trunk"].position, SURVEY)


def test_fixes_that_contradict_each_other_end_in_divergence():
    nav = navigator()
    rng = np.random.default_rng(8)

    def scatter(o):
        return jumped(60.0 * rng.standard_normal(3))(o)

    memory = fly(nav, 8.0)
    memory = fly(nav, 15.0, since=8.0, memory=memory, change=scatter)
    assert not nav.read(memory).health.diverged
    memory = fly(nav, 17.0, since=15.0, memory=memory, change=scatter)
    assert nav.read(memory).health.diverged
    memory = fly(nav, 18.0, since=17.0, memory=memory)
    assert not nav.read(memory).health.diverged


def test_what_all_fixes_share_is_not_taken_for_certainty(flown):
    _, memory = flown
    state = navigator(fix_drift_sd=0.5).read(memory)
    assert state.health.position_sd > 0.5
    assert state.targets["trunk"].position_sd < 0.15


def test_a_failed_accelerometer_is_divergence():
    nav = navigator()

    def failed(o):
        return dataclasses.replace(
            o, imu=tuple(s._replace(accel=s.accel + vec(15, 0, 0)) for s in o.imu)
        )

    memory = fly(nav, 8.0)
    assert not nav.read(memory).health.diverged
    memory = fly(nav, 11.0, since=8.0, memory=memory, change=failed)
    assert nav.read(memory).health.diverged


def test_after_an_inertial_upset_the_fixes_bring_the_estimate_back():
    """A second of nonsense throws the filter off; satellites agree among themselves."""
    nav = navigator()

    def upset(o):
        return dataclasses.replace(
            o, imu=tuple(s._replace(accel=s.accel + vec(30, 0, -20)) for s in o.imu)
        )

    memory = fly(nav, 8.0)
    memory = fly(nav, 9.0, since=8.0, memory=memory, change=upset)
    memory = fly(nav, 12.0, since=9.0, memory=memory)
    assert nav.read(memory).health.diverged
    assert off_by(nav.read(memory), 12.0) > 10.0
    memory = fly(nav, 16.0, since=12.0, memory=memory)
    state = nav.read(memory)
    assert not state.health.diverged
    assert off_by(state, 16.0) < 1.5
    np.testing.assert_allclose(state.velocity, velocity(16.0), atol=0.5)


def test_silence_and_drift_are_divergence(flown):
    nav, memory = flown
    quiet = nav.propagate(memory, Observation(10.4))
    assert not nav.read(quiet).health.diverged
    assert nav.read(nav.propagate(quiet, Observation(10.6))).health.diverged
    strict = navigator(max_position_sd=0.05)
    assert strict.read(memory).health.diverged


def test_a_gap_in_the_samples_is_bridged(flown):
    nav, memory = flown
    lost = fly(
        nav, 10.2, since=10.0, memory=memory, change=lambda o: dataclasses.replace(o, imu=())
    )
    after = fly(nav, 11.0, since=10.2, memory=lost)
    assert off_by(nav.read(after), 11.0) < 1.0
    assert not nav.read(after).health.diverged


def test_a_wrongly_surveyed_target_is_moved_to_where_it_is_seen():
    settings = SETTINGS
    nav = build(settings, {"trunk": (TRUNK.translation + vec(-5, 6, 0), 0.5)}, MOUNT)
    memory = fly(nav, 8.0)
    memory = fly(nav, 8.4, since=8.0, memory=memory, seen=look)
    assert nav.read(memory).targets["trunk"].seen_at is None
    memory = fly(nav, 9.5, since=8.4, memory=memory, seen=look)
    state = nav.read(memory)
    relative = state.targets["trunk"].position - state.position
    assert np.linalg.norm(relative - (TRUNK.translation - position(9.5))) < 0.5
    assert state.targets["trunk"].seen_at == pytest.approx(9.42)
    assert off_by(state, 9.5) < 1.0


def test_ambiguous_attitudes_are_not_used():
    nav = navigator()
    memory = fly(nav, 5.0, seen=lambda f, t: f.sighting(t)._replace(ambiguous=True))
    trunk = nav.read(memory).targets["trunk"]
    assert trunk.attitude is None
    assert trunk.angle_sd is None
    assert trunk.seen_at is not None


def test_a_turned_target_is_accepted_after_enough_sightings(flown):
    nav, memory = flown
    quarter = exp(vec(0, math.pi / 2, 0))

    def turned(flight, t):
        seen = flight.sighting(t)
        pose = Transform(multiply(seen.pose.rotation, quarter), seen.pose.translation)
        return sighting(t, pose)

    few = fly(nav, 10.3, since=10.0, memory=memory, seen=turned)
    kept = nav.read(few).targets["trunk"].attitude
    assert np.linalg.norm(log(multiply(conjugate(kept), TRUNK.rotation))) < 0.1
    many = fly(nav, 10.8, since=10.3, memory=few, seen=turned)
    found = nav.read(many).targets["trunk"].attitude
    expected = multiply(TRUNK.rotation, quarter)
    assert np.linalg.norm(log(multiply(conjugate(found), expected))) < 0.1


def test_sightings_of_unknown_targets_are_left_aside(flown):
    nav, memory = flown
    other = Flight(np.random.default_rng(1)).sighting(9.9)._replace(target="stump")
    assert nav.fuse(memory, (other,)) is memory
    assert nav.fuse(memory, ()) is memory
