"""Compiling the free flyer's kernels, or loading them from their cache, before a flight."""

from __future__ import annotations

from functools import cache

from missionkit.geometry import vec
from missionkit.messages import Command, Wrench
from missionkit.sim.free_flyer.body_model import FreeFlyerBody
from missionkit.sim.free_flyer.free_flyer import FreeFlyer
from missionkit.sim.free_flyer.world import FreeFlyerWorld


@cache
def warm_up() -> None:
    """Float before a target for a moment, with one anchor to range to."""
    world = FreeFlyerWorld(world="empty", vehicle=FreeFlyerBody(), anchors={"a": (0.0, 0.0, 0.0)})
    flyer = FreeFlyer(world, seed=0)
    flyer.apply(Command(setpoint=Wrench(vec(0.0, 0.0, 0.0), vec(0.0, 0.0, 0.0))))
    flyer.advance(0.2)
