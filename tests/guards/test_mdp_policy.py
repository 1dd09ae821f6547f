"""The policy of a decision process, followed by where the process is."""

from __future__ import annotations

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError
from samples import calm

from missionkit.guards.mdp_policy import MdpPolicy
from missionkit.messages import Verdict
from missionkit.plugin_protocols import Inputs

# Pressing on works nine times in ten while the marker is sure; blind it mostly ends badly.
PROCESS = {
    "states": ("sure", "weak", "blind", "done", "home", "lost"),
    "actions": {
        "press-on": {
            "leads": {
                "sure": {"done": 0.9, "weak": "rest"},
                "weak": {"done": 0.2, "sure": 0.2, "blind": "rest"},
                "blind": {"done": 0.1, "lost": "rest"},
            },
        },
        "search": {
            "leads": {
                "weak": {"sure": 0.7, "blind": "rest"},
                "blind": {"weak": 0.05, "blind": 0.95},
            },
            "cost": 1.0,
        },
        "go-home": {"leads": {"sure": "home", "weak": "home", "blind": "home"}, "cost": 2.0},
    },
    "final": {"home": 20.0, "lost": 200.0},
}
WHERE = {"sure": "marker-sure", "weak": "marker-seen", "blind": "flying"}
YES, NO, DARK = Verdict(True), Verdict(False), Verdict.unknown("no frame yet")


def policy(action, **changes):
    return MdpPolicy.model_validate({**PROCESS, "action": action, **changes})


def asked(guard, *answers):
    names = dict(zip(guard.where.values(), answers, strict=True))
    return guard.check(None, calm(), Inputs(names, {}, ("watch", "blind")))


def test_the_policy_is_the_best_of_all_that_never_change():
    guard = policy("search")
    names, n = guard.names, len(guard.names)
    solution = guard.solution
    best = [float("inf")] * n
    choices = [list(guard._choices(state)) for state in names]
    for fixed in itertools.product(*[each or [None] for each in choices]):
        values = [guard.final.get(state, 0.0) for state in names]
        for _ in range(3000):
            values = [
                values[s]
                if it is None
                else it.cost + sum(p * values[to] for to, p in it.leads.items())
                for s, it in enumerate(fixed)
            ]
        best = [min(a, b) for a, b in zip(best, values, strict=True)]
    assert solution.values == pytest.approx(best, abs=1e-6)
    assert policy("press-on").chosen == ("sure",)
    assert policy("search").chosen == ("weak",)
    assert policy("go-home").chosen == ("blind",)


def test_it_holds_where_the_action_is_the_best_and_says_what_each_costs():
    guard = policy("search", where=WHERE)
    verdict = asked(guard, NO, YES, YES)
    assert verdict.holds is True
    costs = guard._costs_in("weak")
    assert verdict.value == costs["search"]
    assert verdict.threshold == min(costs["press-on"], costs["go-home"])
    assert verdict.margin == pytest.approx(verdict.threshold - verdict.value)
    assert verdict.margin > 0.0
    assert verdict.why.startswith("in weak: press-on ")
    verdict = asked(guard, YES, YES, YES)
    assert verdict.why == "in sure, where search cannot be chosen"
    assert verdict.holds is False
    assert asked(guard, NO, NO, NO).why == "in none of the states of the process"


TRUTH = st.sampled_from([True, False, None])


def kleene(chosen, states, truths):
    """Any of: in a chosen state and in none before it, in three-valued logic."""
    terms = []
    for n, state in enumerate(states):
        if state in chosen:
            parts = [None if t is None else not t for t in truths[:n]] + [truths[n]]
            terms.append(False if False in parts else None if None in parts else True)
    return True if True in terms else None if None in terms else False


@given(st.sampled_from(["press-on", "search", "go-home"]), st.tuples(TRUTH, TRUTH, TRUTH))
def test_it_is_unknown_only_where_that_decides(action, truths):
    guard = policy(action, where=WHERE)
    verdicts = [DARK if it is None else YES if it else NO for it in truths]
    assert asked(guard, *verdicts).holds is kleene(guard.chosen, list(WHERE), truths)


def test_without_where_the_state_is_that_of_the_chart():
    guard = policy("go-home")
    verdict = guard.check(None, calm(), Inputs({}, {}, ("watch", "blind")))
    assert verdict.holds is True
    assert guard.check(None, calm(), Inputs({}, {}, ("watch",))).holds is False


CHAIN = {
    "chain": 1,
    "states": ("gps", "visual", "return", "success", "crash"),
    "endings": ("success", "crash"),
    "matrix": (
        (0.0, 0.8, 0.2, 0.0, 0.0),
        (0.3, 0.0, 0.6, 0.0, 0.1),
        (0.0, 0.0, 0.0, 1.0, 0.0),
        (1.0, 0.0, 0.0, 0.0, 0.0),
        (1.0, 0.0, 0.0, 0.0, 0.0),
    ),
    "dwell": {"gps": 10.0, "visual": 20.0, "return": 15.0},
}


def test_an_action_follows_the_chain_of_a_campaign():
    going = {"learned": ("gps", "visual", "return"), "cost": 0.0, "per_second": 1.0}
    home = {"leads": {"gps": "return", "visual": "return"}, "cost": 30.0}
    guard = MdpPolicy(
        chain=CHAIN, actions={"go-on": going, "go-home": home}, final={"crash": 1e3}, action="go-on"
    )
    # home costs 30 + 15 s; going on from visual 20 s + 0.3 · 45 + 0.6 · 15 s, and crashes
    assert policy_values(guard)["return"] == pytest.approx(15.0)
    assert policy_values(guard)["visual"] == pytest.approx(45.0)
    assert guard.chosen == ("return",)
    safe = MdpPolicy.model_validate({**guard.model_dump(), "final": {}})
    assert policy_values(safe)["visual"] == pytest.approx(42.5)
    assert safe.chosen == ("visual", "return")


def policy_values(guard):
    return dict(zip(guard.names, guard.solution.values, strict=True))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"action": "serch"}, "unknown action 'serch'; did you mean 'search'"),
        ({"final": {"crash": 1.0}}, "unknown state 'crash'"),
        ({"where": {"sur": "marker-sure"}}, "unknown state 'sur'; did you mean 'sure'"),
        ({"states": ("sure", "sure")}, "named twice"),
        (
            {"actions": {"go": {"leads": {"sure": {"done": 0.9, "weak": 0.2}}}}, "action": "go"},
            "go in sure: the probabilities add up to 1.1, not to 1",
        ),
        (
            {"actions": {"go": {"leads": {"sure": {"done": "rest", "weak": "rest"}}}}},
            "of which one may be 'rest'",
        ),
        ({"actions": {"go": {"leads": {"sure": "sure"}}}, "action": "go"}, "no policy found"),
        ({"actions": {"go": {"learned": ("sure",)}}, "action": "go"}, "the chain says nothing"),
    ],
)
def test_mistakes_are_refused(changes, message):
    changes = {"action": "go" if "actions" in changes else "search", **changes}
    with pytest.raises(ValidationError, match=message):
        MdpPolicy.model_validate({**PROCESS, **changes})
