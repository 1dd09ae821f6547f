"""Flights from where an event loop runs already, as in a notebook."""

import asyncio

import missionkit
from missionkit.cli.scaffold import new


def test_a_flight_from_inside_an_event_loop_is_the_same(tmp_path):
    path, _ = new("mission", "first-flight", tmp_path)
    mission = missionkit.load(path, settings={"cruise": 8})

    async def cell():
        return missionkit.rehearse(mission, seed=2)

    inside, outside = asyncio.run(cell()), missionkit.rehearse(mission, seed=2)
    assert inside.succeeded
    assert inside.states == outside.states
