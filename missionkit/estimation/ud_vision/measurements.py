"""What corrects the navigator beside the camera, as rows of the measurement log."""

from __future__ import annotations

import math

import numpy as np

from missionkit.estimation.error_state_ekf import state_layout
from missionkit.estimation.error_state_ekf.measurement_log import STANDING_SD, row
from missionkit.estimation.ud_vision.parameters import UdVisionEkf
from missionkit.geometry import Vec3, norm
from missionkit.messages import Magnetometer, Observation


def field_of(mag: Magnetometer | None) -> Vec3 | None:
    """Return the field (3,) if it is one: its length should be 1."""
    return mag.field if mag is not None and 0.5 < norm(mag.field) < 2.0 else None


def measured(seen: Observation, settings: UdVisionEkf, *, in_air: bool) -> list[Vec3]:
    """Return the log rows (21,) of height, heading, and standing still.

    Args:
        seen: the observation.
        settings: parameters of the navigator.
        in_air: by the autopilot's last report.
    """
    s, rows, status, mag = settings, [], seen.status, seen.mag
    if status is not None and not status.in_air:
        rows.append(row(state_layout.STILL, status.at, (0.0, 0.0, 0.0), np.square(STANDING_SD)))
    if seen.range is not None and in_air:
        z, noise = (seen.range.distance, 0.0, 0.0), np.square(s.range_sd)
        rows.append(row(state_layout.RANGE, seen.range.at, z, noise))
    if mag is not None and (field := field_of(mag)) is not None:
        north = math.radians(s.declination_deg)
        rows.append(row(state_layout.HEADING, mag.at, field, np.square(s.mag_sd), extra=north))
    return rows
