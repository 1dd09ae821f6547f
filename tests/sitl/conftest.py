from __future__ import annotations

from collections.abc import Callable

import pytest
from sitl_station import EXACT, Station

from missionkit.sim.world import World


@pytest.fixture
def station(request: pytest.FixtureRequest) -> Callable[..., Station]:
    """Make stations; a module that says QUIET gets no telemetry but heartbeats, and is faster."""

    def make(
        name: str = "px4", *faults: str, world: World = EXACT, who: tuple[int, int] = (245, 190)
    ) -> Station:
        made = Station(name, faults, world, who)
        if getattr(request.module, "QUIET", False):
            made.channel.streams = {0: made.channel.streams[0]}
        return made

    return make


@pytest.fixture(params=["px4", "ardupilot"])
def either(request: pytest.FixtureRequest, station: Callable[..., Station]) -> Station:
    return station(request.param)
