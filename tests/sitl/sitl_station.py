from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missionkit.sim.vehicle_parameters import InnerAutopilotModel as Inner
from missionkit.sim.world import World
from missionkit.sitl.flight_modes import dialect
from missionkit.sitl.geodetic import ZURICH, GeographicPoint
from missionkit.sitl.mavlink_autopilot import MavlinkAutopilot
from missionkit.sitl.wire_faults import read_fault

EXACT = World(world="exact", autopilot=Inner(velocity_sd=0.0, drift=0.0))
NAN = float("nan")
Make = Callable[[], Any]


class Station:
    """A companion on a wire without sockets; time passes only in `run`."""

    def __init__(
        self, name: str, faults: tuple[str, ...], world: World, who: tuple[int, int]
    ) -> None:
        kind = dialect(name)
        self.px4 = name == "px4"
        found = [read_fault(text, kind) for text in faults]
        self.autopilot = MavlinkAutopilot(
            world, kind, 1, found, GeographicPoint(*ZURICH), lambda: 0.0
        )
        self.state = self.autopilot.state
        self.seen: list[Any] = []
        self._mav = mavlink.MAVLink(None, *who)
        self.channel = self.autopilot.connect(self._read)

    def _read(self, data: bytes) -> None:
        self.seen += self._mav.parse_buffer(data) or []

    def send(self, message: Any) -> None:
        data = message.pack(self._mav)
        self._mav.seq = (self._mav.seq + 1) % 256
        self.channel.take(data, self.state.now)
        self.autopilot.listen()

    def run(self, seconds: float, make: Make | None = None, every: float = 0.05) -> None:
        """Let time pass, sending `make()` all the while."""
        end, due = self.state.now + seconds - 1e-9, self.state.now
        while self.state.now < end:
            if make is not None and self.state.now >= due - 1e-9:
                self.send(make())
                due += every
            self.autopilot.step()

    def until(self, condition: Callable[[], bool], limit: float, make: Make | None = None) -> float:
        """Let time pass until something holds; return how long (s) that took."""
        start = self.state.now
        while not condition():
            assert self.state.now - start < limit, "it did not happen in time"
            self.run(0.05, make)
        return self.state.now - start

    def all(self, kind: str) -> list[Any]:
        return [message for message in self.seen if message.get_type() == kind]

    def last(self, kind: str) -> Any:
        return self.all(kind)[-1]

    def command(self, number: int, *params: float) -> int | None:
        """Send COMMAND_LONG; return the result of its acknowledgement."""
        before = len(self.all("COMMAND_ACK"))
        padded = (*params, *(0.0,) * (7 - len(params)))
        self.send(mavlink.MAVLink_command_long_message(1, 1, number, 0, *padded))
        self.autopilot.listen()
        acks = self.all("COMMAND_ACK")[before:]
        return acks[0].result if acks else None

    def mode(self, name: str) -> int | None:
        number = self.state.dialect.named(name).number
        if self.px4:
            return self.command(176, 1, number >> 16 & 255, number >> 24)
        return self.command(176, 1, number)

    def take_off(self, height: float = 5.0) -> None:
        """Arm, climb, and be guided."""
        self.run(1.6)
        if self.px4:
            self.state.parameters.set("MIS_TAKEOFF_ALT", height)
            assert self.command(400, 1) == 0
            assert self.command(22, NAN, NAN, NAN, NAN, NAN, NAN, NAN) == 0
            self.until(lambda: self.state.mode.name == "LOITER", 15)
            self.run(1.5, self.velocity(0, 0, 0))
            assert self.mode("OFFBOARD") == 0
        else:
            assert self.mode("GUIDED") == 0
            assert self.command(400, 1) == 0
            assert self.command(22, 0, 0, 0, 0, 0, 0, height) == 0
            self.until(lambda: self.state.phase == "", 15)
            self.run(1.5)

    @staticmethod
    def velocity(n: float, e: float, d: float, *, frame: int = 1, yaw_rate: float = 0.0) -> Make:
        return lambda: mavlink.MAVLink_set_position_target_local_ned_message(
            0, 1, 1, frame, 0x5C7, 0, 0, 0, n, e, d, 0, 0, 0, 0, yaw_rate
        )

    @property
    def truth(self) -> Any:
        return self.state.body.truth

    @property
    def speed(self) -> float:
        return float(np.linalg.norm(self.truth.velocity))

    @property
    def said(self) -> list[str]:
        return [message.text for message in self.all("STATUSTEXT")]
