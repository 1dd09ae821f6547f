"""Downward-looking sensors: optical flow and range finders.

    OPTICAL_FLOW_RAD (106)   integrals over an interval, rad: PX4
    OPTICAL_FLOW (100)       rates, rad/s, in its fields flow_rate: ArduPilot
    DISTANCE_SENSOR (132)    cm; only those that face down

MAVLink's flow about an axis is positive where a right-handed turn about it is, so a vehicle that
moves along +y has a negative one about x, and along +x a positive one about y. In the terms of
`OpticalFlow` the image moves by (-about y, about x).  Source: MAVLink common.xml.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from missionkit.geometry import Vec3
from missionkit.messages import OpticalFlow, Range
from missionkit.vehicle.link.message_cache import Fields
from missionkit.vehicle.telemetry import message_readings
from missionkit.vehicle.telemetry.ordered_arrivals import Timed

DOWN = 25  # MAV_SENSOR_ROTATION_PITCH_270
BEST_FLOW = 255.0
INVALID_RANGE = 1  # signal_quality
LONGEST_INTEGRATION = 0.5  # s; a longer interval is a hole
SENSOR_SWITCH_AFTER = 0.5  # s after which another sensor takes over
NO_FLOW = np.zeros(2)
UNFILLED = "OPTICAL_FLOW has no flow_rate_x and flow_rate_y (rad/s): its sender is too old"


def integrated_flow(fields: Fields, at: float) -> OpticalFlow | None:
    """Return the flow of OPTICAL_FLOW_RAD whose interval ended `at` (s), None: it has no length."""
    over = 1e-6 * float(fields["integration_time_us"])
    if not 0.0 < over <= LONGEST_INTEGRATION:
        return None
    about = message_readings.triple(fields, "integrated_x", "integrated_y")
    turned = message_readings.triple(
        fields, "integrated_xgyro", "integrated_ygyro", "integrated_zgyro"
    )
    rates = None if turned is None else turned / over
    return _flow(at, None if about is None else about / over, rates, over, fields)


def flow_rate(fields: Fields, at: float, over: float) -> OpticalFlow | None:
    """Return the flow of OPTICAL_FLOW, None if it does not tell it as a rate.

    Args:
        fields: of the message.
        at: when it was measured (s).
        over: since the message before (s).
    """
    if unfilled(fields):
        return None
    about = message_readings.triple(fields, "flow_rate_x", "flow_rate_y")
    return _flow(at, about, None, min(over, LONGEST_INTEGRATION), fields)


def unfilled(fields: Fields) -> bool:
    """Say whether an OPTICAL_FLOW tells pixels only, which mean nothing without the lens."""
    rates = (fields.get("flow_rate_x"), fields.get("flow_rate_y"))
    return not any(rates) and bool(fields["flow_x"] or fields["flow_y"])


def joined(flows: Sequence[OpticalFlow]) -> OpticalFlow | None:
    """Return the mean of successive flows over all their intervals; those without sight are left.

    >>> joined([]) is None
    True
    """
    good = [flow for flow in flows if flow.quality > 0.0]
    if len(good) < 2:
        return good[0] if good else flows[-1] if flows else None
    over = sum(flow.over for flow in good)
    rates = [flow.over * flow.rates for flow in good if flow.rates is not None]
    mean: Vec3 | None = np.sum(rates, axis=0) / over if len(rates) == len(good) else None
    passed = np.sum([flow.over * flow.flow for flow in good], axis=0) / over
    return OpticalFlow(good[-1].at, passed, mean, over, min(flow.quality for flow in good))


def faces_down(fields: Fields) -> bool:
    """Say whether a DISTANCE_SENSOR looks at the ground."""
    return int(fields["orientation"]) == DOWN


def ground_range(fields: Fields, at: float) -> Range | None:
    """Return the range of a DISTANCE_SENSOR, None where it is out of reach or not valid."""
    distance = int(fields["current_distance"])
    if not int(fields["min_distance"]) <= distance <= int(fields["max_distance"]):
        return None
    if int(fields.get("signal_quality", 0)) == INVALID_RANGE:
        return None
    return Range(at, 0.01 * distance)


class GroundSensors:
    """Chooses among several sensors of a kind: the one with the lowest id that works."""

    def __init__(self) -> None:
        self.problems: list[str] = []
        self._worked: dict[tuple[str, int], float] = {}  # (kind, id) -> s, last good reading
        self._before: dict[int, float] = {}  # id -> s, of the OPTICAL_FLOW before

    def range(self, due: Iterable[Timed]) -> Range | None:
        """Return the newest range down of some DISTANCE_SENSOR."""
        found = None
        for fields, at in due:
            reading = ground_range(fields, at) if faces_down(fields) else None
            if reading is not None and self._counts("range", int(fields["id"]), at):
                found = reading
        return found

    def flow(self, integrals: Iterable[Timed], rates: Iterable[Timed]) -> OpticalFlow | None:
        """Return the flow of some OPTICAL_FLOW_RAD, or else of some OPTICAL_FLOW."""
        flows = []
        for fields, at in integrals:
            ident, flow = int(fields["sensor_id"]), integrated_flow(fields, at)
            if flow is not None and self._counts("flow", ident, at):
                flows.append(flow)
        for fields, at in rates:
            ident = int(fields["sensor_id"])
            before, self._before[ident] = self._before.get(ident), at
            if unfilled(fields):
                self.problems.append(UNFILLED)
            if before is None or at <= before or not self._counts("flow", 256 + ident, at):
                continue
            flow = flow_rate(fields, at, at - before)
            flows += [] if flow is None else [flow]
        return joined(flows)

    def _counts(self, kind: str, ident: int, at: float) -> bool:
        """Note a good reading; say whether no sensor with a lower id had one recently."""
        self._worked[kind, ident] = at
        return not any(
            which == kind and other < ident and at - last <= SENSOR_SWITCH_AFTER
            for (which, other), last in self._worked.items()
        )


def _flow(
    at: float, about: Vec3 | None, rates: Vec3 | None, over: float, fields: Fields
) -> OpticalFlow:
    """Return the flow of rates about the body's x and y (2,), rad/s; None: nothing was seen."""
    if about is None:
        return OpticalFlow(at, NO_FLOW, rates, over, 0.0)
    quality = float(fields["quality"]) / BEST_FLOW
    return OpticalFlow(at, np.array((-about[1], about[0])), rates, over, quality)
