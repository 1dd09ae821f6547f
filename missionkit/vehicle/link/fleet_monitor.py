"""What whoever started a fleet learns from the reports of its vehicles."""

from __future__ import annotations

import json
import socket
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

from missionkit.geodesy import Origin
from missionkit.geometry import norm
from missionkit.vehicle.link.clocks import wall
from missionkit.vehicle.link.traffic_link import GO, LOOPBACK, GeodeticReport, waiting

COMPARABLE = 0.5  # s between two reports that are compared


class ReportedEncounter(NamedTuple):
    """How near two vehicles came to each other in the air, by their own reports."""

    first: str
    second: str
    least: float  # m
    at: float  # s since the start
    conflicts: int
    duration: float  # s, of those


@dataclass(slots=True)
class _Pair:
    """Two vehicles so far."""

    least: float
    at: float
    conflicts: int = 0
    duration: float = 0.0
    near_since: float | None = None


class FleetMonitor:
    """Hears all vehicles of a fleet and lets them begin together.

    Args:
        names: of the vehicles.
        separation: m, nearer than which two are in conflict.
    """

    def __init__(self, names: Sequence[str], separation: float) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind((LOOPBACK, 0))
        self.socket.setblocking(False)  # noqa: FBT003 - its only argument
        self.ready: set[str] = set()
        self._separation = separation
        self._newest: dict[str, GeodeticReport | None] = dict.fromkeys(names)
        self._pairs: dict[tuple[str, str], _Pair] = {}
        self._began = wall()

    @property
    def port(self) -> int:
        """Port that vehicles report to."""
        return int(self.socket.getsockname()[1])

    def let_begin(self, ports: Sequence[int]) -> None:
        """Let vehicles that wait begin."""
        for port in ports:
            with suppress(OSError):  # it has gone
                self.socket.sendto(GO, (LOOPBACK, port))

    def listen(self) -> None:
        """Take in what has arrived."""
        for data in waiting(self.socket):
            with suppress(ValueError, KeyError, TypeError, AttributeError):  # of a stranger
                self._take(data)

    def encounters(self) -> tuple[ReportedEncounter, ...]:
        """Return the encounters of all pairs that were in the air together."""
        return tuple(
            ReportedEncounter(one, other, it.least, it.at, it.conflicts, it.duration)
            for (one, other), it in self._pairs.items()
        )

    def close(self) -> None:
        """Let go of the socket."""
        self.socket.close()

    def _take(self, data: bytes) -> None:
        message = json.loads(data)
        if message.get("ready") in self._newest:
            self.ready.add(message["ready"])
        if "report" not in message:
            return
        report = GeodeticReport.read(message["report"])
        if report.name not in self._newest:
            return
        self._newest[report.name] = report
        for one, other in combinations(self._newest, 2):
            if report.name in {one, other}:
                self._compare(one, other)

    def _compare(self, one: str, other: str) -> None:
        first, second = self._newest[one], self._newest[other]
        if first is None or second is None or abs(first.stamp - second.stamp) > COMPARABLE:
            return
        if not (first.in_air and second.in_air):
            return
        origin = Origin(first.latitude, first.longitude, first.altitude)
        now = max(first.stamp, second.stamp)
        places = [it.seen_from(origin, now - it.stamp) for it in (first, second)]
        apart = norm(
            places[0].position
            + places[0].velocity * places[0].at
            - places[1].position
            - places[1].velocity * places[1].at
        )
        self._note((one, other), apart, now)

    def _note(self, names: tuple[str, str], apart: float, stamp: float) -> None:
        pair = self._pairs.setdefault(names, _Pair(apart, stamp - self._began))
        if apart < pair.least:
            pair.least, pair.at = apart, stamp - self._began
        if apart >= self._separation:
            pair.near_since = None
        elif pair.near_since is None:
            pair.conflicts, pair.near_since = pair.conflicts + 1, stamp
        else:
            pair.duration, pair.near_since = pair.duration + stamp - pair.near_since, stamp
