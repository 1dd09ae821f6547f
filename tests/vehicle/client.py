"""A client of its own process that flies north until something is done to it.

usage: python -m vehicle.client URL SPEED LOCKS
Says "flying" and its guardian's process number once it does. SIGUSR1 holds the interpreter's lock
for two seconds of the vehicle, SIGUSR2 collects garbage again and again for four.
"""

import asyncio
import ctypes
import gc
import signal
import sys
import time
from pathlib import Path

from vehicle.ticked_flight import NORTH, Flight

from missionkit.vehicle.adapter import MavsdkVehicle
from missionkit.vehicle.link.link_address import parse
from missionkit.vehicle.link.link_lock import LinkLock

HEAP = [[] for _ in range(60_000)]  # each collection looks at all of them


def collect(seconds):
    """Collect garbage for so long; other threads run in between only."""
    end = time.perf_counter() + seconds
    while time.perf_counter() < end:
        gc.collect()


async def main(url, speed, locks):
    address = parse(url)
    vehicle = MavsdkVehicle(address, pace=speed, lock=LinkLock(address, locks))
    # PyDLL keeps the interpreter's lock while the C function runs
    stall = int(2e6 / speed)
    signal.signal(signal.SIGUSR1, lambda *_: ctypes.PyDLL(None).usleep(stall))
    signal.signal(signal.SIGUSR2, lambda *_: collect(4.0 / speed))
    await vehicle.connect()
    flight = Flight(vehicle, speed)
    await flight.take_off()
    await flight.until(lambda: flight.status.mode == "offboard", NORTH)
    sys.stdout.write(f"flying {vehicle.guardian.process}\n")
    sys.stdout.flush()
    while True:
        await flight.tick(NORTH)


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1], float(sys.argv[2]), Path(sys.argv[3])))
