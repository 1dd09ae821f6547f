"""MAVLink frames: found in bytes, and the few messages that matter here read and written.

https://mavlink.io/en/guide/serialization.html (both versions, the checksum, truncated zeros);
fields and CRC_EXTRA are those of common.xml. All other messages are passed on unread.
"""

from __future__ import annotations

import struct
from typing import NamedTuple

from missionkit.vehicle.autopilot_dialect import VELOCITY_MASK

V1, V2 = 0xFE, 0xFD  # first byte of a frame
SIGNED_FLAG = 0x01  # MAVLINK_IFLAG_SIGNED: 13 bytes more
SHORTEST = 8  # bytes, of a frame
HEARTBEAT, SET_MODE_MESSAGE, LOCAL_POSITION, COMMAND_INT, COMMAND_LONG = 0, 11, 32, 75, 76
ATTITUDE_TARGET, LOCAL_TARGET, GLOBAL_TARGET = 82, 84, 86
SETPOINTS = frozenset((ATTITUDE_TARGET, LOCAL_TARGET, GLOBAL_TARGET))
CRC_EXTRA = {  # CRC_EXTRA, of the messages that are read or written
    HEARTBEAT: 50,
    SET_MODE_MESSAGE: 89,
    LOCAL_POSITION: 185,
    COMMAND_INT: 158,
    COMMAND_LONG: 152,
    ATTITUDE_TARGET: 49,
    LOCAL_TARGET: 143,
    GLOBAL_TARGET: 5,
}
WHOLE_PAYLOAD = 64  # bytes; zeros at the end of a payload are not sent
FRAME_NED = 1  # MAV_FRAME_LOCAL_NED


class MavlinkFrame(NamedTuple):
    """A message that is read here, as it came: intact, zeros at its end restored."""

    ident: int
    system: int
    component: int
    payload: bytes


class HeartbeatContent(NamedTuple):
    """Content of a heartbeat."""

    mode: int  # custom_mode
    autopilot: int  # MAV_AUTOPILOT
    armed: bool


class FrameRoute(NamedTuple):
    """Sender and recipient of one of our frames."""

    system: int
    component: int
    target: int
    target_component: int


def split(data: bytes) -> tuple[list[bytes], bytes]:
    """Return the whole frames in `data`, and the bytes at its end that begin another.

    What lies between frames is dropped; no checksum is looked at.
    """
    size = len(data)
    if size > SHORTEST and size == _length(data, 0, data[0]):  # a datagram of one frame
        return [data], b""
    found: list[bytes] = []
    at = 0
    while at < size:
        first = data[at]
        if first not in {V1, V2}:
            at += 1
            continue
        stop = at + _length(data, at, first)
        if stop > size:
            break
        found.append(data[at:stop])
        at = stop
    return found, data[at:]


def _length(data: bytes, at: int, first: int) -> int:
    """Return the length of the frame at `at`; more than there is when its header is cut."""
    if at + 3 > len(data):
        return SHORTEST
    if first == V2:
        return data[at + 1] + (25 if data[at + 2] & SIGNED_FLAG else 12)
    return data[at + 1] + 8 if first == V1 else 0


def ident_of(frame: bytes) -> int:
    """Return the message id of a whole frame."""
    if frame[0] == V1:
        return frame[5]
    return frame[7] | frame[8] << 8 | frame[9] << 16


def read(frame: bytes) -> MavlinkFrame | None:
    """Return the message in a whole frame, None for one that is not read here, or is damaged."""
    ident = ident_of(frame)
    if ident not in CRC_EXTRA:
        return None
    head = 6 if frame[0] == V1 else 10
    stop = head + frame[1]
    if checksum(frame[1:stop], CRC_EXTRA[ident]) != frame[stop] | frame[stop + 1] << 8:
        return None
    system, component = (frame[3], frame[4]) if frame[0] == V1 else (frame[5], frame[6])
    return MavlinkFrame(ident, system, component, frame[head:stop].ljust(WHOLE_PAYLOAD, b"\0"))


def beat(frame: MavlinkFrame) -> HeartbeatContent:
    """Return what a HEARTBEAT says."""
    mode, _, autopilot, base = struct.unpack_from("<IBBB", frame.payload)
    return HeartbeatContent(mode, autopilot, bool(base & 0x80))


def speed(frame: MavlinkFrame) -> float:
    """Return the speed over ground (m/s) in a LOCAL_POSITION_NED."""
    north, east = struct.unpack_from("<ff", frame.payload, 16)
    return float((north * north + east * east) ** 0.5)


def order(frame: MavlinkFrame) -> tuple[int, float, float]:
    """Return a COMMAND_LONG's or COMMAND_INT's MAV_CMD, and its first two parameters."""
    command = struct.unpack_from("<H", frame.payload, 28)[0]
    first, second = struct.unpack_from("<ff", frame.payload)
    return command, first, second


def target(frame: MavlinkFrame) -> tuple[int, int]:
    """Return which system and component a setpoint is for."""
    at = 36 if frame.ident == ATTITUDE_TARGET else 50
    return frame.payload[at], frame.payload[at + 1]


def still(to: FrameRoute, sequence: int, millis: int) -> bytes:
    """Return a SET_POSITION_TARGET_LOCAL_NED of no velocity and no yaw rate.

    Args:
        to: sender and recipient.
        sequence: 0 to 255.
        millis: since boot, as the frame wants it; it wraps.
    """
    ends = (VELOCITY_MASK, to.target, to.target_component, FRAME_NED)
    payload = struct.pack("<I11fHBBB", millis & 0xFFFFFFFF, *(0.0,) * 11, *ends)
    return _packed(LOCAL_TARGET, payload, to, sequence)


def mode(to: FrameRoute, sequence: int, params: tuple[float, float, float], again: int) -> bytes:
    """Return a COMMAND_LONG for MAV_CMD_DO_SET_MODE, asked for the `again`-th time.

    Args:
        to: sender and recipient.
        sequence: 0 to 255.
        params: the command's first three: base mode, custom mode, sub-mode.
        again: 0 for the first time.
    """
    numbers = (*params, 0.0, 0.0, 0.0, 0.0)
    ends = (176, to.target, to.target_component, min(again, 255))
    return _packed(COMMAND_LONG, struct.pack("<7fHBBB", *numbers, *ends), to, sequence)


def _packed(ident: int, payload: bytes, to: FrameRoute, sequence: int) -> bytes:
    short = payload.rstrip(b"\0") or payload[:1]
    header = struct.pack(
        "<BBBBBBHB", len(short), 0, 0, sequence & 0xFF, to.system, to.component, ident, 0
    )
    body = header + short
    return bytes((V2,)) + body + struct.pack("<H", checksum(body, CRC_EXTRA[ident]))


def _table() -> tuple[int, ...]:
    table = []
    for byte in range(256):
        value = byte
        for _ in range(8):
            value = value >> 1 ^ 0x8408 if value & 1 else value >> 1
        table.append(value)
    return tuple(table)


_X25 = _table()  # CRC-16/MCRF4XX, reflected polynomial 0x1021


def checksum(data: bytes, extra: int) -> int:
    """Return MAVLink's checksum of a frame without its first byte, with the message's CRC_EXTRA."""
    value = 0xFFFF
    for byte in data:
        value = value >> 8 ^ _X25[(value ^ byte) & 0xFF]
    return value >> 8 ^ _X25[(value ^ extra) & 0xFF]
