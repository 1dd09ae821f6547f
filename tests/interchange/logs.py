"""Small logs, written as autopilots write them: up, 60 m north, back to the ground."""

from __future__ import annotations

import math
import struct
from collections.abc import Iterator
from pathlib import Path

from pymavlink.dialects.v20 import ardupilotmega as mavlink

LAT, LON, ALT = 47.3977, 8.5456, 488.0
BEGAN = 1_750_000_000.0  # s since 1970
SECONDS, RATE = 40, 5


def flight() -> Iterator[tuple[float, float, float, bool]]:
    """Yield time (s), metres north, height (m), armed."""
    for step in range(SECONDS * RATE):
        at = step / RATE
        up = 20.0 * max(0.0, min(1.0, (at - 2.0) / 6.0, (36.0 - at) / 6.0))
        north = 60.0 * max(0.0, min(1.0, (at - 10.0) / 15.0))
        yield at, north, up, 1.0 <= at < 38.0


def latitude(north: float) -> float:
    return LAT + north / 111_194.0


def mode_of(at: float) -> str:
    return "hold" if at < 2 else "mission" if at < 30 else "land"


def ulog(path: Path) -> Path:
    """Write a ULog of PX4."""
    formats = {
        "vehicle_global_position": (
            "uint64_t timestamp;double lat;double lon;float alt;float eph",
            "<Qddff",
        ),
        "vehicle_attitude": ("uint64_t timestamp;float[4] q", "<Q4f"),
        "battery_status": ("uint64_t timestamp;float voltage_v;float remaining", "<Qff"),
        "vehicle_status": ("uint64_t timestamp;uint8_t arming_state;uint8_t nav_state", "<QBB"),
        "vehicle_gps_position": ("uint64_t timestamp;uint64_t time_utc_usec", "<QQ"),
        "actuator_outputs": ("uint64_t timestamp;float output", "<Qf"),
    }
    out = bytearray(b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0))

    def put(kind: bytes, data: bytes) -> None:
        out.extend(struct.pack("<HB", len(data), kind[0]) + data)

    put(b"B", bytes(40))
    for name, (fields, _) in formats.items():
        put(b"F", f"{name}:{fields};".encode())
    ids = {name: number for number, name in enumerate(formats)}
    for name, number in ids.items():
        put(b"A", struct.pack("<BH", 0, number) + name.encode())

    def say(name: str, at: float, *values: float) -> None:
        stamp = int((at + 100.0) * 1e6)
        put(b"D", struct.pack("<H", ids[name]) + struct.pack(formats[name][1], stamp, *values))

    modes = {"hold": 4, "mission": 3, "land": 18}
    for at, north, up, armed in flight():
        if at == 3.0:
            put(b"L", b"6" + struct.pack("<Q", int((at + 100.0) * 1e6)) + b"Takeoff detected")
        say("vehicle_status", at, 2 if armed else 1, modes[mode_of(at)])
        say("battery_status", at, 16.0 - 0.02 * at, 0.9 - 0.01 * at)
        say("vehicle_attitude", at, math.cos(0.25), 0.0, 0.0, math.sin(0.25))
        say("vehicle_gps_position", at, int((BEGAN + at) * 1e6))
        say("vehicle_global_position", at, latitude(north), LON, ALT + up, 0.4)
        say("actuator_outputs", at, 0.5)
    path.write_bytes(bytes(out))
    return path


