"""Guards without a memory: each holds, does not, and cannot tell where it should."""

from __future__ import annotations

import math

import numpy as np
import pytest
from samples import calm

from missionkit.geometry import from_euler
from missionkit.guards.battery import BatteryBelow
from missionkit.guards.converged import Converged
from missionkit.guards.distances import NearGoal, Within
from missionkit.guards.disturbance import Disturbed
from missionkit.guards.estimate_quality import EstimateBad, GnssLost
from missionkit.guards.geofence import InsideFence
from missionkit.guards.link_loss import LinkLost
from missionkit.guards.plugin_failure import PluginFailed
from missionkit.guards.readiness import Ready
from missionkit.guards.state_progress import Done, Elapsed
from missionkit.guards.target_visibility import TargetLost, TargetSeen
from missionkit.messages import Battery, Goal, Health, Target, VehicleStatus

FENCE = InsideFence(north=(-10, 20), east=(-5, 5), height=8)


def target(at, seen_at=None):
    return Target("trunk", np.array(at, dtype=float), 0.1, None, None, seen_at)


def goal(at=(0.0, 0.0, -5.0), yaw=0.0, name=None):
    return Goal(np.array(at), yaw, 9.9, name)


@pytest.mark.parametrize(
    ("guard", "changes", "holds"),
    [
        (BatteryBelow(floor=0.2), {"battery": Battery(10.0, 0.19, 14.0)}, True),
        (BatteryBelow(floor=0.2), {"battery": Battery(10.0, 0.20, 14.0)}, False),
        (BatteryBelow(floor=0.2), {"battery": Battery(4.0, 0.1, 14.0)}, None),
        (BatteryBelow(floor=0.2), {"battery": None}, None),
        (LinkLost(longer_than=3), {"status": VehicleStatus(6.9, True, True, True, "")}, True),
        (LinkLost(longer_than=3), {"status": VehicleStatus(7.1, True, True, True, "")}, False),
        (LinkLost(), {"status": None}, None),
        (Within(of="trunk", radius=5), {"targets": {"trunk": target((3, 4, -5))}}, True),
        (Within(of="trunk", radius=5), {"targets": {"trunk": target((3, 4.1, -5))}}, False),
        (Within(of="trunk", radius=5), {}, None),
        (NearGoal(radius=1), {"goal": goal((1.0, 0.0, -5.0))}, True),
        (NearGoal(radius=1), {"goal": goal((1.01, 0.0, -5.0))}, False),
        (NearGoal(radius=1), {}, None),
        (Disturbed(error=0.3), {"goal": goal((0.4, 0.0, -5.0))}, True),
        (Disturbed(error=0.3), {"goal": goal((0.2, 0.0, -5.0))}, False),
        (Disturbed(), {"attitude": from_euler(0.0, 0.4, 1.0), "goal": goal()}, True),
        (Disturbed(), {"attitude": from_euler(0.3, 0.0, 1.0), "goal": goal()}, False),
        (Disturbed(), {"attitude": from_euler(0.4, 0.0, 0.0)}, True),
        (Disturbed(), {}, None),
        (FENCE, {}, True),
        (FENCE, {"position": np.array([0.0, 0.0, -8.1])}, False),
        (FENCE, {"position": np.array([-10.1, 0.0, -5.0])}, False),
        (FENCE, {"position": np.array([0.0, 5.1, -5.0])}, False),
        (FENCE, {"health": Health(False, False, None, None, 9.0, 0)}, None),
        (Done(), {"done": True}, True),
        (Done(), {}, False),
        (Elapsed(longer_than=2), {"entered_at": 8.0}, True),
        (Elapsed(longer_than=2), {"entered_at": 8.1}, False),
        (EstimateBad(), {"health": Health(True, True, 10.0, None, 0.3, 9)}, True),
        (EstimateBad(), {"health": Health(True, False, 10.0, None, 5.1, 0)}, True),
        (EstimateBad(), {}, False),
        (GnssLost(longer_than=5), {"health": Health(True, False, 4.9, None, 0.3, 0)}, True),
        (GnssLost(longer_than=5), {"health": Health(True, False, 5.1, None, 0.3, 0)}, False),
        (GnssLost(), {"health": Health(True, False, None, None, 0.3, 0)}, None),
        (TargetSeen(target="trunk"), {"targets": {"trunk": target((0, 0, 0), 9.6)}}, True),
        (TargetSeen(target="trunk"), {"targets": {"trunk": target((0, 0, 0), 9.4)}}, False),
        (TargetSeen(target="trunk"), {"targets": {"trunk": target((0, 0, 0))}}, False),
        (TargetLost(target="trunk"), {"targets": {"trunk": target((0, 0, 0), 8.0)}}, True),
        (TargetLost(target="trunk"), {"targets": {"trunk": target((0, 0, 0), 8.1)}}, False),
        (
            TargetLost(target="trunk"),
            {"targets": {"trunk": target((0, 0, 0), 5.0)}, "entered_at": 9.0},
            False,
        ),
        (PluginFailed(), {"failing": ("wobbly raised ValueError: no",)}, True),
        (PluginFailed(), {}, False),
        (Ready(), {}, True),
        (Ready(), {"battery": Battery(10.0, 0.4, 15.0)}, False),
        (Ready(), {"status": VehicleStatus(10.0, False, False, False, "")}, False),
        (Ready(), {"health": Health(False, False, None, None, 9.0, 0)}, False),
        (Ready(), {"status": VehicleStatus(4.0, False, False, True, "")}, None),
        (Ready(), {"status": None}, None),
    ],
)
def test_verdict(seen, guard, changes, holds):
    assert guard.check(seen(**changes)).holds is holds


