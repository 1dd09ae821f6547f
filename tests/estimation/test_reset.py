"""Believing fixes that were refused for long."""

from __future__ import annotations

import numpy as np
import pytest

from missionkit.estimation.error_state_ekf.reset import agreeing, straightened


@pytest.mark.parametrize("count", [0, 1, 5])
def test_refused_fixes_on_a_straight_flight_have_no_residual(count):
    at = np.arange(float(count))
    strays = np.column_stack((at, 3.0 * at, -at, 5.0 + 0.0 * at, np.zeros((count, 3))))
    residual = straightened(strays)
    assert residual.shape == (count, 3)
    np.testing.assert_allclose(residual, 0.0, atol=1e-9)


def test_no_refused_fix_at_all_does_not_agree():
    assert not agreeing(straightened(np.empty((0, 7))), 3, 1.0)
