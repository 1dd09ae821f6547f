"""crocoddyl's FDDP on a flight of a point.

Its compiled models know no limit of a norm, so it gets boxes that hold the balls: an easier
problem. Weights of the penalty and tolerances are missionkit's.
"""

from __future__ import annotations

from collections.abc import Callable

import crocoddyl
import numpy as np
import pinocchio

from missionkit.geometry import Mat
from missionkit.planning.ddp.point_mass import Flight
from missionkit.planning.ddp.solver import SETTINGS, WEIGHTS

ITERATIONS = 100
FREE = 1e8  # of a component without limit


def prepared(flight: Flight, state: Mat) -> Callable[[], Mat]:
    """Return the solver for one flight, its models built; it returns the controls (N, 3)."""
    space = crocoddyl.StateMultibody(_point())
    running, ending = crocoddyl.CostModelSum(space, 3), crocoddyl.CostModelSum(space, 3)
    zero = crocoddyl.ResidualModelState(space, np.zeros(6), 3)
    push = crocoddyl.ResidualModelControl(space, 3)
    most, fast = np.full(3, flight.limits.acceleration), np.repeat((FREE, flight.limits.speed), 3)
    away = crocoddyl.ResidualModelState(space, flight.target, 3)
    for costs, weights in ((running, flight.weights[:2]), (ending, flight.weights[3:])):
        weigh = crocoddyl.ActivationModelWeightedQuad(np.repeat(weights, 3))
        costs.addCost("target", crocoddyl.CostModelResidual(space, weigh, away), 1.0)
        costs.addCost("speed", _limit(space, fast, zero), 1.0)
    effort = crocoddyl.CostModelResidual(space, push)
    running.addCost("acceleration", effort, flight.weights.acceleration)
    running.addCost("push", _limit(space, most, push), 1.0)
    step, end = (
        crocoddyl.IntegratedActionModelEuler(
            crocoddyl.DifferentialActionModelFreeFwdDynamics(
                space, crocoddyl.ActuationModelFull(space), costs
            ),
            dt,
        )
        for costs, dt in ((running, flight.horizon.dt), (ending, 0.0))
    )
    steps = flight.horizon.steps
    problem = crocoddyl.ShootingProblem(state, [step] * steps, end)
    problem.nthreads = 1  # two wait for each other on a busy machine
    solver = crocoddyl.SolverFDDP(problem)

    def run() -> Mat:
        xs, us = [state] * (steps + 1), [np.zeros(3)] * steps
        cost = solver.problem.calc(xs, us)
        for weight in WEIGHTS:
            for costs, share in ((running, weight), (ending, flight.horizon.dt * weight)):
                for name in {"speed", "push"} & set(costs.costs.todict()):
                    costs.costs[name].weight = share
            share = SETTINGS.tolerance if weight == WEIGHTS[-1] else SETTINGS.coarse
            solver.th_stop = share * abs(cost)
            solver.solve(xs, us, ITERATIONS, False)  # noqa: FBT003
            xs, us, cost = solver.xs.tolist(), solver.us.tolist(), solver.cost
        return np.array(us)

    return run


def _point() -> pinocchio.Model:
    """Return 1 kg that moves along three axes, without gravity."""
    model = pinocchio.Model()
    joint = model.addJoint(0, pinocchio.JointModelTranslation(), pinocchio.SE3.Identity(), "point")
    inertia = pinocchio.Inertia(1.0, np.zeros(3), 1e-6 * np.eye(3))
    model.appendBodyToJoint(joint, inertia, pinocchio.SE3.Identity())
    model.gravity.linear = np.zeros(3)
    return model


def _limit(
    space: crocoddyl.StateMultibody, most: Mat, of: crocoddyl.ResidualModelAbstract
) -> crocoddyl.CostModelResidual:
    """Return the penalty on components beyond +-most."""
    bounds = crocoddyl.ActivationBounds(-most, most)
    return crocoddyl.CostModelResidual(space, crocoddyl.ActivationModelQuadraticBarrier(bounds), of)
