"""The observer of what disturbs the vehicle: learnt from its own model, and in a flight."""

from __future__ import annotations

import math

import numpy as np
import pytest
from control.lagging import fly

from missionkit.control.controller import Control
from missionkit.control.disturbance_observer import (
    DisturbanceObserver,
    Observed,
    correction,
    observed,
)
from missionkit.geometry import vec
from missionkit.messages import Guidance, Mode

DT = 0.05
MODEL = DisturbanceObserver()


def learnt(disturbance, seconds=3.0, dt=DT):
    """The observer after some time on a vehicle that is exactly its model, sent 1 m/s north."""
    k, v, w, memory = MODEL.gain[0], 0.0, 0.0, Observed()
    errors = []
    for _ in range(round(seconds / dt)):
        memory = observed(MODEL, memory, (v, 0.0, 0.0), dt)._replace(sent=(1.0, 0.0, 0.0))
        errors.append(abs(memory.disturbance[0] - disturbance))
        w += (1.0 - math.exp(-dt / MODEL.lag)) * (1.0 - w)
        keep = math.exp(-k * dt)
        v = keep * v + (1.0 - keep) * (w + disturbance / k)
    return memory, np.array(errors)


@pytest.mark.parametrize("disturbance", [-1.2, 0.0, 0.7])
def test_it_learns_a_constant_disturbance_with_the_stated_pole(disturbance):
    memory, errors = learnt(disturbance)
    assert memory.disturbance[0] == pytest.approx(disturbance, abs=1e-4)
    assert correction(MODEL, memory)[0] == pytest.approx(-disturbance / MODEL.gain[0], abs=1e-4)
    # (1 + p t) exp(-p t), two equal poles: 4 % are left after one second at 5 / s
    share = (1.0 + MODEL.pole) * math.exp(-MODEL.pole)
    assert errors[round(1.0 / DT)] <= 1.5 * share * abs(disturbance) + 1e-9


def test_what_it_adds_is_bounded_and_what_is_not_finite_is_ignored():
    memory, _ = learnt(50.0)
    assert abs(correction(MODEL, memory)[0]) == pytest.approx(MODEL.limit)
    assert observed(MODEL, memory, (math.nan, 0.0, 0.0), DT) == memory
    assert observed(MODEL, memory, (0.0, 0.0, 0.0), 0.0) == memory


def drift(control):
    """How far (m) a vehicle stays off its point in a steady push."""
    track = fly(
        control,
        lambda _: Guidance(vec(0.0, 0.0, 0.0), 5.0, vec(0.0, 0.0, 0.0), avoid=False),
        8.0,
        lambda _: Mode.TRAJECTORY,
        lambda _: vec(0.5, 0.0, 0.0),
    )
    return float(np.abs(track.position[-20:, 0]).max()), track


def test_it_replaces_the_integral_of_a_position_error():
    gains = {"kp": (1.0, 1.0), "ki": (0.0, 0.0), "kd": (0.0, 0.0)}
    plain = Control.model_validate({"trajectory": gains})
    helped = Control.model_validate({"trajectory": gains, "observer": {"gain": (4.0, 4.0)}})
    assert drift(plain)[0] > 0.4
    assert drift(helped)[0] < 0.02


def test_without_an_observer_nothing_is_added():
    _, track = drift(Control())
    _, again = drift(Control(observer=None))
    assert np.array_equal(track.command, again.command)
