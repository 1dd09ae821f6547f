"""The steady-state guard: entries, rows, the closed form, and what is unknown."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError
from samples import calm

from missionkit.guards.markov_steady_state import MarkovSteadyState
from missionkit.messages import Goal, Health, Look, Target, Verdict
from missionkit.plugin_protocols import Inputs
from missionkit.recorder import value_codec

NONE = Inputs({}, {}, ())
TWO = ("far", "near")


def two(p, q, **limit):
    """A chain that goes to `near` with p and back with q."""
    return MarkovSteadyState(
        states=TWO, matrix=(("rest", p), (q, "rest")), of="near", **(limit or {"at_least": 0.5})
    )


def asked(guard, seen=None, inputs=NONE, looks=()):
    memory = guard.begin()
    for look in looks:
        memory = guard.advance(memory, calm(looks=(look,)))
    return guard.check(memory, seen or calm(), inputs)


def pole(distance, **changes):
    values = {"position_sd": 0.2, "attitude": None, "angle_sd": None, "seen_at": 9.0} | changes
    return Target("pole", np.array([distance, 0.0, -5.0]), **values)


@pytest.mark.parametrize(
    ("p", "q", "value"), [(0.3, 0.0, 1.0), (0.0, 0.3, 0.0), (0.2, 0.6, 0.25), (1.0, 1.0, 0.5)]
)
def test_two_states_in_closed_form(p, q, value):
    verdict = asked(two(p, q, at_least=0.4))
    assert verdict.value == pytest.approx(value)
    assert (verdict.holds, verdict.threshold) == (value >= 0.4, 0.4)
    assert verdict.margin == pytest.approx(value - 0.4)
    assert asked(two(p, q, at_most=0.4)).holds is (value <= 0.4)


@given(st.just(0.0) | st.floats(1e-6, 80.0), st.just(0.0) | st.floats(1e-6, 1.0))
def test_a_distance_over_a_reference_is_clamped(distance, back):
    guard = two({"quantity": "distance to pole", "over": 40}, back)
    verdict = asked(guard, calm(targets={"pole": pole(distance)}))
    p = min(distance / 40.0, 1.0)
    if p == back == 0.0:
        assert verdict.holds is None
    else:
        assert verdict.value == pytest.approx(p / (p + back), abs=1e-9)


def test_live_chains_that_stand_still_are_unknown_and_the_reason_names_where():
    variable = {"variable": "tries"}
    guard = two(variable, variable)
    still, moving = (Inputs({}, {"tries": n}, ()) for n in (0, 1))
    verdict = asked(guard, inputs=still)
    assert (verdict.holds, verdict.value) == (None, None)
    assert verdict.why == "the chain may end in far or near: its steady state is not unique"
    assert asked(guard, inputs=moving).value == 0.5


def test_a_periodic_chain_says_so():
    assert asked(two(1.0, 1.0)).why.startswith("the chain has period 2")
    assert "period" not in asked(two(1.0, 0.5)).why


def test_a_transient_state_has_no_probability():
    guard = MarkovSteadyState(
        states=("start", "a", "b"),
        matrix=((0.0, 0.5, "rest"), (0.0, 0.5, "rest"), (0.0, 0.25, "rest")),
        of="start",
        at_most=0.0,
    )
    assert asked(guard) == Verdict(True, "", 0.0, 0.0, 0.0)


def test_a_complement_a_product_a_variable_and_the_value_of_a_guard():
    term = {"product": ({"variable": "tries", "over": 4}, {"guard": "gap", "over": 10})}
    guard = two(term, {"quantity": "battery", "complement": True})
    inputs = Inputs({"gap": Verdict.below(5.0, 9.0)}, {"tries": 2}, ())
    verdict = asked(guard, inputs=inputs)
    p, q = 2 / 4 * 5 / 10, 1.0 - 0.9
    assert verdict.value == pytest.approx(p / (p + q))
    assert verdict.why == "far to near 0.25, near to far 0.1"


def test_entries_in_words():
    seldom = {"quantity": "battery", "over": 2, "complement": True}
    guard = two({"product": (seldom, "consistency")}, seldom)
    assert guard.text() == (
        "of near at least 0.5; far to far rest, near (1 - battery / 2) * consistency; "
        "near to far 1 - battery / 2, near rest"
    )


def test_the_confidence_is_the_share_of_the_last_frames():
    guard = two({"quantity": "confidence of pole", "window": 4}, 0.5)
    assert asked(guard).why == "far: no frame was due yet"
    looks = [Look(0.0, frozenset({"pole"} if hit else ())) for hit in (1, 0, 1, 1, 1)]
    assert asked(guard, looks=looks).value == pytest.approx(0.75 / 1.25)
    memory = guard.advance(guard.begin(), calm(looks=tuple(looks)))
    assert value_codec.read(value_codec.written(memory)) == memory


@pytest.mark.parametrize(
    ("entry", "seen", "why"),
    [
        ("distance to pole", calm(), "far: the position of pole is unknown"),
        ("distance to the goal", calm(), "far: the behaviour has no goal yet"),
        ("height sd", calm(), "far: the navigator does not say how well the height is known"),
        ("mahalanobis distance", calm(), "far: the navigator took in no measurement lately"),
        ("consistency", calm(), "far: the navigator took in no measurement lately"),
        ("battery", calm(battery=None), "far: there is no fresh battery reading"),
        ("range to the ground", calm(), "far: there is no fresh range to the ground"),
        ("time since pole was seen", calm(), "far: pole was never seen"),
        ("position sd", calm(health=Health(False, False, None, None, 9.0, 0)), "far: the pos"),
    ],
)
def test_a_missing_quantity_gives_unknown(entry, seen, why):
    verdict = asked(two({"quantity": entry, "over": 10}, 0.5), seen)
    assert verdict.holds is None
    assert verdict.why.startswith(why)


def test_quantities_of_the_estimate():
    health = Health(True, False, 10.0, None, 0.3, 0, height_sd=0.4, mahalanobis=1.0)
    seen = calm(
        health=health,
        targets={"pole": pole(6.0)},
        goal=Goal(np.array([0.0, 3.0, -5.0]), None, 10.0),
        velocity=np.array([0.0, 0.0, 0.5]),
    )
    wanted = {
        "distance to pole": 6.0,
        "distance to home": 5.0,
        "distance to the goal": 3.0,
        "position sd": 0.3,
        "position sd of pole": 0.2,
        "height sd": 0.4,
        "height above take-off": 5.0,
        "mahalanobis distance": 1.0,
        "consistency": 0.5,
        "battery": 0.9,
        "speed": 0.5,
        "time since pole was seen": 1.0,
    }
    for name, x in wanted.items():
        p = min(x / 10.0, 1.0)
        verdict = asked(two({"quantity": name, "over": 10.0}, 0.25), seen)
        assert verdict.value == pytest.approx(p / (p + 0.25)), name


def test_a_value_that_is_not_a_number_is_unknown():
    seen = calm(targets={"pole": pole(math.nan)})
    verdict = asked(two({"quantity": "distance to pole", "over": 40}, 0.5), seen)
    assert (verdict.holds, verdict.value) == (None, None)


def test_a_guard_without_a_value_is_unknown():
    inputs = Inputs({"gap": Verdict.unknown("no reading")}, {}, ())
    assert asked(two({"guard": "gap"}, 0.5), inputs=inputs).why == "far: gap: no reading"


def test_a_row_of_quantities_that_does_not_add_up_to_one_is_unknown():
    row = ({"variable": "a"}, {"variable": "b"})
    guard = MarkovSteadyState(states=TWO, matrix=(row, (0.5, "rest")), of="near", at_least=0.5)
    for a, b, known in ((0.3, 0.7, True), (0.3, 0.6, False), (0.3, 0.8, False)):
        verdict = asked(guard, inputs=Inputs({}, {"a": a, "b": b}, ()))
        assert (verdict.holds is not None) is known
    assert verdict.why == "far: the row adds up to 1.1, not to 1"


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"matrix": ((0.5, 0.6), (0.5, 0.5))}, "the row adds up to 1.1, not to 1"),
        ({"matrix": ((0.5, 0.5 + 2e-9), (0.5, 0.5))}, "adds up to 1.000000002, not to 1"),
        ({"matrix": (("rest", "rest"), (0.5, 0.5))}, "only one entry of a row can be 'rest'"),
        ({"matrix": ((0.7, "rest", 0.5), (1, 0, 0))}, "its numbers alone add up to 1.2"),
        ({"matrix": ((1, 0), (0, 1))}, "the chain may end in far or near"),
        ({"matrix": ((1, 0),)}, "2 states need as many rows, got 1"),
        ({"matrix": ((1, 0), (1,))}, "the row of 'near' needs 2 entries"),
        ({"states": ("far", "far")}, "state 'far' is named twice"),
        ({"of": "nea"}, "unknown state 'nea'; did you mean 'near'"),
        ({"at_most": 0.5}, "expected one of 'at_least' and 'at_most'"),
        ({"matrix": (("rest", "speeed"), (0.5, 0.5))}, "unknown quantity 'speeed'"),
        ({"matrix": (("rest", {"over": 2}), (0.5, 0.5))}, "expected one of quantity, variable"),
        ({"rows": {"far": {"near": 1.0}}}, "expected 'states' and 'matrix', or 'chain'"),
    ],
)
def test_mistakes_are_refused(changes, message):
    good = {"states": TWO, "matrix": ((0.5, 0.5), (0.5, 0.5)), "of": "near", "at_least": 0.5}
    MarkovSteadyState.model_validate(good)
    MarkovSteadyState.model_validate({**good, "matrix": ((0.5, 0.5 + 5e-10), (0.5, 0.5))})
    with pytest.raises(ValidationError, match=message):
        MarkovSteadyState.model_validate({**good, **changes})


CHAIN = {
    "chain": 1,
    "flights": 20,
    "states": ("gps", "visual", "success"),
    "endings": ("success",),
    "matrix": ((0.5, 0.5, 0.0), (0.25, 0.0, 0.75), (1.0, 0.0, 0.0)),
}


def test_the_chain_of_a_campaign_with_a_live_row():
    learned = MarkovSteadyState(chain=CHAIN, of="success", at_least=0.1)
    P = np.array(CHAIN["matrix"])
    pi = np.linalg.lstsq(np.vstack([P.T - np.eye(3), np.ones(3)]), [0, 0, 0, 1], rcond=None)[0]
    assert asked(learned).value == pytest.approx(pi[2])
    live = MarkovSteadyState(
        chain=CHAIN,
        rows={"visual": {"success": "battery", "gps": "rest"}},
        of="success",
        at_least=0.1,
    )
    assert asked(live).value > asked(learned).value
    with pytest.raises(ValidationError, match="unknown state 'sucess'"):
        MarkovSteadyState(chain=CHAIN, of="sucess", at_least=0.1)


@given(st.floats(0, 1), st.floats(0, 1), st.floats(0.5, 3.0))
def test_the_region_holds_every_value_that_the_verdict_can_have(a, b, over):
    guard = two({"variable": "a", "over": over}, {"quantity": "battery", "over": 2})
    region = guard.region()
    ((quantity, interval),) = region.may[0].items()
    seen = calm(battery=calm().battery._replace(charge=b))
    verdict = asked(guard, seen, Inputs({}, {"a": a}, ()))
    if verdict.value is not None:
        assert quantity.least <= verdict.value <= quantity.most
        assert verdict.holds is (interval.low <= verdict.value)


def test_bounds_of_two_states_are_exact():
    ((quantity, _),) = two(0.3, {"quantity": "battery", "over": 2}).region().may[0].items()
    assert (quantity.least, quantity.most) == pytest.approx((0.3 / 0.8, 1.0))
    ((quantity, _),) = two(0.2, 0.6).region().may[0].items()
    assert (quantity.least, quantity.most) == pytest.approx((0.25, 0.25))
