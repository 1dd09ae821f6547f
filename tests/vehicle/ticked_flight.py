"""A vehicle ticked by hand. Without the simulator, so that a program importing this starts fast."""

from __future__ import annotations

import asyncio
import time

from missionkit.geometry import vec
from missionkit.messages import Action, Command, Setpoint

PERIOD = 0.05
STILL = Command()
NORTH = Command(Setpoint(vec(2.0, 0.0, 0.0), 0.0))
CLIMB = Command(action=Action.TAKE_OFF, height=2.5)
LAND = Command(action=Action.LAND)
ARM = Command(action=Action.ARM)


class Flight:
    """A vehicle that is ticked at 20 Hz of its own time."""

    def __init__(self, vehicle, speed):
        self.vehicle, self.speed = vehicle, speed
        self.now, self.status, self.events, self.seen = 0.0, None, [], []
        self._start = None

    async def tick(self, command=STILL):
        if self._start is None:
            self._start = time.perf_counter()
        self.now += PERIOD
        due = self._start + self.now / self.speed
        await asyncio.sleep(max(0.0, due - time.perf_counter()))
        seen = await self.vehicle.observe(self.now)
        self.status = seen.status or self.status
        self.events += seen.events
        self.seen.append(seen)
        await self.vehicle.send(command)

    async def run(self, seconds, command=STILL):
        for _ in range(round(seconds / PERIOD)):
            await self.tick(command)

    async def until(self, holds, command=STILL, limit=30.0):
        end = self.now + limit
        while not holds():
            assert self.now < end, f"{self.status}, {self.events}, {self.vehicle.reports}"
            await self.tick(command() if callable(command) else command)

    async def ready(self):
        await self.until(lambda: self.status is not None and self.status.ready)

    async def arm(self):
        await self.ready()
        await self.until(lambda: self.status.armed, ARM)

    async def take_off(self):
        await self.arm()
        await self.until(lambda: self.status.in_air, self._off_the_ground)
        await self.until(lambda: self.up and self.status.mode != "take_off")

    def _off_the_ground(self):
        """Arm again what has disarmed itself: a take-off takes long over a bad link."""
        return CLIMB if self.status.armed else ARM

    @property
    def up(self):
        """Whether it is nearly as high as `CLIMB` says; the mode on the way may go unheard."""
        height = self.vehicle.state.height
        return height is not None and height > CLIMB.height - 0.4

    async def cruise(self, sitl):
        """Take off and fly north until it really does."""
        await self.take_off()
        await self.until(lambda: sitl.truth["velocity"][0] > 1.8, NORTH)

    async def land(self):
        await self.until(lambda: not self.status.armed, LAND)
