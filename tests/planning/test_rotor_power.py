"""The power of rotors against closed forms, and in the simulator's battery."""

from __future__ import annotations

import math

import numpy as np
import pytest
from pydantic import ValidationError
from scipy.optimize import brentq

from missionkit.geometry import GRAVITY
from missionkit.messages import Action, Command, Setpoint
from missionkit.perception.camera_section import Camera
from missionkit.planning.rotor_power import (
    AIR_DENSITY,
    RotorPower,
    flight_powers,
    glauert,
    induced_velocity,
    rotor_power,
    rotor_powers,
)
from missionkit.sim.simulated_vehicle import SimulatedVehicle
from missionkit.sim.vehicle_parameters import Quadrotor
from missionkit.sim.world import World

MASS, DRAG = 1.2, 0.0118
ROTOR = RotorPower().model()
THRUST = 0.25 * MASS * GRAVITY
HOVER = math.sqrt(THRUST / (2.0 * AIR_DENSITY * ROTOR.area))


def powers(*velocities):
    v = np.array(velocities, dtype=float)
    return flight_powers(v, np.zeros_like(v), MASS, DRAG, ROTOR)


def test_a_hover_takes_what_momentum_theory_says():
    disks = math.pi * 0.1143**2 * 4
    weight = 1.2 * 9.80665
    induced = 1.15 * weight * math.sqrt(weight / (2 * 1.225 * disks)) / 0.6
    assert RotorPower().hover(1.2) == pytest.approx(induced + 15.0 + 5.0, rel=1e-12)
    assert RotorPower().hover(1.2) == pytest.approx(142.0, abs=0.1)
    assert powers((0, 0, 0))[0] == pytest.approx(RotorPower().hover(1.2), rel=1e-12)


def test_level_flight_takes_least_at_nine_metres_a_second():
    speeds = np.linspace(0.0, 16.0, 161)
    watts = powers(*((v, 0.0, 0.0) for v in speeds))
    assert watts.min() == pytest.approx(104.0, abs=0.5)
    assert speeds[watts.argmin()] == pytest.approx(9.0, abs=0.6)
    assert powers((9.0, 0.0, 0.0))[0] == pytest.approx(104.0, abs=0.2)
    assert (np.diff(watts[: watts.argmin()]) < 0).all()


@pytest.mark.parametrize("along", [0.0, 1.0, 5.0, 12.0])
@pytest.mark.parametrize("through", [0.0, 0.5, 3.0, 9.0])
def test_induced_velocity_solves_glauert_by_an_independent_solver(along, through):
    def miss(v):
        return v * math.hypot(along, through + v) - HOVER**2

    root = brentq(miss, 0.0, 50.0, xtol=1e-13)
    assert induced_velocity(THRUST, along, through, ROTOR.area) == pytest.approx(root, rel=1e-9)


def test_a_vertical_descent_follows_the_measured_polynomial():
    for m in (-0.1, -0.5, -1.0, -2.0):
        ratio = 1 - 1.125 * m - 1.372 * m**2 - 1.718 * m**3 - 0.655 * m**4
        v = induced_velocity(THRUST, 0.0, m * HOVER, ROTOR.area)
        assert v / HOVER == pytest.approx(ratio, rel=1e-12)


def test_from_the_hover_speed_on_a_descent_is_glauerts():
    for m in (-0.1, -1.0, -1.9):
        v = induced_velocity(THRUST, HOVER, m * HOVER, ROTOR.area)
        assert v == glauert(HOVER, HOVER, m * HOVER)
        assert v * math.hypot(HOVER, m * HOVER + v) == pytest.approx(HOVER**2, rel=1e-9)


def test_power_has_no_steps():
    """Over climb and descent, and over the edge of the wake: as smooth as the grid is fine."""
    through = np.linspace(-2.5 * HOVER, HOVER, 2001)
    thrust = np.full_like(through, THRUST)
    for along in (0.0, 0.3 * HOVER, 0.99 * HOVER, 1.01 * HOVER):
        watts = rotor_powers(thrust, np.full_like(through, along), through, ROTOR)
        assert np.abs(np.diff(watts)).max() < 0.3
    along = np.linspace(0.0, 2.0 * HOVER, 2001)
    for m in (-1.5, -0.5, -1e-9, 0.0, 0.5):
        watts = rotor_powers(thrust, along, np.full_like(along, m * HOVER), ROTOR)
        assert np.abs(np.diff(watts)).max() < 0.1


def test_a_batch_equals_one_at_a_time():
    rng = np.random.default_rng(4)
    thrust, along, through = rng.uniform((0, 0, -12), (9, 15, 9), (300, 3)).T
    one_by_one = [
        rotor_power(*condition, ROTOR) for condition in zip(thrust, along, through, strict=True)
    ]
    assert rotor_powers(thrust, along, through, ROTOR).tolist() == one_by_one


def test_no_condition_gives_nonsense():
    rng = np.random.default_rng(5)
    thrust, along, through = rng.uniform((0, 0, -60), (40, 60, 60), (2000, 3)).T
    watts = rotor_powers(thrust, along, through, ROTOR)
    assert np.isfinite(watts).all()
    assert (watts >= ROTOR.electronics).all()
    assert rotor_power(0.0, 3.0, 1.0, ROTOR) == ROTOR.electronics


def quad(**changes):
    body = {"mass": MASS, "drag_linear": 0.0, "drag_quadratic": DRAG, "rotors": {}}
    return Quadrotor.model_validate(body | changes)


@pytest.mark.parametrize("through", [0.0, 1.0, -30.0, 30.0])
def test_a_rotor_that_has_come_to_rest_takes_what_its_electronics_take(through):
    """The thrust of a rotor that is switched off decays for as long as the vehicle stands."""
    rotor = RotorPower().model()
    for thrust in (1e-7, 1e-10, 1e-30, 1e-200, 5e-324, 0.0):
        power = rotor_power(thrust, 0.0, through, rotor)
        assert power == pytest.approx(rotor.profile + rotor.electronics, rel=0.01) or (
            power == rotor.electronics
        )


def test_power_is_given_once():
    assert quad().hovering == pytest.approx(142.0, abs=0.1)
    assert Quadrotor().hovering == 180.0
    world = World(world="again", quadrotor=quad())
    assert World.model_validate_json(world.model_dump_json()) == world
    with pytest.raises(ValidationError, match="either hover_power or rotors"):
        quad(hover_power=150.0)


def test_the_simulated_battery_gives_what_the_model_says():
    vehicle = SimulatedVehicle(World(world="field", quadrotor=quad()), Camera(use="none"), seed=1)
    vehicle.advance(1.2)
    for action, until in ((Action.ARM, 1.3), (Action.TAKE_OFF, 10.0)):
        vehicle.apply(Command(action=action, height=4.0))
        vehicle.advance(until)

    def mean_power(velocity, begin, end):
        """Over the second half of a leg, when its speed is steady."""
        energy = []
        for tick in range(round(begin * 20) + 1, round(end * 20) + 1):
            vehicle.apply(Command(setpoint=Setpoint(np.array(velocity), 0.0)))
            vehicle.advance(tick / 20)
            energy.append(vehicle.truth.energy)
        half = len(energy) // 2
        return (energy[-1] - energy[half]) / (0.05 * (len(energy) - 1 - half))

    assert mean_power((0.0, 0.0, 0.0), 10, 14) == pytest.approx(142.0, rel=0.02)
    assert mean_power((8.0, 0.0, 0.0), 14, 26) == pytest.approx(106.0, rel=0.03)
