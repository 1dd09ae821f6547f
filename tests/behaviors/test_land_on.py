"""Landing on a pad: what it asks for, along the way and when the pad does not come into view."""

from __future__ import annotations

import numpy as np
import pytest
from behaviors.playing import TICK, play, status
from samples import calm

from missionkit.behaviors.land_on import ABORTED, GIVEN_UP, OVER, UNSEEN, LandOn
from missionkit.geometry import vec
from missionkit.messages import Target

PAD = vec(10.0, 0.0, 0.0)


def seen(now, left, height, *, sd=0.25, sighted=None, velocity=(0.0, 0.0, 0.0), pad=True):
    target = Target("pad", PAD, sd, None, None, sighted)
    return calm(
        now=now,
        position=vec(10.0 - left, 0.0, -height),
        velocity=np.array(velocity),
        targets={"pad": target} if pad else {},
    )


def rate(behavior, **where):
    """The rate of descent asked for, two seconds after a start 10 m from the pad and 3 m up."""
    begun = behavior.begin(seen(0.0, 10.0, 3.0))
    step = behavior.step(seen(2.0, **where), begun)
    return float(step.guidance.velocity[2])


def test_out_of_sight_it_keeps_the_height_that_the_uncertainty_asks_for():
    glide = LandOn(target="pad", phase="glide", half_angle_deg=25)
    unsure, sure = {"left": 0.3, "sd": 0.25}, {"left": 0.3, "sd": 0.02}
    assert rate(glide, height=1.8, **unsure) < 0.1
    assert rate(glide, height=1.0, **unsure) < 0.0  # too low: up again
    assert rate(glide, height=1.5, **sure) > 0.5
    assert rate(glide, height=1.5, left=0.3, sd=0.25, sighted=1.9) > 0.5  # in view


def test_without_sigmas_the_estimate_is_trusted():
    blind = LandOn(target="pad", phase="glide", half_angle_deg=25, sigmas=0.0, least=0.0)
    assert rate(blind, height=1.0, left=0.05, sd=0.5) > 0.5


def test_sideways_first_and_down_late():
    glide = LandOn(target="pad", phase="glide", half_angle_deg=25)
    high = rate(glide, height=3.0, left=9.0, sighted=1.9)
    late = rate(glide, height=3.0, left=1.5, sighted=1.9, velocity=(2.0, 0.0, 0.0))
    assert high == pytest.approx(0.0, abs=0.05)
    assert late > 1.0


def test_level_speed_falls_in_time_for_the_pad():
    glide = LandOn(target="pad", phase="glide", half_angle_deg=25)
    begun = glide.begin(seen(0.0, 10.0, 3.0))
    for left in (4.0, 2.0, 1.0):
        fast = (np.sqrt(2.0 * 2.0 * left), 0.0, 0.0)
        step = glide.step(seen(2.0, left, 3.0, velocity=fast), begun)
        asked = step.guidance.velocity[0]
        assert 0.0 < asked < fast[0]


def test_over_the_pad_it_hands_over_and_aside_it_does_not():
    down = LandOn(target="pad", half_angle_deg=25, phase="descend")
    assert play(down, [seen(0.0, 0.05, 0.1, sighted=0.0)])[0].done
    aside = play(down, [seen(0.0, 0.6, 0.45, sighted=0.0)])[0]
    assert not aside.done
    assert aside.guidance.velocity[2] == pytest.approx(0.4)
    above = play(down, [seen(0.0, 0.6, 0.5, sighted=0.0)])[0]
    assert above.guidance.velocity[2] < 0.2


def test_it_does_not_hover_where_optical_flow_is_blind():
    down = LandOn(target="pad", half_angle_deg=25, phase="descend")
    low = play(down, [seen(0.0, 0.6, 0.3, sighted=0.0)])[0]
    assert low.guidance.velocity[2] >= 0.4


def test_a_descent_that_loses_the_pad_waits_but_not_in_the_dark():
    down = LandOn(target="pad", half_angle_deg=25, phase="descend")
    begun = down.begin(seen(0.0, 0.05, 2.0, sighted=0.0))
    assert down.step(seen(1.0, 0.05, 1.5, sighted=0.2), begun).guidance.velocity[2] == 0.0
    assert down.step(seen(1.0, 0.05, 0.4, sighted=0.2), begun).guidance.velocity[2] > 0.1


def test_deviating_it_says_once_that_the_pad_is_below():
    look = LandOn(target="pad", half_angle_deg=25, phase="deviate")
    steps = play(look, [seen(n * TICK, 0.1, 1.9, sighted=n * TICK) for n in range(20)])
    assert [step.events for step in steps] == [(OVER,)] + [()] * 19


