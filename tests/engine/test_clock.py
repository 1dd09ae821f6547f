from __future__ import annotations

import asyncio

import pytest

from missionkit.engine import clock
from missionkit.engine.clock import RealTime, Unhurried


@pytest.fixture
def slept(monkeypatch) -> list[float]:
    """A wall clock that moves only while somebody sleeps."""
    wall, naps = [100.0], []

    async def sleep(seconds: float) -> None:
        naps.append(seconds)
        wall[0] += seconds

    monkeypatch.setattr(clock.time, "perf_counter", lambda: wall[0])
    monkeypatch.setattr(clock.asyncio, "sleep", sleep)
    naps.append(0.0)
    wall.append(0.0)
    return naps


@pytest.mark.parametrize(("speed", "nap"), [(1.0, 0.05), (5.0, 0.01), (0.5, 0.1)])
def test_mission_time_is_tied_to_the_wall(slept, speed, nap):
    pace = RealTime(speed)
    for tick in (1, 2, 3):
        asyncio.run(pace.until(tick * 0.05))
    assert slept[1:] == pytest.approx([nap] * 3)


def test_a_late_tick_does_not_sleep(slept, monkeypatch):
    pace = RealTime()
    monkeypatch.setattr(clock.time, "perf_counter", lambda: 107.0)
    asyncio.run(pace.until(5.0))
    assert slept[1:] == [0.0]


def test_unpaced_runs_never_sleep(slept):
    asyncio.run(Unhurried().until(1e9))
    assert slept[1:] == []