@pytest.mark.parametrize(
    ("changes", "holds", "value"),
    [
        ({"goal": goal((0.06, 0.08, -5.0))}, True, 0.10),
        ({"goal": goal((0.06, 0.09, -5.0))}, False, np.hypot(0.06, 0.09)),
        ({"goal": goal(), "attitude": from_euler(0, 0, np.radians(-4.9))}, True, 0.0),
        ({"goal": goal(), "attitude": from_euler(0, 0, np.radians(5.1))}, False, 5.1),
        ({"goal": goal(yaw=np.pi), "attitude": from_euler(0, 0, -np.pi + 0.05)}, True, 0.0),
        ({"goal": goal(yaw=None), "attitude": from_euler(0, 0, 2.0)}, True, 0.0),
        ({"goal": goal(), "velocity": np.array([0.3, 0.0, 0.0])}, False, 0.3),
        ({"goal": goal(name="trunk"), "targets": {"trunk": target((1, 0, -5), 8.9)}}, None, None),
        ({"goal": goal(name="trunk"), "targets": {"trunk": target((1, 0, -5), 9.1)}}, True, 0.0),
        ({}, None, None),
    ],
)
def test_converged(seen, changes, holds, value):
    verdict = Converged(position=0.1000001).check(seen(**changes))
    assert verdict.holds is holds
    assert verdict.value == (None if value is None else pytest.approx(value, abs=1e-9))


def test_a_diverged_filter_says_why(seen):
    health = Health(True, True, 10.0, None, 0.3, 30)
    assert EstimateBad().check(seen(health=health)).why == "the filter has diverged"
    jumped = health._replace(cause="GNSS jumped 20 m")
    assert EstimateBad().check(seen(health=jumped)).why == "GNSS jumped 20 m"


def test_margin_says_how_far_inside():
    verdict = FENCE.check(calm(position=np.array([0.0, 4.0, -5.0])))
    assert (verdict.value, verdict.threshold, verdict.margin) == (1.0, 0.0, 1.0)


def test_disturbed_names_the_worse_of_two_causes():
    seen = calm(attitude=from_euler(0.0, math.radians(15.0), 0.0), goal=goal((0.1, 0.0, -5.0)))
    verdict = Disturbed(error=0.25, tilt_deg=20).check(seen)
    assert (verdict.why, verdict.threshold) == ("tilt, deg", 20.0)
    assert verdict.value == pytest.approx(15.0)
    assert verdict.margin == pytest.approx(-5.0)
    off = Disturbed(error=0.1, tilt_deg=80).check(seen)
    assert (off.why, off.value) == ("off the goal, m", pytest.approx(0.1))
