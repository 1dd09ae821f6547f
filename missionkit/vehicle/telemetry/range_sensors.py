"""Readings of obstacle and ground sensors; there may be several of a kind."""

from __future__ import annotations

from collections import deque

from missionkit.geometry import Quat
from missionkit.messages import OpticalFlow, Range, Scan
from missionkit.vehicle.telemetry import message_readings, obstacle_ring
from missionkit.vehicle.telemetry.ground_sensors import GroundSensors
from missionkit.vehicle.telemetry.obstacle_ring import Ring
from missionkit.vehicle.telemetry.ordered_arrivals import Arrivals

ATTITUDES_KEPT = 64  # attitudes kept, a second of them and more
ATTITUDE_AGE = 1.0  # s; an attitude of another time does not tell how a ring lies


class RangeSensors:
    """Turns messages about the surroundings into readings.

    Args:
        arrivals: those that wait.
    """

    def __init__(self, arrivals: Arrivals) -> None:
        self._arrivals = arrivals
        self._ground = GroundSensors()
        self._rings: dict[tuple[int, int], Ring] = {}  # (component, kind of sensor) -> its newest
        self._turns: deque[tuple[float, Quat]] = deque(maxlen=ATTITUDES_KEPT)
        self._problems: list[str] = []

    def scan(self, now: float) -> Scan | None:
        """Return the rings of all sensors that measure one, if one of them is new."""
        self._note_turns(now)
        new = False
        for fields, at in self._arrivals.due("OBSTACLE_DISTANCE", now):
            attitude = self._attitude(at)
            refusal = obstacle_ring.refusal(fields, attitude)
            if refusal:
                self._problems.append(f"{refusal}: the ring is not used")
                continue
            who = int(fields.get("component", 1)), int(fields["sensor_type"])
            self._rings[who] = obstacle_ring.ring_of(fields, at, attitude)
            new = True
        return obstacle_ring.together(self._rings.values()) if new else None

    def flow(self, now: float) -> OpticalFlow | None:
        """Return the optical flow since the last call."""
        integrals = self._arrivals.due("OPTICAL_FLOW_RAD", now)
        rates = self._arrivals.due("OPTICAL_FLOW", now)
        return self._ground.flow(integrals, rates)

    def range(self, now: float) -> Range | None:
        """Return the newest distance to the ground."""
        return self._ground.range(self._arrivals.due("DISTANCE_SENSOR", now))

    def problems(self) -> list[str]:
        """Return what could not be used since the last call, and why."""
        problems = [*self._problems, *self._ground.problems]
        self._problems.clear()
        self._ground.problems.clear()
        return problems

    def _attitude(self, at: float) -> Quat | None:
        """Return the autopilot's attitude (body to world) at the time nearest to `at` (s)."""
        nearest = min(self._turns, key=lambda turn: abs(turn[0] - at), default=None)
        return None if nearest is None or abs(nearest[0] - at) > ATTITUDE_AGE else nearest[1]

    def _note_turns(self, now: float) -> None:
        for fields, at in self._arrivals.due("ATTITUDE_QUATERNION", now):
            attitude = message_readings.turned(fields)
            if attitude is not None:
                self._turns.append((at, attitude))
