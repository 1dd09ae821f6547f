"""When and from where OBSTACLE_DISTANCE was measured."""

from __future__ import annotations

import numpy as np
import pytest

from missionkit.geometry import IDENTITY, from_euler, rotate
from missionkit.vehicle.autopilot_dialect import PX4
from missionkit.vehicle.link.clocks import MissionClock
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.link.message_rates import QUEUED
from missionkit.vehicle.telemetry.autopilot_state import AutopilotState
from missionkit.vehicle.telemetry.observer import Observer

RING = {
    "frame": 12, "sensor_type": 0, "distances": [500, *[1201] * 71], "increment": 5,
    "increment_f": 0.0, "angle_offset": 0.0, "min_distance": 20, "max_distance": 1200,
}  # fmt: skip
LEVEL, TILTED = IDENTITY, from_euler(0.0, -0.4, 0.0)


class Link:
    """Messages that come at times since boot; mission time zero is 100 s after it."""

    def __init__(self) -> None:
        self.now = 0.0
        self.cache = Cache(lambda: self.now, QUEUED)
        clock = MissionClock()
        clock.tick(0.0, 0.0)
        self.observer = Observer(self.cache, AutopilotState(self.cache, PX4), clock)

    def turned(self, attitude) -> None:
        q = dict(zip(("q1", "q2", "q3", "q4"), attitude.tolist(), strict=True))
        self.cache.put("ATTITUDE_QUATERNION", {"time_boot_ms": round(1e3 * self.now + 1e5), **q})

    def scan(self, stamp_us):
        self.cache.put("OBSTACLE_DISTANCE", {**RING, "time_usec": stamp_us})
        return self.observer.observe(self.now, None, ()).scan


@pytest.mark.parametrize(
    ("stamp", "at"),
    [(100_700_000, 0.7), (0, 1.0), (3_600_000_000, 1.0), (7_000_000, 1.0)],
    ids=["late", "no stamp", "a clock that is ahead", "a clock that is behind"],
)
def test_a_scan_counts_from_its_stamp_if_that_can_be_the_autopilots(stamp, at):
    link = Link()
    link.turned(LEVEL)
    link.observer.observe(0.0, None, ())
    link.now = 1.0
    found = link.scan(stamp)
    assert found.at == pytest.approx(at, abs=1e-6)
    assert found.range == 12.0


def test_the_ring_is_levelled_by_the_attitude_it_was_measured_at():
    link = Link()
    for now, attitude in ((0.6, LEVEL), (0.8, TILTED), (1.0, LEVEL)):
        link.now = now
        link.turned(attitude)
        link.observer.observe(now, None, ())
    (point,) = link.scan(100_790_000).points
    np.testing.assert_allclose(rotate(TILTED, point), (5.0, 0.0, 0.0), atol=1e-9)
