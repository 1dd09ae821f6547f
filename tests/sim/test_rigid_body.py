from __future__ import annotations

import json
import math
import os
import subprocess
import sys

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from missionkit.geometry import GRAVITY, from_euler
from missionkit.sim.kernel_layout import (
    CRASHED,
    ON_GROUND,
    SIZE,
    Body,
    constants,
)
from missionkit.sim.rigid_body import advance, derivative, touch
from missionkit.sim.vehicle_parameters import Quadrotor
from missionkit.sim.world import World

BODY = constants(World(world="test"))[0]
CALM = np.zeros(3)


def tumbling() -> np.ndarray:
    state = np.zeros(17)
    state[3:6] = 4.0, -2.0, 1.0
    state[6:10] = from_euler(0.4, -0.3, 1.0)
    state[10:13] = 2.0, -1.5, 1.0
    state[13:17] = 3.0, 4.0, 5.0, 3.5
    return state


def fly(state: np.ndarray, u: np.ndarray, dt: float, steps: int, body: Body = BODY) -> np.ndarray:
    work, wind = np.empty((5, 17)), np.array([1.0, 2.0, 0.0])
    for _ in range(steps):
        advance(state, u, wind, body, dt, work)
    return state


def test_hover_is_an_equilibrium() -> None:
    state, out = np.zeros(17), np.empty(17)
    state[6] = 1.0
    u = np.full(4, BODY.mass * GRAVITY / 4)
    state[13:17] = u
    derivative(state, u, CALM, BODY, out)
    assert np.abs(out).max() < 1e-12


def test_free_fall_with_linear_drag_has_the_closed_form() -> None:
    body = BODY._replace(drag_quadratic=0.0)
    state, work = np.zeros(17), np.empty((5, 17))
    state[6] = 1.0
    for _ in range(400):
        advance(state, np.zeros(4), CALM, body, 0.005, work)
    rate = body.drag_linear / body.mass
    speed = GRAVITY / rate * (1 - math.exp(-rate * 2.0))
    assert state[5] == pytest.approx(speed, rel=1e-9)
    assert state[2] == pytest.approx((GRAVITY * 2.0 - speed) / rate, rel=1e-9)


def test_torque_free_spin_keeps_momentum_and_energy() -> None:
    body = BODY._replace(jx=0.01, jy=0.02, jz=0.03, drag_linear=0.0, drag_quadratic=0.0)
    inertia = np.array([body.jx, body.jy, body.jz])
    state, work = np.zeros(17), np.empty((5, 17))
    state[6], state[10:13] = 1.0, (3.0, 4.0, -2.0)
    before = inertia * state[10:13]
    for _ in range(200):
        advance(state, np.zeros(4), CALM, body, 0.005, work)
    after = inertia * state[10:13]
    assert np.linalg.norm(after) == pytest.approx(np.linalg.norm(before), rel=1e-5)
    assert after @ state[10:13] == pytest.approx(before @ [3.0, 4.0, -2.0], rel=1e-5)


def test_integration_agrees_with_scipy_and_is_of_fourth_order() -> None:
    u, wind = np.array([4.0, 3.0, 3.5, 4.5]), np.array([1.0, 2.0, 0.0])

    def slope(_: float, x: np.ndarray) -> np.ndarray:
        out = np.empty(17)
        derivative(x, u, wind, BODY, out)
        return out

    exact = solve_ivp(slope, (0.0, 0.4), tumbling(), rtol=1e-12, atol=1e-12).y[:, -1]
    coarse, fine = (np.linalg.norm(fly(tumbling(), u, 0.4 / n, n) - exact) for n in (40, 80))
    assert fine < 1e-5
    assert math.log2(coarse / fine) == pytest.approx(4.0, abs=0.3)


@pytest.mark.parametrize(("speed", "crashed"), [(1.0, 0.0), (2.5, 1.0)])
def test_ground_stops_the_fall_and_a_hard_touch_is_a_crash(speed: float, crashed: float) -> None:
    state, memory = np.zeros(17), np.zeros(SIZE)
    state[2], state[5], state[6] = 0.01, speed, 1.0
    touch(state, memory)
    assert (state[2], state[5]) == (0.0, 0.0)
    assert (memory[ON_GROUND], memory[CRASHED]) == (1.0, crashed)


def test_heavier_world_parameters_reach_the_kernel() -> None:
    body = constants(World(world="heavy", quadrotor=Quadrotor(mass=3.0)))[0]
    assert (body.mass, body.full) == (3.0, pytest.approx(2.2 * 3.0 * GRAVITY / 4))


FLIGHT = """
import json, numpy as np
from missionkit.messages import Action, Command, Setpoint
from missionkit.perception.camera_section import Camera
from missionkit.sim.simulated_vehicle import SimulatedVehicle
from missionkit.sim.world import Cylinder, Marker, Wind, World
world = World(world="w", wind=Wind(mean=(2, 1, 0), gust=1), start=(1.5, 0),
    obstacles=(Cylinder(use="cylinder", at=(6, 0.5), radius=0.5, height=4),),
    markers=(Marker(dictionary="DICT_4X4_50", id=3, size=0.5, position=(5.0, 0, -1)),))
vehicle = SimulatedVehicle(world, Camera(use="corners"), 7)
frames = []
for tick in range(1, 61):
    seen = vehicle.advance(tick * 0.05)
    frames += [c.tolist() for _, _, c in (seen.frame.corners if seen.frame else ())]
    if tick == 21:
        vehicle.apply(Command(action=Action.ARM))
    elif tick > 22:
        vehicle.apply(Command(setpoint=Setpoint(np.array([1.0, 0.5, -1.0]), 0.3)))
print(json.dumps([vehicle.track.rows.tolist(), frames, seen.scan.points.tolist()]))
"""


def test_compiled_kernels_give_the_numbers_of_plain_python() -> None:
    outputs = []
    for disabled in ("0", "1"):
        env = {**os.environ, "NUMBA_DISABLE_JIT": disabled}
        run = subprocess.run(
            [sys.executable, "-c", FLIGHT], env=env, capture_output=True, text=True, check=True
        )
        outputs.append(json.loads(run.stdout))
    (jit, jit_frames, jit_scan), (plain, plain_frames, plain_scan) = outputs
    assert jit[-1][3] < -1.0
    assert jit_frames
    np.testing.assert_allclose(jit, plain, rtol=1e-10, atol=1e-12)
    np.testing.assert_allclose(jit_frames, plain_frames, rtol=1e-10)
    np.testing.assert_allclose(jit_scan, plain_scan, rtol=1e-10, atol=1e-12)
