"""Flying a simulated autopilot over the wire, tick by tick, with the truth at hand."""

from __future__ import annotations

import asyncio
import itertools
import json
import os
import socket
import sys
import threading
import time
from contextlib import asynccontextmanager, contextmanager

import numpy as np
from vehicle.ticked_flight import Flight

from missionkit.sitl.sitl_server import Setup, serving
from missionkit.vehicle.adapter import MavsdkVehicle
from missionkit.vehicle.guardian.policy import Patience
from missionkit.vehicle.link.link_address import parse
from missionkit.vehicle.link.link_lock import LinkLock

SPEED = 4.0  # at most, see `affordable`
BRISK = 5.0  # where nothing depends on how soon something is done
UNHURRIED = Patience(brake=4.0, hold=20.0)  # a busy machine does not count as silence
CORNERS = ((-20.0, -40.0), (120.0, -40.0), (120.0, 60.0), (-20.0, 60.0))  # of a fence, m
PROBE = 0.01  # s of processor time

WORKER = int(os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw")) % 4
SHARE = 3000
FIRST = 20000 + SHARE * WORKER
BEGUN = os.getpid() % 60 * 50  # another run of the tests begins elsewhere
PORTS = itertools.islice(itertools.cycle(range(FIRST, FIRST + SHARE)), BEGUN, None)
"""Below the ports that the system gives to any socket, and each worker's own: none of the others
can take one before the autopilot or the vehicle does."""


def free_port():
    return next(filter(is_free, PORTS))


def is_free(port):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("127.0.0.1", port))
        except OSError:
            return False
    return True


def affordable(speed):
    """Return how many times real time this machine can fly now: at most `speed`, at least 1.

    Faster than real time is a favour of an idle machine. A busy or slow one is a real companion
    computer, which has to fly in real time.
    """
    wall, busy = time.perf_counter(), time.thread_time()
    while time.thread_time() - busy < PROBE:
        pass
    share = PROBE / (time.perf_counter() - wall)
    load = os.getloadavg()[0] / (os.cpu_count() or 1)
    return max(1.0, speed * min(1.0, share, 1.5 / max(load, 0.1)))


class Sitl:
    """The control socket of a simulated autopilot."""

    def __init__(self, server, port, speed):
        self.url, self.speed = f"udpin://127.0.0.1:{port}", speed
        self.server = server
        self._socket = socket.create_connection(("127.0.0.1", server.control_port))
        self._file = self._socket.makefile("rw")

    def ask(self, **request):
        self._file.write(json.dumps(request) + "\n")
        self._file.flush()
        return json.loads(self._file.readline())

    @property
    def truth(self):
        return self.ask(truth=True)

    @property
    def now(self):
        return self.ask(time=True)["time"]

    def notes(self, what, since=0.0):
        return self.ask(journal=what, since=since)["notes"]

    def speeds(self, since):
        """Return (time, speed over ground) of the truth."""
        rows = np.array(self.ask(track=True, since=since)["rows"], dtype=float)
        return rows[:, 0], np.hypot(rows[:, 4], rows[:, 5])

    def patient(self, seconds):
        """Let PX4 wait that long for setpoints: a busy machine is not the fault of the client."""
        self.ask(parameter="COM_OF_LOSS_T", value=seconds)

    def close(self):
        self._file.close()
        self._socket.close()


@contextmanager
def sitl(dialect="px4", speed=SPEED, **setup):
    port = free_port()
    links = (f"udpout:127.0.0.1:{port}",)
    speed = affordable(speed)
    with serving(Setup(dialect=dialect, links=links, speed=speed, **setup)) as server:
        control = Sitl(server, port, speed)
        if dialect == "px4":
            control.patient(5.0)
        try:
            yield control
        finally:
            control.close()


@asynccontextmanager
async def flying(sitl, tmp_path, guard=UNHURRIED, **options):
    """Fly an autopilot through a guardian that bears what a busy machine does."""
    address = parse(sitl.url)
    lock = LinkLock(address, tmp_path)
    vehicle = MavsdkVehicle(address, pace=sitl.speed, lock=lock, guard=guard, **options)
    await vehicle.connect()
    try:
        yield Flight(vehicle, sitl.speed)
    finally:
        await vehicle.close()


def over_the_wire(tmp_path, script, dialect="px4", guard=UNHURRIED, **setup):
    """Run `script(flight, autopilot)`; return what it returns."""

    async def fly(autopilot):
        async with flying(autopilot, tmp_path, guard) as flight:
            return await script(flight, autopilot)

    with sitl(dialect, **setup) as autopilot:
        return asyncio.run(fly(autopilot))


def command(autopilot, *more):
    """Return the command line that runs a mission with the autopilot."""
    python = [sys.executable, "-c", "from missionkit.cli.app import app; app()"]
    return [*python, *arguments(autopilot, *more)]


def arguments(autopilot, *more):
    """Return the arguments of the command that runs a mission with the autopilot."""
    speed = str(autopilot.speed)
    return ["run", *more, "--vehicle", autopilot.url, "--speed", speed, "--headless"]


def until(holds, limit=60.0):
    """Wait until something holds, for at most `limit` (s, wall)."""
    end = time.perf_counter() + limit
    while not holds():
        assert time.perf_counter() < end
        threading.Event().wait(0.02)
