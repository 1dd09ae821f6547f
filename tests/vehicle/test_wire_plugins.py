"""A behaviour from outside breaks in flight: by the truth, the vehicle stops."""

from __future__ import annotations

import time
from typing import Any, ClassVar

import numpy as np
from typing_extensions import override
from vehicle.flying import sitl
from vehicle.on_a_mission import fly_mission, stay, strike

from missionkit.chart.plugin_catalogue import builtin
from missionkit.engine.flight_end import FlightEnd
from missionkit.messages import Estimate, Guidance, Step
from missionkit.plugin import Behavior

NORTHWARDS = np.array([200.0, 0.0, -2.0])
WELL = 3.0  # s for which it does what it should


class Tripping(Behavior):
    """Flies north for three seconds, then raises, or hangs for ten."""

    kind: ClassVar[str] = "tripping"
    how: str

    @override
    def begin(self, seen: Estimate) -> float:
        return seen.now

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        if seen.now < memory + WELL:
            return Step(Guidance(NORTHWARDS, 2.0), memory=memory)
        if self.how == "hangs":
            time.sleep(10.0)  # noqa: TID251 - it is what is to be interrupted
        raise RuntimeError("lost the thread")


def tripped(autopilot, tmp_path, how, **options):
    """Fly it; return the flight, and the truth (time, speed) from its last good second on."""
    catalogue = builtin().extended("behaviors", (Tripping,))
    text = stay(f"{{use: tripping, how: {how}}}", **options)
    mission = fly_mission(autopilot, text, tmp_path, {"up": strike()}, catalogue)
    begun = mission.began["up"][1] + WELL
    times, speeds = autopilot.speeds(begun - 1.0)
    return mission, times - begun, speeds


def comes_to_rest(times, speeds, within):
    """Say whether the vehicle stands for 2 s, `within` s at the latest: a busy machine is slow."""
    begins = times[(times > 0.0) & (times < within)]
    return any(max(speeds[(times >= at) & (times < at + 2.0)]) < 0.5 for at in begins)


def test_one_that_raises_leaves_the_vehicle_hovering(tmp_path):
    with sitl() as autopilot:
        mission, times, speeds = tripped(autopilot, tmp_path, "raises", after=7)
    assert max(speeds[times < 0.0]) > 1.5
    assert comes_to_rest(times, speeds, within=5.0)
    assert "tripping raised RuntimeError: lost the thread" in mission.problems
    assert mission.flown.end is FlightEnd.LANDED


def test_one_that_hangs_is_interrupted_and_the_failsafe_lands(tmp_path):
    with sitl() as autopilot:
        mission, times, speeds = tripped(autopilot, tmp_path, "hangs", failsafe="plugin_failed")
        truth = autopilot.truth
    assert max(speeds[times < 0.0]) > 1.5
    assert comes_to_rest(times, speeds, within=8.0)
    assert any("did not return" in problem for problem in mission.problems)
    assert "failsafe mishap" in mission.reasons
    assert mission.flown.end is FlightEnd.LANDED
    assert not truth["crashed"]
