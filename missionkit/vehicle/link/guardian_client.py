"""The mission's side of the guardian: starts with the link, announces intended silence.

    MAVSDK <-- UDP on loopback --> guardian <-- the vehicle's address --> autopilot
    adapter <-- socket pair, a word each --> guardian

The guardian learns of the end of this process from the end of the socket pair, however it came.
Should the guardian itself end, another one is started on the same local port.
"""

from __future__ import annotations

import socket
import subprocess
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

from missionkit.errors import VehicleError
from missionkit.vehicle.guardian.policy import Patience
from missionkit.vehicle.link.link_address import Address, unopened
from missionkit.vehicle.link.message_rates import SPARE

STARTED = 10.0  # s to wait for the process
ENDED = 1.0  # s to wait for its end; it stays on while the vehicle does not yet hold
LOST = "guardian_lost"  # the event when the guardian itself ended
RESTART_AFTER = 1.0  # s between two starts
_ROOT = Path(__file__).parents[3]
_RUN = (
    "import runpy, sys; sys.path.insert(0, sys.argv.pop(1)); "
    "runpy.run_module('missionkit.vehicle.guardian', run_name='__main__')"
)


class Guardian:
    """A guardian of one link, and the words exchanged with it.

    Args:
        address: of the vehicle.
        lock: file descriptor of the link's lock, which the guardian holds as well.
        pace: seconds of the vehicle in one of the wall.
        patience: how long silence may last.
        held: called, on a thread of its own, when the guardian has ordered the vehicle to hold.
        note: takes an event for the mission.
    """

    def __init__(
        self,
        address: Address,
        lock: int,
        pace: float,
        patience: Patience,
        held: Callable[[], None],
        note: Callable[[str], None],
    ) -> None:
        self._address = address
        self._lock = lock
        self._pace = pace
        self._patience = patience
        self._held = held
        self._note = note
        self._closing = threading.Event()
        self._port = 0
        self._control, self._process = self._started()
        self._thread = threading.Thread(target=self._listen, name="guardian", daemon=True)
        self._thread.start()

    @property
    def local(self) -> Address:
        """Where the link is reached through the guardian."""
        return Address("udpout", "127.0.0.1", self._port)

    @property
    def process(self) -> int:
        """Its process number."""
        return self._process.pid

    def idle(self) -> None:
        """Say that no setpoints come from now on, on purpose."""
        self._say(b"idle")

    def given(self) -> None:
        """Say that a person gave control back to the mission."""
        self._say(b"given")

    def close(self) -> None:
        """Leave the link to the guardian, which ends unless the vehicle is still to be stopped."""
        self._closing.set()
        with suppress(OSError):
            self._control.shutdown(socket.SHUT_RDWR)
        self._thread.join(ENDED)
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(ENDED)
        self._control.close()

    def _say(self, word: bytes) -> None:
        with suppress(OSError):  # it is gone, or does not read: nothing passes either
            self._control.send(word, socket.MSG_DONTWAIT)

    def _started(self) -> tuple[socket.socket, subprocess.Popen[bytes]]:
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            spare = ",".join(map(str, SPARE))
            numbers = (self._pace, *self._patience, self._port, theirs.fileno(), self._lock, spare)
            process = subprocess.Popen(  # noqa: S603 - this interpreter, our own module
                [
                    *(sys.executable, "-I", "-S", "-c", _RUN, str(_ROOT)),
                    *(self._address.scheme, self._address.place, str(self._address.number)),
                    *map(str, numbers),
                ],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                cwd="/",
                pass_fds=(theirs.fileno(), self._lock),
                start_new_session=True,  # a terminal's Ctrl-C and hang-up are for the mission
            )
        ours.settimeout(STARTED)
        try:
            word, _, rest = ours.recv(1024).decode().partition(" ")
        except OSError as error:
            word, rest = "failed", str(error)
        ours.settimeout(None)
        if word != "port":
            ours.close()
            process.wait(ENDED)
            raise VehicleError(unopened(self._address, rest or "the guardian did not start"))
        self._port = int(rest)
        return ours, process

    def _listen(self) -> None:
        while not self._closing.is_set():
            try:
                word = self._control.recv(64)
            except OSError:
                word = b""
            if word == b"held":
                self._held()
            elif not word and not self._closing.is_set():
                self._replace()

    def _replace(self) -> None:
        """Start another one in place of one that ended."""
        self._note(LOST)
        self._process.wait()
        while not self._closing.is_set():
            with suppress(VehicleError, subprocess.TimeoutExpired):
                before = self._control
                self._control, self._process = self._started()
                before.close()
                return
            self._closing.wait(RESTART_AFTER)
