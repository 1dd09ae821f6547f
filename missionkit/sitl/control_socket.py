"""The control socket: JSON lines over loopback TCP, for tests and graders.

One request a line, one answer a line. `{"error": "..."}` answers what cannot be done.
"""

from __future__ import annotations

import json
import math
import selectors
import socket
from collections.abc import Callable, Mapping
from typing import Any

from missionkit.errors import UsageError, nearest
from missionkit.sitl.sitl_state import SitlState
from missionkit.sitl.wire_faults import read_fault

COLUMNS = (
    *("at", "north", "east", "down", "v_north", "v_east", "v_down", "qw", "qx", "qy", "qz"),
    *("p", "q", "r", "on_ground", "armed", "mode", "crashed", "charge", "clearance", "energy"),
)
LONGEST_LINE = 1_000_000  # bytes of a line
READER_TIMEOUT = 5.0  # s, for a reader that does not read
Answer = dict[str, Any]


def truth(state: SitlState, _: Any, __: Answer) -> Answer:
    """Return the true state of the vehicle, and the autopilot's mode.

    Args:
        state: of the autopilot.
        _: not used.
        __: not used.

    Returns:
        SI, NED; `None` as clearance where there are no obstacles.
    """
    now = state.body.truth
    return {
        "at": now.at,
        "position": now.position.tolist(),
        "velocity": now.velocity.tolist(),
        "attitude": now.attitude.tolist(),
        "rates": now.rates.tolist(),
        "on_ground": now.on_ground,
        "armed": state.armed,
        "crashed": now.crashed,
        "charge": now.charge,
        "clearance": now.clearance if math.isfinite(now.clearance) else None,
        "energy": now.energy,
        "mode": state.mode.name,
        "flying": str(state.mode.does),
        "inner": now.mode,
        "failsafe": state.failsafe,
        "payload": state.payload,
        "photos": state.photos,
        "devices": dict(state.devices),
        "gimbal": state.gimbal.angles(state.now)._asdict(),
    }


def track(state: SitlState, _: Any, request: Answer) -> Answer:
    """Return the true track, from `since` (s) on.

    Args:
        state: of the autopilot.
        _: not used.
        request: `since` (s), and `every`: each how manieth row is wanted.
    """
    rows = state.body.track.rows
    rows = rows[rows[:, 0] >= float(request.get("since", 0.0))]
    every = max(1, int(request.get("every", 1)))
    plain = [[v if math.isfinite(v) else None for v in row] for row in rows[::every].tolist()]
    return {"columns": COLUMNS, "rows": plain}


def journal(state: SitlState, what: Any, request: Answer) -> Answer:
    """Return what happened, from `since` (s) on, of one kind or (`true`) of all.

    Args:
        state: of the autopilot.
        what: kind of note, or `true`.
        request: `since` (s).
    """
    since = float(request.get("since", 0.0))
    notes = [n for n in state.journal if n.at >= since and what in {True, n.what}]
    return {"notes": [n._asdict() for n in notes]}


def time(state: SitlState, _: Any, __: Answer) -> Answer:
    """Return simulated time (s), time since boot (s) and the machine's clock (s).

    Args:
        state: of the autopilot.
        _: not used.
        __: not used.
    """
    return {"time": state.now, "boot": state.micros / 1e6, "wall": state.wall()}


def fault(state: SitlState, text: Any, request: Answer) -> Answer:
    """Let something go wrong: `NAME[=VALUE][@WHEN][+DURATION]`, at once without WHEN.

    Args:
        state: of the autopilot; the fault is added.
        text: as above.
        request: `after`, s from now, where the text has no WHEN.

    Raises:
        UsageError: there is no such fault, or its value does not fit.
    """
    found = read_fault(str(text), state.dialect)
    if "@" not in str(text):
        found = found._replace(start=state.now + float(request.get("after", 0.0)))
    state.troubles.add(found)
    return {"ok": True, "at": found.start}