def test_a_pad_that_stays_out_of_view_is_searched_from_higher_up_then_abandoned():
    look = LandOn(target="pad", half_angle_deg=25, phase="deviate", highest=4.0)
    steps = play(look, [seen(n * TICK, 0.1, 1.9) for n in range(300)])
    rates = [float(step.guidance.velocity[2]) for step in steps]
    assert abs(rates[5]) < 0.3
    assert min(rates) == -0.5  # it climbs, no faster
    events = [event for step in steps for event in step.events]
    assert events == [UNSEEN]


def test_without_a_target_it_asks_for_nothing():
    steps = play(
        LandOn(target="pad", phase="glide"), [seen(n * TICK, 1.0, 2.0, pad=False) for n in (0, 1)]
    )
    assert all(step.guidance is None and not step.done for step in steps)
    assert "not known" in steps[0].note


DOWN = LandOn(target="pad", half_angle_deg=25, retries=1, descent=1.0)


def story(*parts, sighted=None):
    """Estimates at every tick: for each part (seconds, left, height, seen or not)."""
    now, found = 0.0, []
    for seconds, left, height, visible in parts:
        for _ in range(round(seconds / TICK)):
            sighted = now if visible else sighted
            found.append(seen(now, left, height, sd=0.05, sighted=sighted))
            now += TICK
    return found


def rates(steps):
    return [float(step.guidance.velocity[2]) for step in steps]


def events_of(steps):
    return [event for step in steps for event in step.events]


def test_it_comes_down_only_while_it_is_over_the_pad():
    """Over it: within `aside`, 0.1 m, and 8 degrees: 0.66 m at 4 m."""
    aside = play(DOWN, story((1.0, 0.8, 4.0, True)))
    over = play(DOWN, story((1.0, 0.5, 4.0, True)))
    assert max(rates(aside)) == 0.0
    assert min(rates(over)) > 0.5


def test_the_pad_out_of_sight_stops_it_then_it_climbs_and_the_tries_are_counted():
    steps = play(
        DOWN,
        story(
            (0.5, 0.05, 3.0, True), (3.0, 0.05, 3.0, False), (0.5, 0.05, 3.0, True),
            (10.0, 0.05, 3.0, False),
        ),
    )  # fmt: skip
    down = rates(steps)
    assert min(down[:10]) > 0.5
    assert down[25] == 0.0  # 0.75 s without a sighting: it waits
    assert min(down[45:70]) < -0.3  # 1.5 s: it turns back
    assert [it for it in events_of(steps) if it != OVER] == [ABORTED, GIVEN_UP]
    assert steps[-1].memory.aborts == 2
    assert "attempt 2 of 2" in " ".join(step.note for step in steps)


def test_given_up_it_stays_up_even_when_the_pad_is_seen_again():
    steps = play(
        DOWN,
        story((0.5, 0.05, 3.0, True), (3.0, 0.05, 3.0, False), (0.5, 0.05, 3.0, True),
              (3.0, 0.05, 3.0, False), (5.0, 0.05, 4.0, True)),
    )  # fmt: skip
    assert GIVEN_UP in events_of(steps)
    assert max(rates(steps)[-90:]) < 0.05
    assert not any(step.done for step in steps)


def test_near_the_ground_it_is_blind_for_a_bounded_time():
    steps = play(DOWN, story((0.3, 0.03, 0.5, True), (3.0, 0.03, 0.5, False)))
    down = rates(steps)
    assert min(down[: round(2.0 / TICK)]) > 0.1  # `blind_for`
    assert min(down[round(2.5 / TICK) :]) < -0.3


def test_far_off_the_pad_near_the_ground_it_turns_back_but_not_in_the_last_decimetres():
    low = play(DOWN, [seen(0.0, 0.3, 0.4, sighted=0.0)])[0]
    lower = play(DOWN, [seen(0.0, 0.3, 0.18, sighted=0.0)])[0]
    assert low.events == (ABORTED,)
    assert lower.events == ()
    assert lower.guidance.velocity[2] > 0.3


def test_a_pad_that_moves_is_flown_along_with_until_the_autopilot_is_down():
    target = Target("pad", PAD, 0.02, None, None, 0.0, vec(0.6, -0.3, 0.0))
    above = calm(now=0.0, position=vec(10.0, 0.0, -0.08), velocity=vec(0.6, -0.3, 0.3))
    above = above._replace(targets={"pad": target})
    step = play(DOWN, [above])[0]
    assert not step.done
    assert step.guidance.velocity[:2] == pytest.approx([0.6, -0.3])
    landed = above._replace(status=status(in_air=False), velocity=vec(0.6, -0.3, 0.0))
    assert play(DOWN, [landed])[0].done
    still = above._replace(targets={"pad": target._replace(velocity=None)})
    assert play(DOWN, [still])[0].done
