"""P3's Table I: the tandem filter takes at most 0.48 of the compound one's operations."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.tandem import DT, a_step, held, operations
from missionkit.estimation.tandem_ekf.measurement_models import fuse_range
from missionkit.estimation.tandem_ekf.parameters import CompoundEkf, TandemEkf
from missionkit.estimation.tandem_ekf.process_model import predict


@pytest.mark.parametrize("kind", [TandemEkf, CompoundEkf])
def test_the_counted_filter_computes_the_same_as_the_flown_one(kind):
    count, counted = operations(kind)
    x, P, A, u, row, settings = a_step(kind)
    predict(x, P, A, u, DT, settings)
    fuse_range(x, P, row, settings)
    assert count > 300
    np.testing.assert_allclose(counted.x, x, atol=1e-14)
    np.testing.assert_allclose(counted.P, P, rtol=1e-12, atol=1e-18)
    np.testing.assert_allclose(counted.A, A)


def test_half_the_operations():
    (tandem, _), (compound, _) = operations(TandemEkf), operations(CompoundEkf)
    assert tandem <= 0.48 * compound


def test_memory_is_that_of_the_covariances():
    assert held(TandemEkf) / held(CompoundEkf) == pytest.approx((9 + 36 + 9) / (9 + 81))