def clear(state: SitlState, name: Any, _: Answer) -> Answer:
    """End the faults of that name, or (`true`) all.

    Args:
        state: of the autopilot.
        name: of the fault, or `true`.
        _: not used.
    """
    state.troubles.clear(None if name is True else str(name))
    return {"ok": True}


def entered(state: SitlState, name: Any, _: Answer) -> Answer:
    """Say that the mission entered a state, for faults that wait for it.

    Args:
        state: of the autopilot.
        name: of the mission's state; only its first entry counts.
        _: not used.
    """
    state.troubles.entered.setdefault(str(name), state.now)
    state.body.entered(str(name), state.now)
    return {"ok": True}


def parameter(state: SitlState, name: Any, request: Answer) -> Answer:
    """Return a parameter, after setting it to `value` if that is given.

    Args:
        state: of the autopilot.
        name: of the parameter, as the dialect spells it.
        request: `value`, a finite number.

    Raises:
        UsageError: no such parameter, or the value is not finite.
    """
    if str(name) not in state.parameters.names:
        raise UsageError(
            f"unknown parameter {name!r}: {nearest(str(name), state.parameters.names)}"
        )
    if "value" in request:
        value = float(request["value"])
        if not math.isfinite(value):
            raise UsageError(f"parameter {name}: {value} is not a finite number")
        state.parameters.set(str(name), value)
    return {"name": name, "value": state.parameters[str(name)]}


Request = Callable[[SitlState, Any, Answer], Answer]
REQUESTS: Mapping[str, Request] = {
    "truth": truth,
    "track": track,
    "journal": journal,
    "time": time,
    "fault": fault,
    "clear": clear,
    "entered": entered,
    "parameter": parameter,
}


def answer(state: SitlState, line: str) -> Answer:
    """Answer one line."""
    try:
        return _answer(state, json.loads(line))
    except RecursionError:
        return {"error": "nested too deeply"}
    except (UsageError, ValueError, TypeError, OverflowError) as error:
        return {"error": str(error)}


def _answer(state: SitlState, request: Any) -> Answer:
    name = next((key for key in request if key in REQUESTS), None)
    if name is None or not isinstance(request, dict):
        raise UsageError(f"expected an object with one of {', '.join([*REQUESTS, 'quit'])}")
    return REQUESTS[name](state, request[name], request)


class ControlSocket:
    """The socket; `wants_end` once a client has sent `{"quit": true}`."""

    def __init__(self, state: SitlState, selector: selectors.BaseSelector, port: int) -> None:
        self.wants_end = False
        self._state = state
        self._selector = selector
        self._socket = socket.create_server(("127.0.0.1", port))
        self._peers: dict[socket.socket, bytearray] = {}
        self.port: int = self._socket.getsockname()[1]
        selector.register(self._socket, selectors.EVENT_READ, self._accept)

    def _accept(self) -> None:
        try:
            peer, _ = self._socket.accept()
        except OSError:  # gone again
            return
        peer.settimeout(READER_TIMEOUT)
        self._peers[peer] = bytearray()
        self._selector.register(peer, selectors.EVENT_READ, lambda: self._read(peer))

    def _read(self, peer: socket.socket) -> None:
        try:
            data = peer.recv(65536)
            self._peers[peer] += data
            if len(self._peers[peer]) > LONGEST_LINE and b"\n" not in self._peers[peer]:
                peer.sendall(b'{"error": "a line that does not end"}\n')
                data = b""
            while data and b"\n" in self._peers[peer]:
                line, _, rest = self._peers[peer].partition(b"\n")
                self._peers[peer] = rest
                peer.sendall(self._answer(line.decode(errors="replace")))
        except OSError:
            data = b""
        if not data:
            self._selector.unregister(peer)
            del self._peers[peer]
            peer.close()

    def _answer(self, line: str) -> bytes:
        if line.replace(" ", "") == '{"quit":true}':
            self.wants_end = True
            return b'{"ok": true}\n'
        return json.dumps(answer(self._state, line)).encode() + b"\n"

    def close(self) -> None:
        """Let go of all sockets."""
        for peer in self._peers:
            peer.close()
        self._socket.close()
