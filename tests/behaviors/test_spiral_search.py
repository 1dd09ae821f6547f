"""The search pattern as a behaviour."""

from __future__ import annotations

import math

import numpy as np
import pytest
from playing import TICK, at, marker, play
from pydantic import ValidationError

from missionkit.behaviors.spiral import Spiral
from missionkit.geometry import norm, vec

TRUNK = marker(20.0, 5.0, -3.0)
FORMS = {
    "steady": Spiral(target="trunk", speed=0.8, footprint=1.5, outer=4.0, back=1.5),
    "paper": Spiral(
        target="trunk", form="paper", speed=0.8, footprint=2.0, outer=4.0, growth=0.15, rate=0.6
    ),
}


def searched(behavior: Spiral, seconds: float, **targets):
    """Fly the pattern exactly; return the steps."""
    times = [10.0 + TICK * n for n in range(round(seconds / TICK))]
    return play(behavior, [at(now, 14.0, 5.0, -4.0, targets=targets) for now in times])


@pytest.mark.parametrize("form", FORMS)
def test_the_pattern_is_level_continuous_and_keeps_to_its_speed(form):
    steps = searched(FORMS[form], 30.0, trunk=TRUNK)
    places = np.array([step.guidance.position for step in steps])
    np.testing.assert_allclose(places[:, 2], -4.0)
    speeds = np.linalg.norm(np.diff(places, axis=0), axis=1) / TICK
    assert speeds.max() <= 0.8 + 1e-6
    wanted = np.array([step.guidance.velocity for step in steps])
    moved = (places[2:] - places[:-2]) / (2.0 * TICK)
    np.testing.assert_allclose(moved[20:], wanted[21:-1], atol=0.05)
    assert max(map(norm, wanted)) <= 0.8 + 1e-9
    radii = np.linalg.norm(places[:, :2] - steps[0].goal.position[:2], axis=1)
    assert 2.0 < radii.max() <= 4.0 + 1e-9


def test_the_steady_form_keeps_its_speed_and_the_paper_form_its_turn_rate_near_the_centre():
    steady, paper = (searched(FORMS[form], 2.0, trunk=TRUNK) for form in ("steady", "paper"))
    assert norm(steady[20].guidance.velocity) == pytest.approx(0.8)
    # r = v_r t: radius 0.15 m after one second, and its velocity √(v_r² + (ω r)²)
    centre = paper[0].goal.position
    assert norm(paper[20].guidance.position - centre) == pytest.approx(0.15)
    assert norm(paper[20].guidance.velocity) == pytest.approx(math.hypot(0.15, 0.6 * 0.15))


def test_the_centre_lies_back_from_the_target_where_the_camera_sees_more():
    steps = searched(FORMS["steady"], 1.0, trunk=TRUNK)
    np.testing.assert_allclose(steps[0].goal.position, (12.5, 5.0, -4.0))
    assert {step.goal.at for step in steps} == {10.0}


@pytest.mark.parametrize("targets", [{}, {"trunk": marker(14.0, 5.0, -2.0)}])
def test_without_a_direction_to_the_target_the_centre_is_here(targets):
    (step,) = play(FORMS["steady"], [at(10.0, 14.0, 5.0, -4.0, targets=targets)])
    np.testing.assert_allclose(step.goal.position, (14.0, 5.0, -4.0))


def test_it_always_faces_where_the_target_was_last():
    places = [(14.0, 5.0), (14.0, 0.0), (24.0, 5.0)]
    story = [at(10.0 + n, *xy, -4.0, targets={"trunk": TRUNK}) for n, xy in enumerate(places)]
    faced = [step.guidance.yaw for step in play(FORMS["steady"], story)]
    assert faced == pytest.approx([0.0, math.atan2(5.0, 6.0), math.pi])
    assert searched(FORMS["steady"], 0.1)[0].guidance.yaw is None


def test_the_estimate_is_left_as_it_was():
    seen = at(10.0, 14.0, 5.0, -4.0, targets={"trunk": TRUNK})
    FORMS["steady"].begin(seen)
    np.testing.assert_array_equal(seen.position, vec(14.0, 5.0, -4.0))
    np.testing.assert_array_equal(TRUNK.position, vec(20.0, 5.0, -3.0))


@pytest.mark.parametrize("wrong", [{"speed": 0}, {"outer": -1}, {"form": "square"}, {"rate": 0}])
def test_a_pattern_that_cannot_be_flown_is_refused(wrong):
    with pytest.raises(ValidationError):
        Spiral(target="trunk", **wrong)


@pytest.mark.parametrize("form", FORMS)
def test_the_pattern_keeps_before_the_plane_off_the_marker(form):
    spiral = FORMS[form].model_copy(update={"standoff": 5.0, "back": 0.0})
    for target in (TRUNK, TRUNK._replace(attitude=None)):
        steps = searched(spiral, 30.0, trunk=target)
        places = np.array([step.guidance.position for step in steps])
        assert places[:, 0].max() <= 15.15 + 1e-9
        assert places[:, 0].min() < 12.0
        assert all(step.bound is not None for step in steps)
        assert np.abs(np.diff(places[:, 0])).max() <= 0.8 * TICK + 1e-6


def test_a_target_too_near_to_decide_a_side_sets_no_bound():
    near = marker(14.5, 5.0, -4.0)._replace(attitude=None)
    (step, *_) = searched(FORMS["steady"].model_copy(update={"back": 0.0}), 0.1, trunk=near)
    assert step.bound is None


@pytest.mark.parametrize("form", FORMS)
def test_a_search_about_the_target_begins_at_the_first_radius_and_flies_over_it(form):
    spiral = Spiral(**FORMS[form].model_dump() | {"inner": 1.0, "centre": "target"})
    steps = searched(spiral, 30.0, trunk=TRUNK)
    centre = steps[0].goal.position
    np.testing.assert_allclose(centre, (20.0, 5.0, -4.0))
    places = np.array([step.guidance.position for step in steps])
    radii = np.linalg.norm(places[:, :2] - centre[:2], axis=1)
    assert radii[0] == pytest.approx(1.0)
    assert radii.min() >= 1.0 - 1e-9
    assert places[:, 0].max() > 21.0  # beyond the marker's plane
    assert {step.bound for step in steps} == {None}


def test_an_inner_radius_that_leaves_nothing_to_search_is_refused():
    with pytest.raises(ValidationError, match="inner < outer"):
        Spiral(target="trunk", inner=4.0, outer=4.0)
