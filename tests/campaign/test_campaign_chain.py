from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from campaigns import row

from missionkit.campaigns.markov_chain import (
    Chain,
    Ending,
    absorbed,
    estimate,
    likeliest,
    passed,
    time_left,
)

HOME, HURT = Ending("success", "land"), Ending("crash", "out")


@pytest.mark.parametrize("p", [0.3, 0.5, 0.72])
def test_the_gambler_is_ruined_as_often_and_as_fast_as_the_closed_form_says(p):
    n, q = 9, 1.0 - p
    inner, outer = np.zeros((n, n)), np.zeros((n, 2))
    for k in range(n):
        (outer, inner)[k > 0][k, max(k - 1, 0)] += q
        if k + 1 < n:
            inner[k, k + 1] += p
    outer[n - 1, 1] += p
    outer[0, 0] = q
    got = absorbed(inner, outer)[:, 1]
    steps = time_left(inner, np.ones(n))
    k, total, r = np.arange(1, n + 1), n + 1, q / p
    if p == 0.5:
        assert got == pytest.approx(k / total)
        assert steps == pytest.approx(k * (total - k))
    else:
        wins = (1 - r**k) / (1 - r**total)
        assert got == pytest.approx(wins)
        assert steps == pytest.approx((k - total * wins) / (q - p))


def flights(rng, count=3000):
    """Walks through a chart with a circle; each state takes its own time."""
    ways = {
        "idle": [("gps", 1.0)],
        "gps": [("visual", 0.8), ("land", 0.15), (HURT, 0.05)],
        "visual": [("gps", 0.25), ("land", 0.75)],
        "land": [(HOME, 1.0)],
    }
    for n in range(count):
        visits, state = [], "idle"
        while not isinstance(state, Ending):
            visits.append((state, float(rng.integers(1, 9)) + len(state)))
            names, chances = zip(*ways[state], strict=True)
            state = names[rng.choice(len(names), p=chances)]
        yield row(n, state.outcome, visits=tuple(visits))


@pytest.fixture(scope="module")
def flown():
    return list(flights(np.random.default_rng(0)))


def test_the_chain_of_a_sample_reproduces_the_sample(flown):
    """Exactly so from where all flights began, whatever the flights were like."""
    chain = estimate(flown)
    ends = dict(zip(chain.endings, absorbed(chain.inner, chain.outer)[0], strict=True))
    crashed = sum(it.outcome == "crash" for it in flown) / len(flown)
    assert sum(v for k, v in ends.items() if k.outcome == "crash") == pytest.approx(crashed)
    took = np.mean([sum(s for _, s in it.visits) for it in flown])
    assert time_left(chain.inner, chain.dwell)[0] == pytest.approx(took)


def test_the_chain_finds_the_walk_it_was_made_from(flown):
    chain = estimate(flown)
    gps = chain.states.index("gps")
    ends = absorbed(chain.inner, chain.outer)[gps]
    truth = 0.05 / (1 - 0.8 * 0.25)
    found = sum(p for it, p in zip(chain.endings, ends, strict=True) if it.outcome == "crash")
    assert found == pytest.approx(truth, abs=0.012)


def test_algebra_agrees_with_brute_force(flown):
    """Walk the estimated chain at random and count."""
    chain, rng = estimate(flown), np.random.default_rng(1)
    n, both = len(chain.states), np.hstack([chain.inner, chain.outer])
    counts, spent = np.zeros(len(chain.endings)), []
    for _ in range(4000):
        state, time = chain.states.index("visual"), 0.0
        while state < n:
            time += chain.dwell[state]
            state = int(rng.choice(both.shape[1], p=both[state]))
        counts[state - n] += 1
        spent.append(time)
    visual = chain.states.index("visual")
    assert counts / 4000 == pytest.approx(absorbed(chain.inner, chain.outer)[visual], abs=0.02)
    left = time_left(chain.inner, chain.dwell)[visual]
    assert np.mean(spent) == pytest.approx(left, abs=4 * np.std(spent) / math.sqrt(4000))


def test_the_likeliest_failure_is_the_best_of_all_paths(flown):
    chain = estimate(flown)
    failures = [it for it in chain.endings if it.outcome == "crash"]
    way = likeliest(chain, failures)
    best = max(every_path(chain, failures), key=lambda it: it[0])
    assert (way.states, way.ending) == best[1:]
    assert way.probability == pytest.approx(best[0])
    assert way.states == ("idle", "gps")


def every_path(chain: Chain, endings, longest=5):
    n = len(chain.states)
    for size in range(1, longest + 1):
        for path in itertools.product(range(n), repeat=size):
            p = chain.starts[path[0]] / chain.starts.sum()
            for a, b in itertools.pairwise(path):
                p *= chain.inner[a, b]
            for e in endings:
                share = p * chain.outer[path[-1], chain.endings.index(e)]
                yield share, tuple(chain.states[s] for s in path), e


def test_nothing_failed_and_nothing_flown():
    chain = estimate([row(0), row(1)])
    assert likeliest(chain, []) is None
    assert chain.endings == (HOME,)
    assert estimate([row(0, "hung", visits=())]).states == ()


def test_a_state_that_follows_itself_is_visited_again():
    chain = estimate([row(0, visits=(("a", 1.0), ("a", 3.0), ("b", 5.0)))])
    assert chain.inner[0].tolist() == [0.5, 0.5]
    assert chain.dwell.tolist() == [2.0, 5.0]
    assert time_left(chain.inner, chain.dwell)[0] == pytest.approx(9.0)


def test_runs_that_were_in_a_state_are_counted_once():
    circle = row(0, visits=(("a", 1.0), ("b", 1.0), ("a", 1.0)))
    assert passed([circle, row(1, "crash", visits=(("a", 1.0),))]) == {"a": (2, 1), "b": (1, 1)}
