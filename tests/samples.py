"""Estimates for tests to start from."""

from __future__ import annotations

from typing import Any

import numpy as np

from missionkit.messages import Battery, Estimate, Health, VehicleStatus


def calm(**changes: Any) -> Estimate:
    """Return an estimate of a healthy vehicle hovering at 5 m, with `changes`."""
    now = changes.pop("now", 10.0)
    values: dict[str, Any] = {
        "now": now,
        "position": np.array([0.0, 0.0, -5.0]),
        "velocity": np.zeros(3),
        "attitude": np.array([1.0, 0.0, 0.0, 0.0]),
        "rates": np.zeros(3),
        "health": Health(True, False, now, None, 0.3, 0),
        "battery": Battery(now, 0.9, 16.0),
        "status": VehicleStatus(now, True, True, True, "offboard"),
        "home": np.zeros(3),
    }
    return Estimate(**(values | changes))


HOP = """\
missionkit: 1
mission: hop
params: {height: 2.0}
camera: {use: none}
initial: idle
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: $height}
    transitions: [{to: land, when: done}]
  land:
    kind: land
"""
"""Up and down again: ten seconds."""
