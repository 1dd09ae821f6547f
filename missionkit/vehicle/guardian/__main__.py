"""The guardian's process: `python -m missionkit.vehicle.guardian SCHEME PLACE NUMBER …`.

Its arguments, as `missionkit.vehicle.link.guardian_client` gives them: the address, seconds of the
vehicle in one of the wall, how long silence may last (s, twice), the local port (0: any free one),
the file descriptors of the control socket and of the link's lock, and the message ids to leave out.
"""

from __future__ import annotations

import gc
import os
import signal
import socket
import sys
from contextlib import suppress

from missionkit.vehicle.guardian import HOLDER
from missionkit.vehicle.guardian.autopilot_link import GATHERED, Poller, open_link
from missionkit.vehicle.guardian.policy import Patience
from missionkit.vehicle.guardian.relay import Ends, Relay

URGENT = -10  # niceness: it has little to do, and that must not wait
LOOPBACK = "127.0.0.1"
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGPIPE)


def main(arguments: list[str]) -> None:
    """Guard one link until the mission's process is gone and its vehicle holds."""
    for meant in SIGNALS:  # for the mission, whose end is waited for here
        signal.signal(meant, signal.SIG_IGN)
    gc.disable()  # nothing here is cyclic
    with suppress(OSError):  # where that is allowed
        os.setpriority(os.PRIO_PROCESS, 0, URGENT)
    scheme, place, number, pace, brake, hold, port, control, lock, spare = arguments
    ends = Ends(_local(int(port)), socket.socket(fileno=int(control)))
    ends.control.settimeout(0.0)
    poller = Poller(min(GATHERED, GATHERED / float(pace)))
    left_out = frozenset(map(int, spare.split(",")))
    patience = Patience(float(brake), float(hold))
    relay = Relay(poller, ends, float(pace), patience, left_out, lambda: _sign(int(lock)))
    try:
        relay.link = open_link(scheme, place, int(number), poller, relay.downwards)
    except OSError as error:
        ends.control.send(f"failed {error.strerror or error}".encode())
        return
    ends.control.send(f"port {ends.local.getsockname()[1]}".encode())
    relay.run()


def _sign(lock: int) -> None:
    """Say in the link's lock that a guardian alone has it, and lets go of it before long."""
    with suppress(OSError):
        os.ftruncate(lock, 0)
        os.pwrite(lock, f"{HOLDER} {os.getpid()}\n".encode(), 0)


def _local(port: int) -> socket.socket:
    """Return the socket on which the mission's MAVSDK calls."""
    local = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    local.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 20)
    local.bind((LOOPBACK, port))
    local.settimeout(0.0)
    return local


if __name__ == "__main__":
    main(sys.argv[1:])
