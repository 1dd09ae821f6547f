"""Telemetry logs of ground stations (.tlog): MAVLink frames, each after its time of arrival.

Eight bytes, microseconds since 1970, big endian, then the frame as it came.
"""

from __future__ import annotations

import math
import struct
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from missionkit.geometry import from_euler
from missionkit.interchange.flight_logs.log_samples import (
    Charged,
    Fix,
    FlightLog,
    Said,
    Sample,
    Switched,
    Turned,
    in_order,
)
from missionkit.vehicle.autopilot_dialect import dialect_of, word

STAMP = 8  # bytes
V1, V2, SIGNED = 0xFE, 0xFD, 1
STATION = 6  # MAV_TYPE_GCS
ARMED = 128  # MAV_MODE_FLAG_SAFETY_ARMED
ON_GROUND, AIRBORNE = 1, (2, 3, 4)  # MAV_LANDED_STATE
AUTOPILOT = 1  # component


def read_tlog(path: Path) -> FlightLog:
    """Return what a telemetry log says of the first vehicle in it."""
    raw = path.read_bytes()
    samples: list[Sample] = []
    counts: Counter[str] = Counter()
    vehicle: int | None = None
    began: float | None = None
    damaged = 0
    for at, message in _messages(raw):
        if message is None:
            damaged += 1
            continue
        name = message.get_type()
        counts[name] += 1
        began = at if began is None else began
        flies = name == "HEARTBEAT" and message.type != STATION
        if vehicle is None and flies and message.get_srcComponent() == AUTOPILOT:
            vehicle = message.get_srcSystem()
        if message.get_srcSystem() == vehicle and name in _READERS:
            samples += _READERS[name](at - began, message)
    return FlightLog(in_order(samples), began, dict(counts), frozenset(_READERS), damaged)


def _messages(raw: bytes) -> Iterator[tuple[float, Any]]:
    """Yield time (s since 1970) and message of each frame; None for what cannot be read."""
    from missionkit.sitl.pymavlink_dialect import mavlink  # noqa: PLC0415 - only for logs

    decoder = mavlink.MAVLink(None)
    decoder.robust_parsing = True
    position, lost = 0, False
    while position + STAMP + 8 <= len(raw):
        frame = raw[position + STAMP : position + STAMP + _length(raw, position + STAMP)]
        (stamp,) = struct.unpack_from(">Q", raw, position)
        try:
            message = decoder.decode(bytearray(frame)) if frame else None
        except (mavlink.MAVError, struct.error, UnicodeDecodeError, IndexError):
            message = None
        if message is None:
            if not lost:
                yield stamp * 1e-6, None
            lost = True
            position += 1  # the next frame is somewhere behind
            continue
        lost = False
        yield stamp * 1e-6, message
        position += STAMP + len(frame)


def _length(raw: bytes, start: int) -> int:
    """Return how long the frame is that begins there, 0 if none does."""
    magic, payload = raw[start], raw[start + 1]
    if magic == V1:
        return payload + 8
    if magic == V2:
        return payload + 12 + 13 * (raw[start + 2] & SIGNED)
    return 0


def _position(at: float, it: Any) -> Iterator[Sample]:
    if it.lat or it.lon:
        velocity = it.vx / 100.0, it.vy / 100.0, it.vz / 100.0
        yield Fix(at, it.lat / 1e7, it.lon / 1e7, it.alt / 1000.0, velocity)


def _attitude(at: float, it: Any) -> Iterator[Sample]:
    if all(map(math.isfinite, (it.roll, it.pitch, it.yaw))):
        yield Turned(at, from_euler(it.roll, it.pitch, it.yaw))


def _power(at: float, it: Any) -> Iterator[Sample]:
    charge = it.battery_remaining / 100.0
    yield Charged(at, charge if 0.0 <= charge <= 1.0 else None, it.voltage_battery / 1000.0)


def _heartbeat(at: float, it: Any) -> Iterator[Sample]:
    dialect = dialect_of(it.autopilot)
    if it.get_srcComponent() == AUTOPILOT:
        mode = f"mode_{it.custom_mode:x}" if dialect is None else word(dialect, it.custom_mode)
        yield Switched(at, mode, bool(it.base_mode & ARMED))


def _landed(at: float, it: Any) -> Iterator[Sample]:
    if it.landed_state == ON_GROUND or it.landed_state in AIRBORNE:
        yield Switched(at, landed=it.landed_state == ON_GROUND)


def _text(at: float, it: Any) -> Iterator[Sample]:
    text = it.text if isinstance(it.text, str) else it.text.decode("utf-8", "replace")
    yield Said(at, text.rstrip("\0"))


_READERS: Mapping[str, Callable[[float, Any], Iterator[Sample]]] = {
    "GLOBAL_POSITION_INT": _position,
    "ATTITUDE": _attitude,
    "SYS_STATUS": _power,
    "HEARTBEAT": _heartbeat,
    "EXTENDED_SYS_STATE": _landed,
    "STATUSTEXT": _text,
}
