"""Reports of position between the processes that fly a fleet from one computer.

JSON datagrams on loopback, ten times a second, to every other vehicle and to whoever started the
fleet. Positions are geodetic, so that each vehicle may measure from an origin of its own. Stamps
are of the computer's monotonic clock, which its processes share: a report that waited is as old as
it is.
"""

from __future__ import annotations

import json
import math
import socket
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from typing import Any, NamedTuple

import numpy as np

from missionkit.errors import UsageError
from missionkit.estimation.own_report import own_report
from missionkit.geodesy import Origin
from missionkit.messages import OtherVehicle, Record, TrafficReport
from missionkit.vehicle.link.clocks import wall

REPORTS_EVERY = 0.1  # s
LOOPBACK = "127.0.0.1"
LARGEST = 2048  # bytes of a report
LAST_WORDS = 3  # times that the end is said
GO = b"go"


class FleetPlace(NamedTuple):
    """Where a process stands in its fleet: plain values, passed on as JSON."""

    name: str
    descriptor: int  # of its socket, which it has inherited
    others: Mapping[str, int]  # ports of the other vehicles, by name
    starter: int  # port of whoever started the fleet

    @classmethod
    def read(cls, text: str) -> FleetPlace:
        """Return the place that `write` has written.

        Raises:
            UsageError: it is none.
        """
        try:
            return cls(**json.loads(text))
        except (ValueError, TypeError) as error:
            raise UsageError("--fleet-place is for `missionkit fleet` to give") from error

    def write(self) -> str:
        """Return it as text."""
        return json.dumps(self._asdict())


class GeodeticReport(NamedTuple):
    """A report as it is sent."""

    name: str
    stamp: float  # s, monotonic, when it was valid
    latitude: float  # deg
    longitude: float  # deg
    altitude: float  # m above mean sea level
    velocity: tuple[float, float, float]  # m/s, NED
    in_air: bool

    @classmethod
    def read(cls, fields: Mapping[str, Any]) -> GeodeticReport:
        """Return the report in a message.

        Raises:
            ValueError: it is none.
        """
        north, east, down = map(float, fields["velocity"])
        found = cls(
            str(fields["name"]),
            float(fields["stamp"]),
            float(fields["latitude"]),
            float(fields["longitude"]),
            float(fields["altitude"]),
            (north, east, down),
            bool(fields["in_air"]),
        )
        if not all(map(math.isfinite, (*found[1:5], *found.velocity))):
            raise ValueError("a number that is not finite")
        return found

    def seen_from(self, origin: Origin, at: float) -> TrafficReport:
        """Return the report in a world in metres.

        Args:
            origin: of that world.
            at: s, of its time, when it was valid.
        """
        position = origin.local(self.latitude, self.longitude, self.altitude)
        return TrafficReport(at, position, np.array(self.velocity), self.in_air)


def waiting(inbox: socket.socket) -> Iterator[bytes]:
    """Yield the datagrams that have arrived on a socket that does not block."""
    while True:
        try:
            yield inbox.recv(LARGEST)
        except BlockingIOError:
            return
        except OSError:  # an answer to what was sent to a process that has gone
            continue


class TrafficLink:
    """One vehicle's end.

    Args:
        place: of the vehicle in its fleet.
        pace: seconds of mission time in one of the wall.
    """

    def __init__(self, place: FleetPlace, pace: float = 1.0) -> None:
        self._name = place.name
        self._pace = pace
        self._socket = socket.socket(fileno=place.descriptor)
        self._socket.setblocking(False)  # noqa: FBT003 - its only argument
        self._starter = place.starter
        self._ports = (*place.others.values(), place.starter)
        self._newest: dict[str, GeodeticReport | None] = dict.fromkeys(place.others)
        self._ended: set[str] = set()
        self._reported = -math.inf
        self.started = False

    def tell(self, record: Record, origin: Origin | None) -> None:
        """Report this vehicle after a tick, if it is time and it knows where it is.

        Args:
            record: of the tick.
            origin: of its world, if that is known.
        """
        at = wall()
        report = own_report(record.estimate)
        if origin is None or report is None or at - self._reported < REPORTS_EVERY - 0.01:
            return
        self._reported = at
        latitude, longitude, altitude = origin.place(report.position)
        north, east, down = report.velocity.tolist()
        sent = GeodeticReport(
            self._name,
            at,
            latitude,
            longitude,
            altitude,
            velocity=(north, east, down),
            in_air=report.in_air,
        )
        self._send({"report": sent._asdict()}, self._ports)

    def others(self, now: float, origin: Origin | None) -> tuple[OtherVehicle, ...]:
        """Return what has been heard of the other vehicles.

        Args:
            now: s, mission time.
            origin: of this vehicle's world; nothing is known of the others without.
        """
        self._listen()
        at = wall()
        return tuple(
            OtherVehicle(
                name,
                None
                if newest is None or origin is None
                else newest.seen_from(origin, now - self._pace * (at - newest.stamp)),
                name in self._ended,
            )
            for name, newest in self._newest.items()
        )

    def ready(self) -> None:
        """Say to whoever started the fleet that this vehicle could begin; `started` answers."""
        self._send({"ready": self._name}, (self._starter,))
        self._listen()

    def end(self) -> None:
        """Say that this vehicle's flight is over: it is on the ground and will stay there."""
        for _ in range(LAST_WORDS):
            self._send({"ended": self._name}, self._ports)

    def close(self) -> None:
        """Fall silent."""
        self._socket.close()

    def _send(self, message: Mapping[str, Any], ports: Sequence[int]) -> None:
        data = json.dumps(message).encode()
        for port in ports:
            with suppress(OSError):  # whoever has gone hears nothing
                self._socket.sendto(data, (LOOPBACK, port))

    def _listen(self) -> None:
        for data in waiting(self._socket):
            if data == GO:
                self.started = True
                continue
            with suppress(ValueError, KeyError, TypeError, AttributeError):  # of a stranger
                self._take(json.loads(data))

    def _take(self, message: Mapping[str, Any]) -> None:
        if message.get("ended") in self._newest:
            self._ended.add(message["ended"])
        if "report" in message:
            report = GeodeticReport.read(message["report"])
            before = self._newest.get(report.name)
            late = before is not None and report.stamp <= before.stamp
            if report.name in self._newest and not late:
                self._newest[report.name] = report
