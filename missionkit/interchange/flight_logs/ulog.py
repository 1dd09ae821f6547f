"""Logs of PX4 (ULog), by pyulog.

https://docs.px4.io/main/en/dev_log/ulog_file_format.html
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from missionkit.geodesy import Origin
from missionkit.geometry import vec
from missionkit.interchange.bounded_input import ForeignFileError
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

MODES: Mapping[int, str] = MappingProxyType(
    {
        **{0: "manual", 1: "altitude", 2: "position", 3: "mission", 4: "hold", 5: "return"},
        **{10: "acro", 12: "descend", 13: "termination", 14: "offboard", 15: "stabilized"},
        **{17: "take_off", 18: "land", 19: "follow", 20: "precision_land", 21: "orbit"},
    }
)
"""Words for vehicle_status.nav_state, as for the modes over MAVLink."""
ARMED = 2  # vehicle_status.arming_state
MICRO = 1e-6


def read_ulog(path: Path) -> FlightLog:
    """Return what a ULog says of the flight.

    Raises:
        ForeignFileError: it cannot be read.
    """
    from pyulog import ULog  # noqa: PLC0415 - only for logs

    try:
        log = ULog(str(path))
    except Exception as error:
        raise ForeignFileError("the ULog is damaged: it cannot be read") from error
    samples: list[Sample] = []
    counts: dict[str, int] = {}
    for dataset in log.data_list:
        counts[dataset.name] = counts.get(dataset.name, 0) + len(dataset.data["timestamp"])
        if dataset.multi_id == 0 and dataset.name in _READERS:
            samples += _READERS[dataset.name](dataset.data)
    samples += [Said(it.timestamp * MICRO, str(it.message)) for it in log.logged_messages]
    counts["logged messages"] = len(log.logged_messages)
    if any(isinstance(it, Fix) for it in samples) and "vehicle_local_position" in counts:
        samples = _one_source(samples, log)
    used = frozenset({*_READERS, "logged messages", "vehicle_gps_position"})
    return FlightLog(in_order(samples), _began(log), counts, used, int(log.file_corruption))


def _one_source(samples: list[Sample], log: Any) -> list[Sample]:
    """Keep the fixes of the global position, if there are some: they know the altitude."""
    names = {it.name for it in log.data_list}
    if "vehicle_global_position" not in names:
        return samples
    fixed = [it for it in samples if isinstance(it, Fix)]
    moving = {round(it.at, 1): it.velocity for it in fixed if it.sd == _LOCAL}
    kept: list[Sample] = [it for it in samples if not isinstance(it, Fix)]
    for it in fixed:
        if it.sd != _LOCAL:
            kept.append(it._replace(velocity=moving.get(round(it.at, 1), it.velocity)))
    return kept


_LOCAL = -1.0  # stands for the standard deviation of a local position


def _began(log: Any) -> float | None:
    for dataset in log.data_list:
        if dataset.name == "vehicle_gps_position" and "time_utc_usec" in dataset.data:
            for at, utc in zip(
                dataset.data["timestamp"], dataset.data["time_utc_usec"], strict=True
            ):
                if utc > 0:
                    return float(utc - at) * MICRO
    return None


def _columns(data: Mapping[str, Any], *names: str) -> Iterator[tuple[float, ...]]:
    """Yield time (s) and fields of each row whose numbers are finite."""
    zero = np.zeros(len(data["timestamp"]))
    rows = np.column_stack(
        [np.asarray(data.get(name, zero), float) for name in ("timestamp", *names)]
    )
    for row in rows[np.isfinite(rows).all(axis=1)].tolist():
        yield (row[0] * MICRO, *row[1:])


def _local(data: Mapping[str, Any]) -> Iterator[Sample]:
    names = ("x", "y", "z", "vx", "vy", "vz", "ref_lat", "ref_lon", "ref_alt")
    for at, x, y, z, vx, vy, vz, lat, lon, alt in _columns(data, *names):
        if lat or lon:
            place = Origin(lat, lon, alt).place(vec(x, y, z))
            yield Fix(at, *place, (vx, vy, vz), _LOCAL)


def _global(data: Mapping[str, Any]) -> Iterator[Sample]:
    known = "eph" in data
    for at, lat, lon, alt, sd in _columns(data, "lat", "lon", "alt", "eph"):
        yield Fix(at, lat, lon, alt, (0.0, 0.0, 0.0), sd if known else None)


def _attitude(data: Mapping[str, Any]) -> Iterator[Sample]:
    for at, *quaternion in _columns(data, "q[0]", "q[1]", "q[2]", "q[3]"):
        yield Turned(at, np.array(quaternion))


def _battery(data: Mapping[str, Any]) -> Iterator[Sample]:
    for at, charge, voltage in _columns(data, "remaining", "voltage_v"):
        yield Charged(at, charge if 0.0 <= charge <= 1.0 else None, voltage)


def _status(data: Mapping[str, Any]) -> Iterator[Sample]:
    before = None
    for at, mode, arming in _columns(data, "nav_state", "arming_state"):
        now = MODES.get(int(mode), f"mode_{int(mode)}"), int(arming) == ARMED
        if now != before:
            yield Switched(at, *now)
        before = now


def _landed(data: Mapping[str, Any]) -> Iterator[Sample]:
    for at, landed in _columns(data, "landed"):
        yield Switched(at, landed=bool(landed))


_READERS: Mapping[str, Callable[[Mapping[str, Any]], Iterator[Sample]]] = {
    "vehicle_local_position": _local,
    "vehicle_global_position": _global,
    "vehicle_attitude": _attitude,
    "battery_status": _battery,
    "vehicle_status": _status,
    "vehicle_land_detected": _landed,
}
