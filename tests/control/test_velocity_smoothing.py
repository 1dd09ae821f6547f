from __future__ import annotations

import numpy as np
import pytest
from scipy import signal

from missionkit.control.velocity_smoothing import alpha_at, smoothed


def test_is_scipys_first_order_filter():
    alpha = 0.3
    commands = np.random.default_rng(2).standard_normal((100, 3))
    expected = signal.lfilter([alpha], [1.0, alpha - 1.0], commands, axis=0)
    state, got = (0.0, 0.0, 0.0), []
    for row in commands:
        state = smoothed(state, tuple(row), alpha)
        got.append(state)
    np.testing.assert_allclose(got, expected, atol=1e-12)


@pytest.mark.parametrize("alpha", [0.0, 0.2, 1.0])
def test_time_constant_does_not_depend_on_the_rate(alpha):
    assert alpha_at(alpha, 0.05) == pytest.approx(alpha)
    half = alpha_at(alpha, 0.025)
    twice = smoothed(smoothed((1.0, 0, 0), (0.0, 0, 0), half), (0.0, 0, 0), half)
    assert twice[0] == pytest.approx(1.0 - alpha)


def test_no_time_no_change():
    assert alpha_at(1.0, 0.0) == 0.0
