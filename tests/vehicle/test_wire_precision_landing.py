"""The precision landing over the wire: its camera, flow and range; judged by the truth."""

import numpy as np
from rehearsed import MISSIONS
from vehicle.flying import sitl

from missionkit.api.vehicle_flight import fly_vehicle, vehicle_of
from missionkit.chart.load import load
from missionkit.chart.plugin_catalogue import builtin
from missionkit.engine.flight_end import FlightEnd
from missionkit.engine.prepared_mission import prepare
from missionkit.rehearsal.stage import world_of

SPEED = 3.0
LIMIT = 120.0  # s, however it goes wrong


def test_it_lands_on_the_pad_over_the_wire(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    mission = load(MISSIONS / "precision_landing.yaml", builtin())
    world = world_of(mission, MISSIONS)
    states, fixes = [], set()

    def watch(record, _):
        states.append(record.state)
        fixes.add(record.estimate.health.gnss_at)

    with sitl("px4", SPEED, world=world) as autopilot:
        vehicle = vehicle_of(autopilot.url, mission, world, speed=autopilot.speed)
        plan = prepare(mission, builtin())
        flown = fly_vehicle(plan, vehicle, (watch,), speed=autopilot.speed, time_limit=LIMIT)
        truth = autopilot.truth
    assert flown.end is FlightEnd.LANDED
    went = list(dict.fromkeys(states))
    assert went[:3] == ["idle", "ready", "glide"]
    assert states[-1] == "land"
    assert next(state for state in reversed(states) if state != "land") == "descend"
    pad = world.marker(227).position
    assert np.hypot(*(np.array(truth["position"][:2]) - pad[:2])) < 0.4
    assert truth["on_ground"]
    assert not truth["crashed"]
    assert fixes == {None}
