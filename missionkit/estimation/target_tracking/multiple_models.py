"""Which models of motion a target is tracked with: `imm`, P4's `mmae`, and the single `static`."""

from __future__ import annotations

from types import ModuleType
from typing import Literal, NamedTuple

import numpy as np

from missionkit.estimation.target_tracking import model_bank, motion_models
from missionkit.geometry import Mat, Vec3
from missionkit.ground_robot import GroundRobot
from missionkit.messages.robot_modes import CIRCLING, OBSTACLE, SPIN, STANDING, STRAIGHT, TARGET

Estimator = Literal["imm", "mmae", "static"]
Library = Literal["numba", "filterpy"]

SPINS_EVERY = 20.0
"""Between the spins of a target on average (s); the firmware's clock, not counting bumps."""
MISTAKEN_FOR = 1e4
"""A target is an obstacle robot for ever; the chance to change is the chance to be mistaken (s)."""


OBSTACLE_SHARE = 4.0 / 14.0
"""Of the robots in the arena: four circle, ten are herded."""
SPIN_SHARE = 0.1
"""Of the time, which a target spins."""


class Bank(NamedTuple):
    """Models of motion, and how a target changes from one to another."""

    names: tuple[str, ...]
    kinds: tuple[str, ...]  # of robots, which move by each model
    models: Mat  # (n, 4), `motion_models.table`
    rates: Mat  # (n, n), 1/s, of changes from i to j
    interacting: bool  # IMM; False: MMAE, or a single model
    least: float  # no probability becomes less


class BankState(NamedTuple):
    """The filters of all models at one time; an immutable value."""

    X: Mat  # (n, 3): north, east (m), heading (rad)
    P: Mat  # (n, 3, 3)
    mu: Vec3  # (n,) probabilities


def bank(estimator: Estimator, robot: GroundRobot) -> Bank:
    """Return the models of an estimator.

    Args:
        estimator: `imm` has a model of obstacle robots too; `mmae` is P4's pair of models without
            interaction, probabilities in [0.01, 0.99]; `static` is the filter of P4 (15).
        robot: how it drives.
    """
    straight, spin = motion_models.straight(robot), motion_models.spin(robot)
    if estimator == "imm":
        rates = np.full((3, 3), 1.0 / MISTAKEN_FOR)
        rates[0, 1], rates[1, 0] = 1.0 / SPINS_EVERY, 1.0 / robot.spin_time
        models = motion_models.table(straight, spin, motion_models.circling(robot))
        kinds = (TARGET, TARGET, OBSTACLE)
        return Bank((STRAIGHT, SPIN, CIRCLING), kinds, models, rates, interacting=True, least=0.0)
    if estimator == "mmae":
        models, names = motion_models.table(straight, spin), (STRAIGHT, SPIN)
        return Bank(names, (TARGET,) * 2, models, np.zeros((2, 2)), interacting=False, least=0.01)
    models = motion_models.table(motion_models.standing(robot))
    return Bank((STANDING,), (TARGET,), models, np.zeros((1, 1)), interacting=False, least=0.0)


def kernels(library: Library) -> ModuleType:
    """Return whose code filters: our compiled kernels, or filterpy's, which is imported late."""
    if library == "filterpy":
        from missionkit.estimation.target_tracking import filterpy_bank  # noqa: PLC0415 heavy

        return filterpy_bank
    return model_bank


def begun(models: Bank, x: Vec3, P: Mat) -> BankState:
    """Return all filters at one state, each as likely as among all robots at any time.

    Args:
        models: of the target.
        x: (3,), m, m, rad.
        P: (3, 3) covariance.
    """
    n = len(models.names)
    shares = {STRAIGHT: 1.0 - SPIN_SHARE, SPIN: SPIN_SHARE}
    mu = np.array([shares.get(name, OBSTACLE_SHARE) for name in models.names])
    if OBSTACLE in models.kinds:
        mu[:2] *= 1.0 - OBSTACLE_SHARE
    return BankState(np.tile(x, (n, 1)), np.tile(P, (n, 1, 1)), mu / mu.sum())


def predicted(models: Bank, known: BankState, dt: float, library: ModuleType) -> BankState:
    """Return the state `dt` (s) later.

    Args:
        models: of the target.
        known: its state.
        dt: s.
        library: of `kernels`.
    """
    X, P, mu = (part.copy() for part in known)
    if models.interacting:
        library.interact(X, P, mu, models.models, model_bank.switching(models.rates, dt), dt)
    else:
        library.predict(X, P, models.models, dt)
    return BankState(X, P, mu)


def corrected(models: Bank, known: BankState, z: Vec3, R: Mat, library: ModuleType) -> BankState:
    """Return the state after a measured place; the same state if that is not sound.

    Args:
        models: of the target.
        known: its state.
        z: (2,), m, north and east.
        R: (2, 2), m².
        library: of `kernels`.
    """
    X, P, mu = (part.copy() for part in known)
    return BankState(X, P, mu) if library.update(X, P, mu, z, R, models.least) else known
