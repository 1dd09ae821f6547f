"""The chain of a campaign as a file that guards read."""

from __future__ import annotations

import numpy as np
import pytest
from campaigns import row
from documents import MINIMAL
from samples import HOP
from typer.testing import CliRunner

from missionkit.campaigns.chain_file import chain_text
from missionkit.campaigns.markov_chain import absorbed, estimate
from missionkit.chart.load import load
from missionkit.chart.model_file import load_model
from missionkit.chart.plugin_catalogue import builtin
from missionkit.cli.app import app
from missionkit.errors import FileError, UsageError
from missionkit.guards.estimated_chain import EstimatedChain
from missionkit.guards.markov_steady_state import MarkovSteadyState
from missionkit.markov.stationary import stationary
from missionkit.plugin_protocols import Inputs

LEARNED = """\
guards:
  likely: {use: markov_steady_state, chain: chain.yaml, of: success, at_least: 0.1}
"""


def flights():
    """Nine flights that watch before they go home; a third of those that search crash."""
    paths = [("watch", "home")] * 6 + [("watch", "search", "home")] * 2 + [("watch", "search")]
    return [
        row(
            number=n,
            seed=n,
            outcome="crash" if path[-1] == "search" else "success",
            visits=tuple((state, 2.0 + n) for state in path),
        )
        for n, path in enumerate(paths)
    ]


def written(tmp_path, text=None):
    chain = estimate(flights())
    path = tmp_path / "chain.yaml"
    path.write_text(text or chain_text(chain, "minimal", {"cruise": "5"}))
    mission = tmp_path / "mission.yaml"
    mission.write_text(MINIMAL + LEARNED)
    return chain, mission


def test_a_guard_reads_what_the_campaign_has_written(tmp_path):
    chain, path = written(tmp_path)
    mission = load(path, builtin())
    guard = mission.guards["likely"].plugin
    assert isinstance(guard, MarkovSteadyState)
    assert guard.chain.flights == 9
    assert guard.chain.endings == ("crash", "success")
    P = np.array([[entry.number for entry in each] for each in guard.chain.matrix])
    n = len(chain.states)
    assert P[:n, :n] == pytest.approx(chain.inner)
    assert P[n:, :n] == pytest.approx(np.tile(chain.starts / 9, (2, 1)))
    assert guard.chain.dwell == pytest.approx(
        dict(zip(chain.states, chain.dwell, strict=True)), abs=1e-3
    )
    assert (tmp_path / "chain.yaml") in mission.included


def test_of_the_flights_that_end_as_many_succeed_in_the_long_run_as_in_the_campaign(tmp_path):
    chain, path = written(tmp_path)
    guard = load(path, builtin()).guards["likely"].plugin
    found = stationary([[entry.number for entry in each] for each in guard.chain.matrix])
    share = dict(zip(guard.names, found.probabilities, strict=True))
    assert share["success"] / (share["success"] + share["crash"]) == pytest.approx(8 / 9)
    outcomes = [it.outcome for it in chain.endings]
    ends = absorbed(chain.inner, chain.outer)[chain.states.index("watch")]
    won = sum(p for p, it in zip(ends, outcomes, strict=True) if it == "success")
    assert won == pytest.approx(8 / 9)
    verdict = guard.check(guard.begin(), None, Inputs({}, {}, ()))
    assert verdict.value == pytest.approx(share["success"])


def test_mistakes_are_named_where_they_stand_in_the_chains_file(tmp_path):
    chain, _ = written(tmp_path)
    text = chain_text(chain, "minimal", {})
    line = next(n for n, it in enumerate(text.splitlines(), 1) if it.startswith("  - "))
    bad = text.replace(text.splitlines()[line - 1], "  - [0.5, 0.6, 0, 0, 0]")
    _, path = written(tmp_path, bad)
    with pytest.raises(FileError) as error:
        load(path, builtin())
    (problem,) = error.value.problems
    assert (problem.place.file, problem.place.line) == (str(tmp_path / "chain.yaml"), line)
    assert problem.message.endswith("the row adds up to 1.1, not to 1")


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("chian.yaml", "no such file beside the mission"),
        ("../chain.yaml", "outside the folder of the mission"),
        ("mission.yaml", "'chain'"),
        ("7", "expected the name of a file, got 7"),
    ],
)
def test_another_file_is_refused_in_a_sentence(tmp_path, name, message):
    _, path = written(tmp_path)
    path.write_text(path.read_text().replace("chain.yaml", name))
    with pytest.raises(FileError, match=message):
        load(path, builtin())


def test_an_ending_that_is_called_as_a_state_gets_another_name():
    rows = [row(number=0, seed=0, outcome="success", visits=(("success", 1.0),))]
    text = chain_text(estimate(rows), "m", {})
    assert "states: [success, ended_success]" in text


def test_several_variants_have_no_one_chain(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "hop.yaml").write_text(HOP)
    refused = CliRunner().invoke(
        app, ["campaign", "hop.yaml", "--vary", "height=2,3", "--chain", "chain.yaml"]
    )
    assert refused.exit_code == 2
    assert "--chain writes the chain of one variant; leave out --vary" in refused.stderr
    assert not (tmp_path / "runs").exists()


def test_the_command_writes_the_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "hop.yaml").write_text(HOP)
    words = ["campaign", "hop.yaml", "--runs", "2", "--workers", "1", "--chain", "chain.yaml"]
    assert CliRunner().invoke(app, words).exit_code == 0
    chain = load_model(tmp_path / "chain.yaml", EstimatedChain)
    assert (chain.mission, chain.flights, chain.endings) == ("hop", 2, ("success",))
    assert chain.states == ("idle", "land", "success")


def test_a_chain_with_too_many_states_is_refused():
    rows = [
        row(number=0, seed=0, outcome="success", visits=tuple((f"s{n}", 1.0) for n in range(70)))
    ]
    with pytest.raises(UsageError, match="a guard reads at most 64"):
        chain_text(estimate(rows), "m", {})
