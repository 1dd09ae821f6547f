"""Logs of ArduPilot (.bin), by pymavlink.

https://ardupilot.org/copter/docs/logmessages.html
"""

from __future__ import annotations

import contextlib
import io
import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

from missionkit.geometry import from_euler
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
from missionkit.vehicle.autopilot_dialect import ARDUPILOT, word

ARMED_EVENT, DISARMED_EVENT = 10, 11  # EV.Id
NOT_LANDED_EVENT, LANDED_EVENT = 28, 18


def read_dataflash(path: Path) -> FlightLog:
    """Return what a log of ArduPilot says of the flight.

    Raises:
        ForeignFileError: it cannot be read.
    """
    from pymavlink.DFReader import DFReader_binary  # noqa: PLC0415 - only for logs

    samples: list[Sample] = []
    counts: Counter[str] = Counter()
    began: float | None = None
    with contextlib.redirect_stderr(io.StringIO()), contextlib.redirect_stdout(io.StringIO()):
        try:
            log = DFReader_binary(str(path))
            with log.filehandle, log.data_map:
                while (message := log.recv_msg()) is not None:
                    name, at = message.get_type(), float(message._timestamp)  # noqa: SLF001
                    counts[name] += 1
                    began = at if began is None else began
                    if name in _READERS:
                        samples += _READERS[name](at - began, message)
        except Exception as error:
            raise ForeignFileError("the log is damaged: it cannot be read") from error
    samples = _one_source(samples, counts)
    known = began if began and began > _YEAR else None
    return FlightLog(in_order(samples), known, dict(counts), frozenset(_READERS))


_YEAR = 365.25 * 86_400.0  # s; times below it count from the start of the autopilot


def _one_source(samples: list[Sample], counts: Mapping[str, int]) -> list[Sample]:
    """Keep the fixes of the filter (POS) where there are some, with the receiver's velocity."""
    if "POS" not in counts:
        return samples
    moving, kept = (0.0, 0.0, 0.0), list[Sample]()
    for it in in_order(samples):
        if isinstance(it, Fix) and it.sd != _FILTER:
            moving = it.velocity
        elif isinstance(it, Fix):
            kept.append(it._replace(velocity=moving, sd=None))
        else:
            kept.append(it)
    return kept


_FILTER = -1.0  # stands for the standard deviation of the filter's position


def _gps(at: float, it: Any) -> Iterator[Sample]:
    if getattr(it, "I", 0) == 0 and it.Status >= 3:
        course = math.radians(it.GCrs)
        velocity = it.Spd * math.cos(course), it.Spd * math.sin(course), it.VZ
        yield Fix(at, it.Lat, it.Lng, it.Alt, velocity)


def _pos(at: float, it: Any) -> Iterator[Sample]:
    if it.Lat or it.Lng:
        yield Fix(at, it.Lat, it.Lng, it.Alt, (0.0, 0.0, 0.0), _FILTER)


def _attitude(at: float, it: Any) -> Iterator[Sample]:
    angles = [math.radians(value) for value in (it.Roll, it.Pitch, it.Yaw)]
    if all(map(math.isfinite, angles)):
        yield Turned(at, from_euler(*angles))


def _battery(at: float, it: Any) -> Iterator[Sample]:
    if getattr(it, "Inst", getattr(it, "Instance", 0)) == 0:
        left = getattr(it, "RemPct", None)
        charge = None if left is None or not 0 <= left <= 100 else left / 100.0
        yield Charged(at, charge, float(it.Volt))


def _mode(at: float, it: Any) -> Iterator[Sample]:
    yield Switched(at, word(ARDUPILOT, int(it.ModeNum)))


def _event(at: float, it: Any) -> Iterator[Sample]:
    if it.Id in {ARMED_EVENT, DISARMED_EVENT}:
        yield Switched(at, armed=it.Id == ARMED_EVENT)
    elif it.Id in {NOT_LANDED_EVENT, LANDED_EVENT}:
        yield Switched(at, landed=it.Id == LANDED_EVENT)


def _arm(at: float, it: Any) -> Iterator[Sample]:
    yield Switched(at, armed=bool(it.ArmState))


def _text(at: float, it: Any) -> Iterator[Sample]:
    yield Said(at, str(it.Message))


_READERS: Mapping[str, Callable[[float, Any], Iterator[Sample]]] = {
    "GPS": _gps,
    "POS": _pos,
    "ATT": _attitude,
    "BAT": _battery,
    "MODE": _mode,
    "EV": _event,
    "ARM": _arm,
    "MSG": _text,
}
