"""P3's Table I: what one prediction and one range cost in the tandem and the compound filter."""

from __future__ import annotations

from statistics import median
from typing import NamedTuple

import numba
import numpy as np
from filterpy.kalman import ExtendedKalmanFilter

from benchmarks.counted_arithmetic import Tally, counting, plain
from benchmarks.measure import Table, seconds
from missionkit.estimation.tandem_ekf import initialization
from missionkit.estimation.tandem_ekf.measurement_models import fuse_range
from missionkit.estimation.tandem_ekf.parameters import CompoundEkf, FlyerEkf, TandemEkf
from missionkit.estimation.tandem_ekf.process_model import predict
from missionkit.estimation.tandem_ekf.state_layout import AT, GATE_1, RANGE, ROW_WIDTH, TIME

ANCHORS = {"a": (1, -0.2, 0.5), "b": (1, 0.2, -0.5), "c": (-1, 0.2, -0.5), "d": (-1, -0.2, 0.5)}
PARTS = "missionkit.estimation.tandem_ekf"
MODULES = (
    "missionkit.geometry",
    "missionkit.estimation.linear_algebra",
    f"{PARTS}.process_model",
    f"{PARTS}.update",
    f"{PARTS}.measurement_models",
)
DT = 0.02
STEPS, TURNS = 20_000, 9


class Step(NamedTuple):
    """Arguments of one prediction and one range update."""

    x: np.ndarray
    P: np.ndarray
    A: np.ndarray
    u: np.ndarray
    row: np.ndarray
    settings: np.ndarray


def a_step(kind: type[FlyerEkf]) -> Step:
    """Return a filter at its start, turning and pushed, with a range to one anchor."""
    parameters = kind(anchors=ANCHORS, position=(0.0, 1.0, 0.0), radio=(0.05, 0.05, 0.0))
    x, P, A = initialization.start(parameters, compound=kind is CompoundEkf)
    x[TIME] = 0.0
    settings = initialization.settings_of(parameters)
    settings[GATE_1] = np.inf  # a refused range would cost less
    u = np.array([0.0, 0.05, -0.02, 0.01, 0.05, -0.03, 0.02, 0.0])
    row = np.zeros(ROW_WIDTH)
    place = np.array(ANCHORS["a"])
    row[:8] = [DT, RANGE, np.linalg.norm(x[:3] - place) + 0.01, 0.0, 0.0, *place]
    return Step(x, P, A, u, row, settings)


def operations(kind: type[FlyerEkf]) -> tuple[int, Step]:
    """Return how many operations one prediction and one range take, and the step after it."""
    tally, step = Tally(), a_step(kind)
    with plain(MODULES, tally) as (_, _, process, _, models):
        x, P, A, u, row, settings = (counting(part, tally) for part in step)
        process.predict(x, P, A, u, DT, settings)
        models.fuse_range(x, P, row, settings)
    done = Step(*(np.array(part, dtype=float) for part in (x, P, A, u, row, settings)))
    return tally.operations, done


@numba.njit
def repeat(n, x, P, A, u, row, settings):
    """Predict and take in a range n times."""
    for _ in range(n):
        predict(x, P, A, u, DT, settings)
        row[AT] = x[TIME]
        fuse_range(x, P, row, settings)


def held(kind: type[FlyerEkf]) -> int:
    """Return the bytes of error states and covariances."""
    step = a_step(kind)
    return 8 * 9 + step.P.nbytes + step.A.nbytes


def by_filterpy() -> float:
    """Return the time (s) of one step of filterpy's EKF with nine states."""
    kf = ExtendedKalmanFilter(dim_x=9, dim_z=1)
    kf.F[:3, 3:6] = DT * np.eye(3)
    H = np.zeros((1, 9))
    H[0, :3] = 1.0 / np.sqrt(3.0)

    def many() -> None:
        for _ in range(300):
            kf.predict()
            kf.update(np.zeros((1, 1)), lambda _: H, lambda x: H @ x)

    return seconds(many) / 300


def tables() -> list[Table]:
    """Count, and time in turns so that all see the same machine."""
    kinds = (TandemEkf, CompoundEkf)
    times: dict[str, list[float]] = {kind.kind: [] for kind in kinds} | {"filterpy": []}
    for kind in kinds:
        repeat(1, *a_step(kind))
    for _ in range(TURNS):
        for kind in kinds:
            times[kind.kind].append(seconds(repeat, STEPS, *a_step(kind)) / STEPS)
        times["filterpy"].append(by_filterpy())
    cost = [operations(kind)[0] for kind in kinds]
    took = [median(times[kind.kind]) for kind in kinds]
    room = [held(kind) for kind in kinds]
    rows = [
        (f"{name}", *(f"{scale * v:.{digits}f}" for v in pair), f"{pair[0] / pair[1]:.2f}", printed)
        for name, pair, scale, digits, printed in (
            ("operations", cost, 1.0, 0, "0.48"),
            ("time, us", took, 1e6, 2, "0.48"),
            ("bytes of error states and covariances", room, 1.0, 0, "0.20"),
        )
    ]
    peer = 1e6 * median(times["filterpy"])
    note = (
        "One prediction with one range, gyroscope and accelerometer, the same kernels in both: "
        f"counted with an instrumented float, and timed compiled, {TURNS} turns of {STEPS} steps, "
        f"medians. filterpy's EKF with nine states takes {peer:.0f} us. P3's 0.20 of the memory is "
        "that of a MATLAB workspace: (6² + 3²) / 9² = 0.56 is what the algorithm gives."
    )
    header = ("what", "tandem", "compound", "ratio", "P3, Table I")
    return [Table("Tandem and compound filter", header, rows, note)]