def tlog(path: Path) -> Path:
    """Write a telemetry log, with a ground station and another vehicle in it."""
    vehicle, station = mavlink.MAVLink(None, 7, 1), mavlink.MAVLink(None, 255, 190)
    other = mavlink.MAVLink(None, 9, 1)
    out = bytearray()

    def put(at: float, message: mavlink.MAVLink_message, of: mavlink.MAVLink) -> None:
        out.extend(struct.pack(">Q", int((BEGAN + at) * 1e6)) + message.pack(of))

    modes = {"hold": 5, "mission": 3, "land": 9}  # LOITER, AUTO, LAND of ArduCopter
    for at, north, up, armed in flight():
        put(at, mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 0, 3), station)
        beat = (2, 3, 128 * armed, modes[mode_of(at)], 4, 3)
        put(at, mavlink.MAVLink_heartbeat_message(*beat), vehicle)
        place = (int(1000 * at), int(latitude(north) * 1e7), int(LON * 1e7))
        motion = (int(1000 * (ALT + up)), int(1000 * up), 400, 0, 0, 0)
        put(at, mavlink.MAVLink_global_position_int_message(*place, *motion), vehicle)
        put(at, mavlink.MAVLink_global_position_int_message(0, 1, 1, *motion), other)
        put(at, mavlink.MAVLink_attitude_message(int(1000 * at), 0, 0, 0.5, 0, 0, 0), vehicle)
        power = (0, 0, 0, 0, int(16000 - 20 * at), 100, int(90 - at), 0, 0, 0, 0, 0, 0)
        put(at, mavlink.MAVLink_sys_status_message(*power), vehicle)
    put(3.0, mavlink.MAVLink_statustext_message(4, b"Takeoff detected"), vehicle)
    path.write_bytes(bytes(out))
    return path


def dataflash(path: Path) -> Path:
    """Write a log of ArduPilot."""
    out = bytearray()
    kinds = {
        "FMT": (128, "BBnNZ", "Type,Length,Name,Format,Columns", "<BB4s16s64s"),
        "GPS": (
            130,
            "QBBIHBcLLeffff",
            "TimeUS,I,Status,GMS,GWk,NSats,HDop,Lat,Lng,Alt,Spd,GCrs,VZ,Yaw",
            "<QBBIHBhiiiffff",
        ),
        "ATT": (131, "Qffffff", "TimeUS,DesRoll,Roll,DesPitch,Pitch,DesYaw,Yaw", "<Q6f"),
        "BAT": (132, "QBff", "TimeUS,Inst,Volt,RemPct", "<QBff"),
        "MODE": (133, "QMBB", "TimeUS,Mode,ModeNum,Rsn", "<QBBB"),
        "ARM": (134, "QB", "TimeUS,ArmState", "<QB"),
        "MSG": (135, "QZ", "TimeUS,Message", "<Q64s"),
        "PM": (136, "QI", "TimeUS,NLon", "<QI"),
    }

    def put(name: str, *values: object) -> None:
        number, _, _, layout = kinds[name]
        out.extend(b"\xa3\x95" + bytes([number]) + struct.pack(layout, *values))

    for name, (number, form, labels, layout) in kinds.items():
        size = struct.calcsize(layout) + 3
        put("FMT", number, size, name.encode(), form.encode(), labels.encode())
    modes = {"hold": 5, "mission": 3, "land": 9}
    before: object = None
    was_armed = False
    week, milli = divmod(BEGAN - 315_964_800 + 18, 604_800)
    for at, north, up, armed in flight():
        micro = int((at + 50.0) * 1e6)
        mode = mode_of(at)
        gps = (micro, 0, 3, int((milli + at) * 1000), int(week), 12, 80, int(latitude(north) * 1e7))
        put("GPS", *gps, int(LON * 1e7), int((ALT + up) * 100), 4.0, 0.0, 0.0, 0.0)
        if mode != before:
            put("MODE", micro, modes[mode], modes[mode], 1)
        if armed != was_armed:
            put("ARM", micro, armed)
        before, was_armed = mode, armed
        if at == 3.0:
            put("MSG", micro, b"Takeoff detected")
        put("ATT", micro, 0, 0, 0, 0, 0, math.degrees(0.5))
        put("BAT", micro, 0, 16.0 - 0.02 * at, 90.0 - at)
        put("PM", micro, 1)
    path.write_bytes(bytes(out))
    return path
