"""State of the autopilot, from its newest messages."""

from __future__ import annotations

import math
from typing import NamedTuple

from missionkit.vehicle.autopilot_dialect import Dialect, word
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.telemetry.home_position import local_home

_ARMED_FLAG = 0x80  # MAV_MODE_FLAG_SAFETY_ARMED
_SENSOR_GYRO, _SENSOR_ACCEL, _SENSOR_MAG, _SENSOR_GPS, _PREARM = 1, 2, 4, 0x20, 0x10000000
"""MAV_SYS_STATUS_SENSOR."""
_LANDED_ON_GROUND, _LANDED_IN_AIR, _LANDED_TAKING_OFF, _LANDED_LANDING = 1, 2, 3, 4
"""MAV_LANDED_STATE."""
_ALARMED = frozenset((5, 6))  # MAV_STATE: critical, emergency
_POWERED_STATES = frozenset((4, 5, 6))  # MAV_STATE: active, critical, emergency
_BEHIND = 2.0  # s that EXTENDED_SYS_STATE may be older than the heartbeat: it has stopped

WHEREABOUTS_AGE = 2.0  # s, wall; older messages do not show where it is

SENSOR_BITS = {
    "gyroscope": _SENSOR_GYRO,
    "accelerometer": _SENSOR_ACCEL,
    "magnetometer": _SENSOR_MAG,
    "GNSS": _SENSOR_GPS,
}


class Whereabouts(NamedTuple):
    """Reported position of the vehicle; None: no recent report."""

    on_ground: bool | None = None
    height: float | None = None  # m above home
    from_home: float | None = None  # m over ground


UNKNOWN_WHEREABOUTS = Whereabouts()


class AutopilotState:
    """State as the autopilot reports it. None: not reported.

    Args:
        cache: the newest messages.
        dialect: of the autopilot.
    """

    def __init__(self, cache: Cache, dialect: Dialect) -> None:
        self._cache = cache
        self._dialect = dialect

    @property
    def mode(self) -> str | None:
        """Its mode."""
        beat = self._cache.latest("HEARTBEAT")
        return None if beat is None else word(self._dialect, int(beat["custom_mode"]))

    @property
    def armed(self) -> bool | None:
        """Whether the rotors may turn."""
        beat = self._cache.latest("HEARTBEAT")
        return None if beat is None else bool(int(beat["base_mode"]) & _ARMED_FLAG)

    @property
    def in_air(self) -> bool | None:
        """Whether it flies; armed and active counts as flying where it does not say.

        Disarmed it does not, whatever the last report: that may be old, its heartbeat is not. What
        EXTENDED_SYS_STATE reported no longer counts once heartbeats come without it.
        """
        if self.armed is False:
            return False
        beat, landed = self._cache.latest("HEARTBEAT"), self._cache.latest("EXTENDED_SYS_STATE")
        stopped = landed is None or (beat is not None and beat.arrived - landed.arrived > _BEHIND)
        if landed is not None and not stopped and int(landed["landed_state"]) != 0:
            return int(landed["landed_state"]) in {
                _LANDED_IN_AIR,
                _LANDED_TAKING_OFF,
                _LANDED_LANDING,
            }
        if beat is None:
            return None
        return bool(self.armed) and int(beat["system_status"]) in _POWERED_STATES

    @property
    def failsafe(self) -> bool:
        """Whether it says that a failsafe of its own is active."""
        beat = self._cache.latest("HEARTBEAT")
        return beat is not None and int(beat["system_status"]) in _ALARMED

    @property
    def heard(self) -> float:
        """When the last heartbeat came (s, wall)."""
        beat = self._cache.latest("HEARTBEAT")
        return float("-inf") if beat is None else beat.arrived

    @property
    def armable(self) -> bool | None:
        """Whether its own arming checks pass.

        PX4 sets the bit among the healthy ones, and never among those that are there.
        """
        status_message = self._cache.latest("SYS_STATUS")
        if status_message is None:
            return None
        healthy = bool(int(status_message["onboard_control_sensors_health"]) & _PREARM)
        present = bool(int(status_message["onboard_control_sensors_present"]) & _PREARM)
        return healthy if healthy or present or not self._dialect.checks_present else None

    def sensor(self, name: str) -> bool | None:
        """Return whether one of SENSOR_BITS is healthy."""
        return self._healthy(SENSOR_BITS[name])

    @property
    def placed(self) -> bool:
        """Whether it knows where it is: a position of its own, with or without satellites."""
        return self._cache.latest("LOCAL_POSITION_NED", 2.0) is not None

    @property
    def ready(self) -> bool:
        """Whether it may be armed: its checks pass, and it knows where it is.

        ArduCopter reports armable before its estimator has a position, so both are required.
        """
        return bool(self.armable) and self.placed

    @property
    def height(self) -> float | None:
        """Height above home (m)."""
        local, home = self._cache.latest("LOCAL_POSITION_NED"), local_home(self._cache)
        if local is None or local["z"] is None:
            return None
        return (0.0 if home is None else float(home[2])) - float(local["z"])

    def whereabouts(self) -> Whereabouts:
        """Return its position by its recent messages."""
        landed = self._cache.latest("EXTENDED_SYS_STATE", WHEREABOUTS_AGE)
        status_message = 0 if landed is None else int(landed["landed_state"])
        local = self._cache.latest("LOCAL_POSITION_NED", WHEREABOUTS_AGE)
        home = self._cache.latest("HOME_POSITION")
        away = None
        if local is not None and home is not None and None not in (local["x"], home["x"]):
            away = math.hypot(local["x"] - home["x"], local["y"] - home["y"])
        return Whereabouts(
            on_ground=None if status_message == 0 else status_message == _LANDED_ON_GROUND,
            height=None if local is None else self.height,
            from_home=away,
        )

    def _healthy(self, bit: int) -> bool | None:
        status_message = self._cache.latest("SYS_STATUS")
        if (
            status_message is None
            or not int(status_message["onboard_control_sensors_present"]) & bit
        ):
            return None
        return bool(int(status_message["onboard_control_sensors_health"]) & bit)
