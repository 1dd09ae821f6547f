"""Telemetry streams: the messages used, their rates, and when to request them again.

An autopilot forgets the rates when it reboots, and says nothing about it if that was quick.
"""

from __future__ import annotations

import threading
from collections.abc import Mapping
from contextlib import suppress

from missionkit.vehicle.link.message_cache import Cache, Message
from missionkit.vehicle.link.message_link import MessageLink

SET_INTERVAL = 511  # MAV_CMD_SET_MESSAGE_INTERVAL
REQUEST = 512  # MAV_CMD_REQUEST_MESSAGE
HEARTBEAT, HOME = 0, 242  # message ids
REBOOTED = "autopilot_rebooted"
RETRY = 1.0  # s until a missing stream is requested again
SPAN = 2.0  # s over which rates are measured

NAMES: Mapping[int, str] = {
    0: "HEARTBEAT",
    1: "SYS_STATUS",
    2: "SYSTEM_TIME",
    24: "GPS_RAW_INT",
    27: "RAW_IMU",
    29: "SCALED_PRESSURE",
    31: "ATTITUDE_QUATERNION",
    32: "LOCAL_POSITION_NED",
    49: "GPS_GLOBAL_ORIGIN",
    77: "COMMAND_ACK",
    100: "OPTICAL_FLOW",
    105: "HIGHRES_IMU",
    106: "OPTICAL_FLOW_RAD",
    111: "TIMESYNC",
    115: "HIL_STATE_QUATERNION",
    124: "GPS2_RAW",
    132: "DISTANCE_SENSOR",
    147: "BATTERY_STATUS",
    242: "HOME_POSITION",
    245: "EXTENDED_SYS_STATE",
    253: "STATUSTEXT",
    285: "GIMBAL_DEVICE_ATTITUDE_STATUS",
    330: "OBSTACLE_DISTANCE",
    331: "ODOMETRY",
    350: "DEBUG_FLOAT_ARRAY",
}
SPARE = frozenset(  # streamed unasked by one autopilot or the other; not used here
    (
        30,  # ATTITUDE
        33,  # GLOBAL_POSITION_INT
        36,  # SERVO_OUTPUT_RAW
        62,  # NAV_CONTROLLER_OUTPUT
        65,  # RC_CHANNELS
        74,  # VFR_HUD
        83,  # ATTITUDE_TARGET
        85,  # POSITION_TARGET_LOCAL_NED
        87,  # POSITION_TARGET_GLOBAL_INT
        141,  # ALTITUDE
        230,  # ESTIMATOR_STATUS
        241,  # VIBRATION
    )
) - frozenset(NAMES)
QUEUED = frozenset(  # every one counts, or several sensors send the same message
    (
        "ATTITUDE_QUATERNION",
        "BATTERY_STATUS",
        "DISTANCE_SENSOR",
        "GIMBAL_DEVICE_ATTITUDE_STATUS",
        "GPS2_RAW",
        "GPS_RAW_INT",
        "HIGHRES_IMU",
        "OBSTACLE_DISTANCE",
        "OPTICAL_FLOW",
        "OPTICAL_FLOW_RAD",
        "STATUSTEXT",
    )
)
ENOUGH = 0.3  # of the requested rate: not every inertial unit has 250 Hz
SINCE_1970 = 1e15  # us: a larger stamp does not count from the boot
CLOCKED = frozenset(("HIGHRES_IMU", "ATTITUDE_QUATERNION", "LOCAL_POSITION_NED"))


def boot_time(message: Message) -> float | None:
    """Return when a message was stamped (s since boot), None if it is not.

    Zero is not a timestamp: the fixes of PX4's simulated receiver have none.
    """
    fields = message.fields
    boot = 1e3 * float(fields.get("time_boot_ms", 0)) or float(fields.get("time_usec", 0))  # us
    return 1e-6 * boot if 0.0 < boot < SINCE_1970 else None


class Streams:
    """Keeps the streams coming.

    Args:
        wire: the link.
        cache: where the messages are.
        intervals: message id -> Hz wanted.
        optional: ids that not every vehicle has; they are requested once.
        pace: seconds of the vehicle in one of the wall.
    """

    def __init__(
        self,
        wire: MessageLink,
        cache: Cache,
        intervals: Mapping[int, float],
        optional: frozenset[int],
        pace: float = 1.0,
    ) -> None:
        self._wire = wire
        self._cache = cache
        self._intervals = intervals
        self._optional = optional
        self._pace = pace
        self._all_due = threading.Event()
        self._all_due.set()
        self._asked: dict[int, float] = {}
        self._counts: dict[str, int] = {}
        self._counted_at = cache.wall()
        self._slow: set[int] = set()

    def hear(self, message: Message) -> None:
        """Watch one message, on the thread that brings it."""
        self._counts[message.name] = self._counts.get(message.name, 0) + 1

    def forgotten(self) -> None:
        """Note that the autopilot has restarted, or may have: it knows of no rates."""
        self._all_due.set()

    def request(self, ident: int) -> None:
        """Ask for one message now, by its id."""
        self._ask(REQUEST, ident, 0.0)

    def maintain(self) -> int:
        """Ask for what is missing; return how many requests that took. Call it now and then."""
        now = self._cache.wall()
        everything = self._all_due.is_set()
        self._all_due.clear()
        self._measure(now)
        wanted = [ident for ident in self._intervals if everything or self._missing(ident, now)]
        for ident in wanted:
            if ident == HOME and ident in self._asked:  # not a stream everywhere
                self.request(ident)
            self._asked[ident] = now
            self._ask(SET_INTERVAL, ident, 1e6 / self._intervals[ident])
        return len(wanted)

    def _ask(self, command: int, ident: int, interval: float) -> None:
        rest = {f"param{n}": 0.0 for n in range(3, 8)}
        with suppress(RuntimeError):  # no link: requested again when it is back
            self._wire.send(
                "COMMAND_LONG",
                command=command,
                confirmation=0,
                param1=float(ident),
                param2=interval,
                **rest,
            )

    def _missing(self, ident: int, now: float) -> bool:
        if ident in self._optional or (now - self._asked.get(ident, 0.0)) * self._pace < RETRY:
            return False
        message = self._cache.latest(NAMES[ident])
        patience = max(RETRY, 4.0 / self._intervals[ident])
        late = message is None or (now - message.arrived) * self._pace > patience
        return late or ident in self._slow

    def _measure(self, now: float) -> None:
        """Find the streams that are much slower than requested."""
        span = (now - self._counted_at) * self._pace
        if span < SPAN:
            return
        self._slow = {
            ident
            for ident, rate in self._intervals.items()
            if self._counts.get(NAMES[ident], 0) < ENOUGH * rate * span - 1.0
        }
        self._counts.clear()
        self._counted_at = now
