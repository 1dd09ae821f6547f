"""The simulated autopilot on its sockets, in step with the wall clock."""

from __future__ import annotations

import selectors
import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from time import perf_counter
from types import MappingProxyType
from typing import NamedTuple

from missionkit.errors import UsageError, VehicleError
from missionkit.sim.warm_up import warm_up
from missionkit.sim.world import World
from missionkit.sitl.control_socket import ControlSocket
from missionkit.sitl.flight_modes import dialect
from missionkit.sitl.geodetic import ZURICH, GeographicPoint
from missionkit.sitl.mavlink_autopilot import SLICE, MavlinkAutopilot
from missionkit.sitl.socket_links import Address, open_link
from missionkit.sitl.wire_faults import read_fault

LINKS = ("udpout:127.0.0.1:14540", "udpout:127.0.0.1:14550", "tcpin:127.0.0.1:5760")
SLIP = 0.1  # s, of wall time; a simulation that is later than that lets the time pass unused
FASTEST_TIME = 10.0
WAIT = 0.2  # s, at most, between two looks at whether to stop


class Setup(NamedTuple):
    """Settings of a simulated autopilot: world, dialect, links, ports."""

    world: World = World(world="empty")
    dialect: str = "px4"
    links: Sequence[str] = LINKS
    control: int = 0  # port; 0: any free one
    speed: float = 1.0  # times real time
    seed: int = 0
    faults: Sequence[str] = ()
    origin: GeographicPoint = GeographicPoint(*ZURICH)
    system: int = 1  # MAVLink system id
    parameters: Mapping[str, float] = MappingProxyType({})  # other than their defaults


class Server:
    """One simulated autopilot; sockets are open when it exists, time passes in `run`.

    Raises:
        UsageError: part of the setup does not fit.
        VehicleError: a port is taken.
    """

    def __init__(self, setup: Setup) -> None:
        if not 0.0 < setup.speed <= FASTEST_TIME:
            raise UsageError(
                f"speed {setup.speed:g}: expected more than 0, at most {FASTEST_TIME:g}"
            )
        kind = dialect(setup.dialect)
        faults = [read_fault(text, kind) for text in setup.faults]
        self.autopilot = MavlinkAutopilot(
            setup.world, kind, setup.seed, faults, setup.origin, perf_counter, setup.system
        )
        self.autopilot.state.heartbeat = min(1.0, setup.speed)  # one in a second of the wall
        for name, value in setup.parameters.items():
            self.autopilot.state.parameters.set(name, value)
        self.speed = setup.speed
        self._selector = selectors.DefaultSelector()
        with ExitStack() as opened:
            opened.callback(self._selector.close)
            try:
                self._control = ControlSocket(self.autopilot.state, self._selector, setup.control)
            except OSError as error:
                raise VehicleError(f"control port {setup.control}: {error.strerror}") from error
            opened.callback(self._control.close)
            self._links = []
            for text in setup.links:
                link = open_link(text, self.autopilot, self._selector)
                opened.callback(link.close)
                self._links.append(link)
            self._opened = opened.pop_all()

    @property
    def control_port(self) -> int:
        """Port of the control socket on 127.0.0.1."""
        return self._control.port

    @property
    def addresses(self) -> tuple[Address, ...]:
        """Host and port of each link: its own, or the one `udpout` talks to."""
        return tuple(link.address for link in self._links)

    def run(self, stop: threading.Event) -> None:
        """Let time pass until `stop` is set or the control socket says `quit`."""
        state = self.autopilot.state
        start = perf_counter() - state.now / self.speed
        while not (stop.is_set() or self._control.wants_end):
            due = start + (state.now + SLICE) / self.speed
            wait = due - perf_counter()
            if wait < -SLIP:
                start -= wait
            for key, _ in self._selector.select(max(0.0, min(wait, WAIT))):
                key.data()
                self.autopilot.listen()
            if perf_counter() >= due:
                self.autopilot.step()

    def close(self) -> None:
        """Let go of all sockets."""
        self._opened.close()


@contextmanager
def serving(setup: Setup) -> Iterator[Server]:
    """Run a simulated autopilot in a thread.

    Raises:
        UsageError: part of the setup does not fit.
        VehicleError: a port is taken.
    """
    warm_up(corners=False)
    server, stop = Server(setup), threading.Event()
    thread = threading.Thread(target=server.run, args=(stop,), name="sitl", daemon=True)
    thread.start()
    try:
        yield server
    finally:
        stop.set()
        thread.join(5.0)
        server.close()
