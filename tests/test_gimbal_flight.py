"""A gimbal in flight: it looks at a beacon that a fixed camera would lose; unknown, nothing."""

from __future__ import annotations

import math

import numpy as np
from gimbal_mission import GIMBAL_WATCH
from rehearsed import MISSIONS, flown

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.rehearsal.stage import stage, world_of
from missionkit.sim.fault_injection import parse_fault


def watching(*faults):
    mission = parse(GIMBAL_WATCH, str(MISSIONS / "gimbal_watch.yaml"), builtin())
    world = world_of(mission, MISSIONS)
    return flown(stage(mission, builtin(), world, 1, tuple(map(parse_fault, faults))))


def test_the_gimbal_stays_on_the_beacon_in_later_states_and_the_estimate_is_right():
    flight = watching()
    (beacon,) = (m for m in flight.ready.vehicle.world.all_markers if m.id == 5)
    past = [r for r in flight.records if r.state == "past"]
    sighted = [r.estimate for r in past if r.estimate.sightings]
    place = beacon.pose.translation
    near = [r.estimate for r in past if math.dist(r.estimate.position, place) < 17.0]
    looks = [look for each in near for look in each.looks]
    assert np.mean(["beacon" in look.seen for look in looks]) > 0.9
    off = [place - e.position for e in sighted]
    nose = [math.atan2(way[1], way[0]) - e.yaw for way, e in zip(off, sighted, strict=True)]
    assert max(nose) > math.radians(110.0)  # astern on the right: a fixed camera looks ahead
    last, rows = sighted[-1], flight.ready.vehicle.track.rows
    here = rows[np.searchsorted(rows[:, 0], last.now), 1:4]
    believed = last.targets["beacon"].position - last.position
    assert np.linalg.norm(believed - (place - here)) < 0.4
    level = flight.records[-1].estimate.gimbal
    assert abs(level.angles.pitch + math.pi / 2) < 0.02
    assert flight.problems() == []


def test_while_its_attitude_is_unknown_no_frame_is_used_and_the_camera_counts_as_silent():
    flight = watching("gimbal_lost@past:5")
    lost = flight.entered("past") + 5.0
    seen = [r.now for r in flight.records if r.estimate.sightings]
    assert seen
    assert max(seen) < lost + 0.2
    assert [to for to, _ in flight.went()][-1] == "land"
    assert sum("gimbal is turned is not known" in it for it in flight.problems()) == 1
