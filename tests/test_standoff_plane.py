"""A vehicle that lags, as PX4's own simulation does, arrives at a marker; judged by the truth."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import stage
from missionkit.sim.airframes import flown_with
from missionkit.sim.fault_injection import parse_fault
from missionkit.sim.world import Wind
from studies.flight import Order, builtin, setting, staged
from studies.watch import Watch

STANDOFF, BODY, SLACK = 1.2, 0.35, 0.4  # m; the half-space begins 0.15 m nearer than the standoff


def nearest(ready, watch, states=("visual", "search")):
    """Return how near (m) the vehicle came to its marker's plane, from where it saw it first."""
    span = [0.0, np.inf]
    for change in watch.changes:
        if change.to == "visual" and not span[0]:
            span[0] = change.at
        elif span[0] and change.to not in states:
            span[1] = min(span[1], change.at)
    rows = ready.vehicle.track.rows
    inside = rows[(rows[:, 0] >= span[0]) & (rows[:, 0] <= span[1]), 1:4]
    normal = watch.marker.pose.rotation
    w, i, j, k = normal
    out = np.array([2 * (i * k + w * j), 2 * (j * k - w * i), 1 - 2 * (i * i + j * j)])
    return float(((inside - np.array(watch.marker.position)) @ out).min())


def test_it_brakes_before_the_plane_and_finishes_its_work() -> None:
    mission, world = setting()
    quiet = world.model_copy(update={"wind": Wind()})
    settings = {"gyro_noise": 0.01, "accel_noise": 0.2}
    plugin = mission.navigation.plugin.model_copy(update=settings)
    camera = mission.camera.model_copy(update={"use": "corners"})
    parts = {"camera": camera, "navigation": replace(mission.navigation, plugin=plugin)}
    mission = mission.model_copy(update=parts)
    faults = [parse_fault("velocity_bias"), parse_fault("control_slow=0.05")]
    ready = stage(mission, builtin(), flown_with(quiet, "sih"), 11, faults)
    watch = Watch(ready)
    result = rehearse(ready, [watch])
    assert result.succeeded
    assert nearest(ready, watch) > STANDOFF - SLACK


def test_a_marker_that_is_hidden_on_the_way_in_is_searched_for_from_before_the_plane() -> None:
    ready = staged(Order(13, "corners", ("marker_hidden@visual:2+8",)))
    watch = Watch(ready)
    rehearse(ready, [watch])
    assert "search" in [change.to for change in watch.changes]
    assert nearest(ready, watch) > STANDOFF - SLACK
