"""RAW_IMU and SCALED_PRESSURE, which every ArduPilot sends, as HIGHRES_IMU, which few do.

Source: MAVLink common.xml, messages 27, 29, 105; ArduPilot `GCS_Common.cpp`: RAW_IMU holds filtered
accelerations (mG), rates (mrad/s) and the field (mgauss).
"""

from __future__ import annotations

import math
from collections.abc import Callable

from missionkit.geometry import GRAVITY
from missionkit.vehicle.link.message_cache import Fields
from missionkit.vehicle.telemetry.message_readings import MAG_UPDATED, PRESSURE_ALT_UPDATED

INERTIAL_FIELDS = 0x3F  # HIGHRES_IMU_UPDATED_FLAGS
SEA_LEVEL = 1013.25  # hPa

Put = Callable[[str, Fields], None]


class RawImuConverter:
    """Passes messages on, and with every RAW_IMU a HIGHRES_IMU.

    Args:
        put: takes a message, its name and fields.
    """

    def __init__(self, put: Put) -> None:
        self._put = put
        self._pressure: float | None = None  # hPa, that has not been passed on yet

    def __call__(self, name: str, fields: Fields) -> None:
        """Take a message in."""
        self._put(name, fields)
        if name == "SCALED_PRESSURE":
            self._pressure = fields["press_abs"]
        elif name == "RAW_IMU":
            pressure, self._pressure = self._pressure, None
            self._put("HIGHRES_IMU", highres(fields, pressure))


def highres(raw: Fields, pressure: float | None) -> Fields:
    """Return HIGHRES_IMU of RAW_IMU and an absolute pressure (hPa), if there is a new one."""
    values = {f"{axis}acc": 1e-3 * GRAVITY * raw[f"{axis}acc"] for axis in "xyz"}
    for what in ("gyro", "mag"):
        values |= {f"{axis}{what}": 1e-3 * raw[f"{axis}{what}"] for axis in "xyz"}
    new = INERTIAL_FIELDS | MAG_UPDATED | (0 if pressure is None else PRESSURE_ALT_UPDATED)
    height = None if pressure is None else pressure_altitude(pressure)
    return {**values, "time_usec": raw["time_usec"], "pressure_alt": height, "fields_updated": new}


def pressure_altitude(pressure: float) -> float:
    """Return the height (m) at which the ICAO standard atmosphere has a pressure (hPa)."""
    share: float = max(pressure, 0.0) / SEA_LEVEL
    return 44330.77 * (1.0 - math.pow(share, 0.1902632))
